// Unique texture coordinates of a scene's surfaces (Crassin et al. §4.2, step 1): charts packed
// into one map. Both ends derive it from the scene and the map's size and compare its hash.
#pragma once

#include "charts.h"

#include "ddgi/ray_scene.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gicodec::maps {

/// A texel that lies on a surface: the place of its sample.
struct MapTexel {
  std::uint32_t place = 0;     ///< x + width · y
  std::uint32_t triangle = 0;  ///< of the nearest triangle of its chart
  float u = 0, v = 0;          ///< weights of that triangle's second and third corner
};

/// Texels of the map from (x, y) on.
struct ChartRect {
  std::uint32_t x = 0, y = 0, width = 0, height = 0;
};

class Parameterisation {
 public:
  /// Throws tools::Error of Exit::usage where not every chart gets a texel.
  Parameterisation(const ddgi::Scene& scene, std::uint32_t width, std::uint32_t height);

  [[nodiscard]] std::uint32_t width() const { return width_; }
  [[nodiscard]] std::uint32_t height() const { return height_; }
  /// Texels per metre, of charts of density 1.
  [[nodiscard]] float density() const { return density_; }
  /// Of all that both ends must agree on.
  [[nodiscard]] std::uint64_t hash() const { return hash_; }
  [[nodiscard]] const SceneCharts& scene() const { return charts_; }
  [[nodiscard]] std::span<const ChartRect> rects() const { return rects_; }  ///< by chart
  /// The texels of charts, all others lie in nothing; ascending by place.
  [[nodiscard]] std::span<const MapTexel> texels() const { return texels_; }
  [[nodiscard]] const Instance& instance_of(std::uint32_t triangle) const;

  /// Where a triangle's corners are in the map, in texels; the first texel's centre is (0, 0).
  [[nodiscard]] const std::array<Vec2, 3>& corners(std::uint32_t triangle) const {
    return corners_[triangle];
  }
  /// Corners of an instance's triangles as texture coordinates, 0 to 1.
  [[nodiscard]] std::vector<std::array<Vec2, 3>> texture_coordinates(
      const Instance& instance) const;

  /// Four texels and their weights, which are those of a chart.
  struct Taps {
    std::array<std::uint32_t, 4> place{};
    std::array<float, 4> weight{};
  };
  /// Bilinear, where a surface was met; no weight for one that is not part of the map.
  [[nodiscard]] Taps taps(const ddgi::Surface& surface) const;

 private:
  bool pack(double density);
  void place_corners();
  void find_texels();
  void find_texels_of(std::uint32_t chart, std::vector<MapTexel>& best, std::vector<float>& far);
  void make_hash();

  SceneCharts charts_;
  std::uint32_t width_, height_;
  float density_ = 0;
  std::vector<ChartRect> rects_;
  std::vector<std::array<Vec2, 3>> corners_;
  std::vector<MapTexel> texels_;
  std::vector<std::uint32_t> first_instance_;  ///< by object, and the end
  std::uint64_t hash_ = 0;
};

/// The mean by weight of those texels of a map that exist, by place; zero if none does.
[[nodiscard]] inline Vec3 blend(const Parameterisation::Taps& taps, std::span<const Vec3> map,
                                std::span<const std::uint8_t> exists) {
  Vec3 sum;
  float weight = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (exists[taps.place[i]] == 0) continue;
    sum += map[taps.place[i]] * taps.weight[i];
    weight += taps.weight[i];
  }
  return weight > 0 ? sum / weight : sum;
}

}  // namespace gicodec::maps
