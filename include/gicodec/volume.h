// A volume of probes in the world, and which of its probes a viewer needs (Stengel et al. §3.4).
#pragma once

#include <gicodec/status.h>
#include <gicodec/texture.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace gicodec {

using Position = std::array<float, 3>;  ///< world units

/// Cells along each axis by which a camera-locked volume has moved, each within ±kMaxScroll.
using Scroll = std::array<std::int32_t, 3>;
inline constexpr std::int32_t kMaxScroll = 1 << 22;

/// Where the probes of a grid stand: cell c at origin + c · spacing, where c runs from scroll to
/// scroll + n − 1 along an axis of n probes. A cell's block never moves: it stands in the texture
/// at the probe with the same remainder, c mod n, so that a volume which scrolls replaces just the
/// planes that enter. Without scrolling, cell and probe are the same.
struct VolumeGeometry {
  Grid grid;
  Position origin{0, 0, 0};
  Position spacing{1, 1, 1};  ///< positive
  Scroll scroll{0, 0, 0};

  friend bool operator==(const VolumeGeometry&, const VolumeGeometry&) = default;
};

/// invalid_argument unless the grid has 1..kMaxProbes probes, all numbers are finite and in range
/// and every spacing is positive.
Status validate(const VolumeGeometry& geometry) noexcept;

/// Where a probe of the grid stands now. Precondition: probe is in the grid.
[[nodiscard]] Position probe_position(const VolumeGeometry& geometry, std::uint32_t probe) noexcept;

/// The probes in the order in which they stand: x fastest, from the lowest cell of each axis on.
/// Without scrolling 0, 1, 2 and so on.
[[nodiscard]] std::vector<std::uint32_t> probes_by_cell(const VolumeGeometry& geometry);

/// The scroll that brings the middle of the volume to within half a cell of `viewer`, which must be
/// finite; clamped to the range.
[[nodiscard]] Scroll scroll_to(const VolumeGeometry& geometry, const Position& viewer) noexcept;

/// Probes that stand elsewhere after scrolling, ascending: the planes that enter.
[[nodiscard]] std::vector<std::uint32_t> entering_probes(Grid grid, const Scroll& from,
                                                         const Scroll& to);

/// A set of probes: one byte per probe of a grid, not 0 for members.
using ProbeMask = std::vector<std::uint8_t>;

/// Adds to `mask` the probes that shade the given points: the cage of eight around each. Points
/// outside the volume belong to its nearest cage, as a shader clamps them; points that are not
/// finite are passed over. Precondition: mask.size() is the number of probes.
void add_shading_probes(const VolumeGeometry& geometry, std::span<const Position> points,
                        std::span<std::uint8_t> mask) noexcept;

/// A volume cut into boxes of at most `size` probes along each axis; those at the far ends may be
/// smaller. Chunks count along x, then y, then z; a chunk's probes likewise within it.
class ChunkGrid {
 public:
  /// Precondition: grid and size have no zero.
  constexpr ChunkGrid(Grid grid, Grid size) noexcept
      : grid_(grid),
        size_(size),
        count_{(grid.x + size.x - 1) / size.x, (grid.y + size.y - 1) / size.y,
               (grid.z + size.z - 1) / size.z} {}

  [[nodiscard]] constexpr std::uint32_t chunks() const noexcept {
    return count_.x * count_.y * count_.z;
  }
  /// The grid of one chunk.
  [[nodiscard]] Grid grid_of(std::uint32_t chunk) const noexcept;
  /// The chunk that holds a probe of the volume.
  [[nodiscard]] std::uint32_t chunk_of(std::uint32_t probe) const noexcept;
  /// The volume's index of each probe of a chunk, in the chunk's order.
  [[nodiscard]] std::vector<std::uint32_t> probes_of(std::uint32_t chunk) const;

 private:
  [[nodiscard]] Grid first_of(std::uint32_t chunk) const noexcept;

  Grid grid_, size_, count_;
};

}  // namespace gicodec
