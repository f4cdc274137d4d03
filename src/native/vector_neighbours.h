// Which vertices of a grid a vertex may be predicted from (docs/native.md, "Vectors").
#pragma once

#include <gicodec/backend.h>

#include <array>
#include <cstdint>
#include <span>

namespace gicodec::native {

struct Update;

/// Others around a vertex that are known when it is coded, by distance.
struct KnownVertices {
  static constexpr unsigned kMost = 16;
  struct Vertex {
    const std::byte* now = nullptr;
    const std::byte* past = nullptr;  ///< of vertices of the update; null in keyframes
    std::uint32_t distance = 0;       ///< squared, 1 to 9
    bool dark = false;                ///< all zero now
  };
  unsigned count = 0;
  std::array<Vertex, kMost> vertex{};
};

/// Of the vertex at position `at` of a chunk. `records`: those of all positions; those before `at`
/// are there. `listed_only`: no others than those of the update.
[[nodiscard]] KnownVertices known_around(const Update& u, std::span<const std::uint32_t> positions,
                                         std::size_t at, const BlockTable& records,
                                         bool listed_only);

}  // namespace gicodec::native
