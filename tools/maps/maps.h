// Irradiance maps as a kind that is traced and drawn (Crassin et al. §4.2).
#pragma once

#include "map_texels.h"

#include "kinds/traced_kind.h"

#include <memory>
#include <optional>

namespace gicodec::maps {

extern const kinds::TracedKind kTracedMaps;

/// Coordinates in a map of size × size texels, as a glTF file carries them (ddgi::SecondUvs).
[[nodiscard]] std::vector<std::vector<std::array<Vec2, 3>>> second_uvs(const ddgi::Scene& scene,
                                                                       std::uint32_t size);

/// Texels along a side of a map that is traced or drawn.
inline constexpr std::uint32_t kMaxTracedSide = 4096;

struct MapOptions {
  IrradianceMapDesc desc;
  bool by_bases = false;    ///< gathers once per basis, not at every texel
  std::uint32_t bases = 0;  ///< of them as many as that
  float spacing = 0;        ///< or so many metres apart; 0: by their number
  ddgi::GatherOptions gather;
  int qp = -1;  ///< quantiser of HEVC for its texels; negative: lossless
};
[[nodiscard]] MapOptions options_of(const kinds::Settings& settings, std::uint32_t seed);

/// The server: a map that is gathered anew with every update.
class MapServer {
 public:
  /// Throws tools::Error. The scene must outlive it.
  MapServer(const ddgi::Scene& scene, const MapOptions& options, unsigned threads,
            std::function<bool()> cancelled);

  /// Gathers one update of the scene at `time`.
  void update(double time);
  [[nodiscard]] const Parameterisation& map() const { return map_; }
  [[nodiscard]] std::span<const MapTexel> texels() const { return texels_; }  ///< that exist
  [[nodiscard]] const Bases& bases() const { return bases_; }
  /// Irradiance over π of the texels, by place; by bases of the coefficients as they are stored.
  [[nodiscard]] std::span<const Vec3> values() const { return values_; }
  [[nodiscard]] const GatherCount& count() const { return count_; }  ///< of the last update
  /// Texels, or bases, that were brighter in the last update than the format holds.
  [[nodiscard]] std::size_t clipped() const { return clipped_; }
  [[nodiscard]] const IrradianceMapDesc& desc() const { return options_.desc; }
  /// Of the volume, in order.
  [[nodiscard]] std::vector<std::vector<std::byte>> textures() const;

 private:
  void step(double time);

  MapOptions options_;
  ddgi::RayScene scene_;
  ddgi::ThreadPool pool_;
  Parameterisation map_;
  TexelCode code_;
  std::vector<MapTexel> texels_;
  Bases bases_;
  std::vector<Vec3> coefficients_, values_, direct_, lit_;
  std::vector<std::byte> coverage_, blends_;
  std::vector<std::uint8_t> exists_;  ///< by place
  GatherCount count_;
  std::size_t clipped_ = 0;
  std::uint32_t updates_ = 0;
};

/// The client.
class MapLight final : public kinds::VolumeLight {
 public:
  /// Seconds in which what is shown comes as near as 1/e to what was received.
  static constexpr double kFilter = 0.1;

  /// Throws tools::Error of Exit::bad_input for a volume of another kind, and a map that is too
  /// large to be drawn or too small for the scene.
  MapLight(const ddgi::RayScene& scene, const VolumeDesc& desc);

  void update(const kinds::HeldVolume& volume, double time) override;
  [[nodiscard]] Vec3 irradiance(const ddgi::SeenSurface& seen) const override;

  void set_filter(double seconds) { filter_ = seconds; }  ///< 0: shows what was received
  [[nodiscard]] std::span<const Vec3> values() const { return shown_; }  ///< by place
  [[nodiscard]] const Parameterisation& map() const { return map_; }

 private:
  void check_hash(const kinds::HeldTexture& hash) const;
  void take_map(const kinds::HeldTexture& texels);
  void take_bases(const kinds::HeldVolume& volume);

  IrradianceMapDesc desc_;
  VolumeDesc own_;
  Parameterisation map_;
  TexelCode code_;
  double filter_ = kFilter;
  std::optional<double> time_;
  std::vector<Vec3> received_, shown_;  ///< by place
  std::vector<std::uint8_t> exists_;    ///< likewise
};

}  // namespace gicodec::maps
