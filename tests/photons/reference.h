// What photons are compared with.
#pragma once

#include "ddgi/client_light.h"

namespace gicodec::photons {

/// The same light by another way, with no radius to blur it: from every place that is drawn, so
/// many paths are followed away from the light, and meet what lamps and suns light directly. The
/// sky and emissive materials give none, as in photons.
class GatheredLight final : public ddgi::ClientLight {
 public:
  /// The scene must outlive it, and be in its state.
  GatheredLight(const ddgi::RayScene& scene, std::uint32_t paths) : scene_(scene), paths_(paths) {}

  [[nodiscard]] ddgi::Vec3 irradiance(const ddgi::SeenSurface& seen) const override;

 private:
  const ddgi::RayScene& scene_;
  std::uint32_t paths_;
};

}  // namespace gicodec::photons
