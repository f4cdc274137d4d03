// How an update is cut into chunks, a chunk into groups, and which blocks see which neighbours.
#pragma once

#include <gicodec/backend.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>

#include "base/memory.h"
#include "native/planes/model.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace gicodec::native {

inline constexpr std::uint32_t kMaxChunkProbes = 4096;  ///< of modelled and token chunks
inline constexpr std::uint32_t kMaxBoxProbes = 1U << 20;

/// Boxes of probes that the grid is cut into, from its origin; the last of a row may be smaller.
struct ChunkGrid {
  Grid box;     ///< probes per chunk
  Grid chunks;  ///< chunks per axis
  [[nodiscard]] std::uint32_t count() const { return chunks.x * chunks.y * chunks.z; }
};
/// Whether decoders accept boxes of that size: not empty, not beyond the grid or kMaxBoxProbes.
[[nodiscard]] bool valid_box(const Grid& grid, const Grid& box) noexcept;
/// Precondition: valid_box().
[[nodiscard]] ChunkGrid chunk_grid(const Grid& grid, const Grid& box) noexcept;
/// An encoder's choice: halves the longest side until a chunk has at most `target` probes.
[[nodiscard]] Grid default_box(const Grid& grid, std::uint32_t target) noexcept;

/// Whether its chunk may be modelled or of tokens.
[[nodiscard]] inline bool is_small_box(const Grid& box) noexcept {
  return std::size_t{box.x} * box.y * box.z <= kMaxChunkProbes;
}

/// Where a probe lies in its box, and the number of that place.
[[nodiscard]] inline Grid place_in_box(const Grid& grid, const Grid& box, std::uint32_t probe) {
  return {probe % grid.x % box.x, probe / grid.x % grid.y % box.y, probe / grid.x / grid.y % box.z};
}
[[nodiscard]] inline std::size_t slot_of(const Grid& box, const Grid& place) {
  return place.x + box.x * (place.y + std::size_t{box.y} * place.z);
}

/// The probes of an update, chunk by chunk: positions in the update's list, ascending.
struct ChunkLists {
  Vector<std::uint32_t> chunk;  ///< those that have probes, ascending
  Vector<std::uint32_t> begin;  ///< into `position`; one more than chunks
  Vector<std::uint32_t> position;
  Vector<std::uint32_t> owner, next;  ///< scratch: by probe, by chunk
};
void split(const Grid& grid, const ChunkGrid& chunks, std::span<const std::uint32_t> probes,
           ChunkLists& lists);

inline constexpr std::int32_t kNoBlock = -1;

/// One chunk of an update in coding order.
struct Chunk {
  struct Block {
    std::uint32_t probe;
    std::uint32_t position;     ///< in the update's list; unused for mirror-only blocks
    std::int32_t neighbour[3];  ///< blocks at x−1, y−1, z−1 in this chunk, or kNoBlock
  };
  Vector<Block> blocks;  ///< `coded` blocks in coding order, then neighbours only in the mirror
  std::uint32_t coded = 0;
  Vector<std::uint32_t> group_begin;  ///< into blocks; one more than groups
  [[nodiscard]] std::size_t groups() const noexcept { return group_begin.size() - 1; }

  /// Orders by x + y + z, then index, and forms groups of at most `lanes` blocks none of which is
  /// another's neighbour. Neighbours outside the update are those received, unless `mirror` is
  /// null.
  void build(const Grid& grid, const Grid& box, std::span<const std::uint32_t> probes,
             std::span<const std::uint32_t> positions, const MirrorView* mirror, unsigned lanes);
  /// In the order given, in groups of `lanes`. Neighbours are those received, by their mirror
  /// blocks alone, if there is a mirror; blocks of the update too, if they have `previous` values.
  void build_flat(const Grid& grid, const Grid& box, std::span<const std::uint32_t> probes,
                  std::span<const std::uint32_t> positions, const MirrorView* mirror, bool previous,
                  unsigned lanes);
  /// Forms the groups anew.
  void form_groups(unsigned lanes);
  [[nodiscard]] std::uint32_t widest_group() const noexcept;

 private:
  void find_neighbours(const Grid& grid, const Grid& box, const MirrorView* mirror);

  Vector<std::int32_t> slot_;  // of every probe of the box
  Vector<std::uint32_t> order_, count_;
  Vector<Grid> place_;  // within the box
};

}  // namespace gicodec::native
