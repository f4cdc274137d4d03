// AO of each pixel: by rays, which is the reference, and in screen space, which is the peer.
#pragma once

#include "ao/occlusion.h"

#include "ddgi/client_light.h"

#include <vector>

namespace gicodec::ao {

/// By rays from each sample of the picture; irradiance as PointLight's.
class TracedLight final : public ddgi::ClientLight {
 public:
  TracedLight(const ddgi::RayScene& scene, std::uint32_t rays, float distance)
      : scene_(scene), hemisphere_(rays, distance) {}
  [[nodiscard]] ddgi::Vec3 irradiance(const ddgi::SeenSurface& seen) const override;

 private:
  const ddgi::RayScene& scene_;
  Hemisphere hemisphere_;
};

/// From depths and normals of the picture: samples in a hemisphere around each pixel's surface
/// count as occluded behind what is seen, turned in a pattern of 4×4 pixels, which a blur over as
/// many takes away.
class ScreenSpaceLight final : public ddgi::ClientLight {
 public:
  ScreenSpaceLight(std::uint32_t samples, float radius);
  void prepare(const ddgi::RayScene& scene, const ddgi::PictureView& view,
               ddgi::ThreadPool& pool) override;
  [[nodiscard]] ddgi::Vec3 irradiance(const ddgi::SeenSurface& seen) const override;

 private:
  struct Pixel {
    ddgi::Vec3 position, normal;  ///< in the camera's space, which looks along +z
  };

  std::vector<ddgi::Vec3> samples_;  ///< in the hemisphere around +z, lengths 0..1
  float radius_;
  std::uint32_t width_ = 0, height_ = 0;
  std::vector<float> visible_;  ///< of each pixel
};

}  // namespace gicodec::ao
