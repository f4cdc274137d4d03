// What is known around a vertex or a voxel when its light is coded (docs/native.md, "Vertices",
// "Voxels").
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace gicodec::native {

struct KnownLights {
  static constexpr unsigned kMost = 16, kChildren = 8;
  /// The records of six hemispheres.
  struct Other {
    const std::byte* now = nullptr;
    const std::byte* past = nullptr;  ///< of what the update lists; null: none
    std::uint32_t distance = 0;       ///< squared, 1 to 9
    bool dark = false;                ///< all zero now
  };
  unsigned count = 0;
  std::array<Other, kMost> other{};  ///< by distance

  /// The voxel of the next level around one, which is the mean of those in it.
  struct Family {
    Other parent{};                         ///< without `now` if it is not known
    unsigned children = 0, coded = 0;       ///< that exist; that were coded before
    std::array<Other, kChildren> before{};  ///< those
  };
  Family family{};
};

}  // namespace gicodec::native
