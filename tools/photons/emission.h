// How lights send out photons.
#pragma once

#include "ddgi/scene.h"

#include <array>
#include <span>
#include <vector>

namespace gicodec::photons {

/// Around everything that light can reach.
struct Sphere {
  ddgi::Vec3 center{};
  float radius = 0;
};
[[nodiscard]] Sphere sphere_around(const ddgi::Box& box);

/// Mean of the channels of a colour.
[[nodiscard]] constexpr float mean(ddgi::Vec3 colour) {
  return (colour.x + colour.y + colour.z) / 3;
}

struct Emission {
  ddgi::Vec3 origin, direction;
};

/// A light as it sends out photons. A sun shines through a square as wide as the sphere, or through
/// some of its cells: a projection map (Jensen 2001), so that few photons are shot where nothing
/// comes of them. Emissive materials and the sky are no lights and send out no photons.
class Emitter {
 public:
  static constexpr std::uint32_t kSide = 64, kCells = kSide * kSide;

  Emitter() = default;
  Emitter(const ddgi::Light& light, const Sphere& reach, std::vector<std::uint32_t> cells);
  /// With all cells.
  Emitter(const ddgi::Light& light, const Sphere& reach);

  [[nodiscard]] const ddgi::Light& light() const { return light_; }
  [[nodiscard]] std::span<const std::uint32_t> cells() const { return cells_; }
  /// Flux, mean of the channels: what comes through the cells, of other lights all.
  [[nodiscard]] float watts() const;
  /// One ray of the light, distributed as its flux is, for numbers in [0, 1). Precondition: it has
  /// a cell.
  [[nodiscard]] Emission emit(const std::array<float, 4>& numbers) const;

 private:
  ddgi::Light light_;
  Sphere reach_;
  std::vector<std::uint32_t> cells_;
};

/// Whether two lights send out the same photons but for their brightness, so that those of one are
/// those of the other with other watts.
[[nodiscard]] bool same_photons(const Emitter& a, const Emitter& b);

/// The `index`-th point of a sequence that fills the four-dimensional unit cube evenly (Roberts's
/// R4), moved by what the seed says.
[[nodiscard]] std::array<float, 4> even_numbers(std::uint32_t seed, std::uint32_t index);

}  // namespace gicodec::photons
