// What is known around a vertex or a voxel when its light is coded (docs/native/light.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace gicodec::native {

/// How far away another vertex or voxel is.
struct NearbyOffset {
  std::int8_t x = 0, y = 0, z = 0;
  std::uint8_t distance = 0;  ///< squared
};
/// Those of up to `Reach` along each axis, by distance, then z, y, x: the first `Count`.
template <int Reach, std::size_t Count>
[[nodiscard]] constexpr std::array<NearbyOffset, Count> offsets_around() {
  std::array<NearbyOffset, Count> offsets{};
  std::size_t next = 0;
  for (int distance = 1; next < Count; ++distance) {
    for (int z = -Reach; z <= Reach; ++z) {
      for (int y = -Reach; y <= Reach; ++y) {
        for (int x = -Reach; x <= Reach; ++x) {
          if (x * x + y * y + z * z != distance) continue;
          offsets[next++] = {static_cast<std::int8_t>(x), static_cast<std::int8_t>(y),
                             static_cast<std::int8_t>(z), static_cast<std::uint8_t>(distance)};
        }
      }
    }
  }
  return offsets;
}

struct KnownLights {
  static constexpr unsigned kMax = 16, kChildren = 8;
  /// The records of six hemispheres.
  struct Neighbour {
    const std::byte* now = nullptr;
    const std::byte* previous = nullptr;  ///< its mirror value, if the update lists it; null: none
    std::uint32_t distance = 0;           ///< squared, 1 to 9
    bool dark = false;                    ///< all zero now
    std::uint8_t lit = 0;                 ///< of voxels, the hemispheres with colours, by bit
  };
  unsigned count = 0;
  std::array<Neighbour, kMax> other{};  ///< by distance

  /// The voxel of the next level that contains a voxel, which is the mean of those in it.
  struct Siblings {
    Neighbour parent{};                         ///< without `now` if it is not known
    unsigned children = 0, coded = 0;           ///< that exist; that come before this one
    std::array<Neighbour, kChildren> before{};  ///< those
    /// Hemispheres with colours of all children, in order, as far as their occupancy was coded.
    std::array<std::uint8_t, kChildren> lit{};

    /// Children with colours in hemisphere h before this one, and from this one on.
    [[nodiscard]] unsigned lit_before(unsigned h) const { return count_lit(h, 0, coded); }
    [[nodiscard]] unsigned lit_left(unsigned h) const { return count_lit(h, coded, children); }

   private:
    [[nodiscard]] unsigned count_lit(unsigned h, unsigned begin, unsigned end) const {
      unsigned sum = 0;
      for (unsigned i = begin; i < end; ++i) sum += lit[i] >> h & 1;
      return sum;
    }
  };
  Siblings siblings{};
};

/// What is coded of sibling voxels before their light.
struct LightOccupancy {
  bool any = false;      ///< not all zero
  std::uint8_t lit = 0;  ///< hemispheres with colours, by bit
};

}  // namespace gicodec::native
