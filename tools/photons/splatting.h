// Density estimation in the picture's own space (Crassin et al. §4.3, Mara et al. 2013): photons
// are added to a small picture of what they can reach, from which the large one is interpolated.
#pragma once

#include "held_photons.h"

#include "ddgi/client_renderer.h"

namespace gicodec::photons {

class SplatPicture {
 public:
  static constexpr std::uint32_t kShrink = 4;  ///< by which its sides are smaller

  /// The surfaces that its pixels show, for each the sum of what photons bring. The same photons
  /// give the same bits, whatever the number of threads. Work is bounded: where photons are so
  /// many and so wide that their areas in the picture exceed kMaxTests in all, the widest ones are
  /// narrowed.
  SplatPicture(const ddgi::RayScene& scene, const ddgi::PictureView& view,
               std::span<const HeldPhotons::Batch> batches, ddgi::ThreadPool& pool);

  /// Irradiance, from pixels around that show the same surface.
  [[nodiscard]] ddgi::Vec3 irradiance(const ddgi::SeenSurface& seen) const;

  /// Pixels that photons were compared with.
  [[nodiscard]] std::uint64_t tests() const noexcept { return tests_; }
  static constexpr std::uint64_t kMaxTests = std::uint64_t{1} << 30;

 private:
  struct Pixel {
    ddgi::Vec3 position{1e30F, 1e30F, 1e30F}, normal;
    ddgi::Vec3 sum;                ///< irradiance
    float weight = 0, radius = 0;  ///< sum of what was added, and of radii weighed by it
  };
  /// Columns x0 <= x < x1 and rows y0 <= y < y1.
  struct Area {
    std::uint16_t x0, x1, y0, y1;
    [[nodiscard]] std::uint64_t size() const {
      return std::uint64_t(x1 - x0) * std::uint64_t(y1 - y0);
    }
  };
  struct Splat {
    std::uint32_t photon;  ///< of its batch
    float radius;
    Area area;
  };
  class Projector;

  void see(const ddgi::RayScene& scene, const ddgi::PictureView& view, ddgi::ThreadPool& pool);
  void add(const HeldPhotons::Batch& batch, const Splat& splat, std::uint32_t first_row,
           std::uint32_t end_row);
  /// The share of a disc in the pixel's plane, as wide as photons there are, that has the pixel's
  /// surface in it: the rest of them lies beyond an edge. What is behind other surfaces or outside
  /// of the picture does not count.
  [[nodiscard]] float covered(const Pixel& pixel, const Projector& project, ddgi::Vec3 eye) const;

  std::uint32_t width_ = 0, height_ = 0;
  float spread_ = 0;  ///< of a pixel
  std::uint64_t tests_ = 0;
  std::vector<Pixel> pixels_;
};

}  // namespace gicodec::photons
