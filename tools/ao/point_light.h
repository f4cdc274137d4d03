// AO as a client draws it from points (Neff et al. §3.5).
#pragma once

#include "kinds/traced_kind.h"

#include <gicodec/ao_points.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace gicodec::ao {

/// Irradiance over π of the even light around that AO takes a share of: 1 unit would be the
/// radiance of a white surface in full sun.
inline constexpr float kAmbientLight = 0.3F;

/// Whose transform places a surface of the picture in its instance's space.
enum class Placement : std::uint8_t {
  received,  ///< that of the last update, as in the paper
  own,       ///< that of the scene that is drawn
};

class PointLight final : public kinds::VolumeLight {
 public:
  explicit PointLight(Placement placement = Placement::received) : placement_(placement) {}

  void update(const kinds::HeldVolume& volume, double time) override;
  void prepare(const ddgi::RayScene& scene, const ddgi::PictureView& view,
               ddgi::ThreadPool& pool) override;
  /// AO · kAmbientLight.
  [[nodiscard]] ddgi::Vec3 irradiance(const ddgi::SeenSurface& seen) const override;
  /// Equation 4: 0..1, and 1 where there are no points.
  [[nodiscard]] float visible(const ddgi::Surface& surface) const;

 private:
  struct Instance {
    AoGrid grid;
    ddgi::Affine to_world, to_local;
    bool usable = false;
  };
  static void place(Instance& instance, const ddgi::Affine& to_world);
  [[nodiscard]] const Instance* find(std::uint32_t object, std::uint32_t mesh) const;

  Placement placement_;
  std::vector<Instance> instances_;   ///< by object, then mesh
  std::vector<std::uint32_t> cells_;  ///< seven points of each
  std::vector<std::byte> buckets_;
};

[[nodiscard]] std::unique_ptr<kinds::VolumeLight> make_point_light(const ddgi::RayScene& scene,
                                                                   const VolumeDesc& desc);

}  // namespace gicodec::ao
