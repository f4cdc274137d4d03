// Irradiance vectors as a client draws with them (Pacanowski et al. §3.2, §4.1).
#pragma once

#include "vector_field.h"

#include "kinds/volume_light.h"

namespace gicodec::vectors {

enum class Fill : std::uint8_t {
  none,  ///< what has not arrived has no weight
  push_pull,
  smooth,  ///< push-pull with a filter at each level
};

struct VectorLightOptions {
  Interpolation interpolation = Interpolation::trilinear;
  Fill fill = Fill::smooth;
};

class VectorLight final : public kinds::VolumeLight {
 public:
  /// Throws tools::Error of Exit::bad_input for a volume of another kind.
  explicit VectorLight(const VolumeDesc& desc, const VectorLightOptions& options = {});

  void update(const kinds::HeldVolume& volume, double time) override;
  [[nodiscard]] Vec3 irradiance(const ddgi::SeenSurface& seen) const override;
  [[nodiscard]] const VectorField& field() const { return field_; }  ///< filled in

 private:
  VectorLightOptions options_;
  VolumeDesc own_;
  VectorCode code_;
  VectorField field_;
};

}  // namespace gicodec::vectors
