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

/// Where the probes of a grid stand. Probe (x, y, z) is at origin + (x, y, z) · spacing.
struct VolumeGeometry {
  Grid grid;
  Position origin{0, 0, 0};
  Position spacing{1, 1, 1};  ///< positive
};

/// invalid_argument unless the grid has 1..kMaxProbes probes, all numbers are finite and every
/// spacing is positive.
Status validate(const VolumeGeometry& geometry) noexcept;

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
