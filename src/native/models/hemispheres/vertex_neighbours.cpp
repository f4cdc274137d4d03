#include "native/models/hemispheres/vertex_neighbours.h"

#include "native/frame/workspace.h"
#include "quantise/set_order.h"

#include <algorithm>

namespace gicodec::native {
namespace {

constexpr int kReach = 3, kSide = 2 * kReach + 1;

constexpr auto kAround = offsets_around<kReach, 122>();
static_assert(kAround.back().distance == kReach * kReach);

/// First and last coordinate of the box that a coordinate is in.
struct Range {
  std::int64_t first, last;
  Range(std::uint32_t at, std::uint32_t box, std::uint32_t grid)
      : first(at - at % box), last(std::min<std::int64_t>(first + box, grid) - 1) {}
  [[nodiscard]] bool has(std::int64_t c) const { return c >= first && c <= last; }
};

/// Positions in a chunk of the vertices of one row around; where each stands in the list.
struct Row {
  bool searched = false;
  std::array<std::int32_t, kSide> at{};  // -1: not listed
};

}  // namespace

KnownLights known_around(const Update& u, std::span<const std::uint32_t> positions, std::size_t at,
                         const BlockTable& records, bool listed_only) {
  const Grid& grid = u.desc.grid;
  const std::uint32_t block = u.probes[positions[at]];
  const std::uint32_t x = block % grid.x, y = block / grid.x % grid.y, z = block / grid.x / grid.y;
  const Range xs(x, u.box.x, grid.x), ys(y, u.box.y, grid.y), zs(z, u.box.z, grid.z);
  std::array<Row, kSide * kSide> rows;
  const auto listed = [&](const NearbyOffset& o, std::int64_t index) {
    const int number = (o.z + kReach) * kSide + o.y + kReach, column = o.x + kReach;
    Row& row = rows[static_cast<std::size_t>(number)];
    if (!row.searched) {
      row.searched = true;
      row.at.fill(-1);
      const std::int64_t first = index - o.x - kReach;
      const auto less = [&](std::uint32_t position, std::int64_t b) {
        return std::int64_t{u.probes[position]} < b;
      };
      auto next = std::lower_bound(positions.begin(), positions.end(), first, less);
      for (; next != positions.end() && u.probes[*next] < first + kSide; ++next) {
        row.at[static_cast<std::size_t>(u.probes[*next] - first)] =
            static_cast<std::int32_t>(next - positions.begin());
      }
    }
    return row.at[static_cast<std::size_t>(column)];
  };
  KnownLights known;
  for (const NearbyOffset& o : kAround) {
    if (!xs.has(std::int64_t{x} + o.x) || !ys.has(std::int64_t{y} + o.y) ||
        !zs.has(std::int64_t{z} + o.z)) {
      continue;
    }
    const std::int64_t index =
        std::int64_t{block} + o.x + std::int64_t{grid.x} * (o.y + std::int64_t{grid.y} * o.z);
    const auto other = static_cast<std::uint32_t>(index);
    const std::int32_t place = listed(o, index);
    KnownLights::Neighbour& vertex = known.other[known.count];
    if (place >= 0) {
      if (static_cast<std::size_t>(place) >= at) continue;
      vertex.now = records[positions[static_cast<std::size_t>(place)]].data();
      vertex.previous = u.update ? u.mirror.blocks[other].data() : nullptr;
    } else {
      if (listed_only || !u.mirrored || !u.mirror.is_received(other)) continue;
      vertex.now = u.mirror.blocks[other].data();
      vertex.previous = nullptr;
    }
    vertex.distance = o.distance;
    vertex.dark = is_zero({vertex.now, u.block_bytes()});
    if (++known.count == KnownLights::kMax) break;
  }
  return known;
}

}  // namespace gicodec::native
