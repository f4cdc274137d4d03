#include "native/models/octree/bricks.h"

#include "native/frame/workspace.h"
#include "quantise/set_order.h"
#include "texture/texel.h"

#include <gicodec/voxels.h>

#include <algorithm>

namespace gicodec::native {
namespace {

constexpr std::uint64_t kKey = (std::uint64_t{1} << 54) - 1;
constexpr unsigned kMaxAround = 3;  // voxels that count
constexpr unsigned kMaxSide = 8, kMaxVoxels = kMaxSide * kMaxSide * kMaxSide;

/// Coordinates of voxels within bricks of up to kMaxSide, by Morton number; and the reverse.
struct Curve {
  struct Voxel {
    std::uint8_t x = 0, y = 0, z = 0;
  };
  std::array<Voxel, kMaxVoxels> voxel{};
  std::array<std::uint16_t, kMaxVoxels> number{};  ///< of x + 8·(y + 8·z)
};
constexpr Curve kCurve = [] {
  Curve curve;
  for (unsigned m = 0; m < kMaxVoxels; ++m) {
    unsigned x = 0, y = 0, z = 0;
    for (unsigned bit = 0; bit < 3; ++bit) {
      x |= (m >> (3 * bit) & 1) << bit;
      y |= (m >> (3 * bit + 1) & 1) << bit;
      z |= (m >> (3 * bit + 2) & 1) << bit;
    }
    curve.voxel[m] = {static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y),
                      static_cast<std::uint8_t>(z)};
    curve.number[x + kMaxSide * (y + kMaxSide * z)] = static_cast<std::uint16_t>(m);
  }
  return curve;
}();

constexpr auto kOffset = offsets_around<1, 26>();

bool has(const std::byte* mask, unsigned voxel) {
  return (std::to_integer<unsigned>(mask[voxel / 8]) >> voxel % 8 & 1) != 0;
}

/// Levels from the highest on.
std::uint64_t order_of(std::uint64_t place) {
  return (place & kKey) | (UINT64_MAX - (place >> kBrickLevelShift)) << kBrickLevelShift;
}
std::uint64_t place_of(const std::byte* presence) { return load<std::uint64_t>(presence); }

std::uint64_t order_at(unsigned level, const std::array<std::uint32_t, 3>& at) {
  return order_of(morton_key(at) | std::uint64_t{level} << kBrickLevelShift);
}

}  // namespace

void find_held_bricks(const Update& u, Vector<PlacedBrick>& out) {
  out.clear();
  if (u.mirror.presence.bytes == 0) return;
  const std::uint32_t blocks = block_count(u.desc);
  auto next = u.probes.begin();
  for (std::uint32_t block = 0; block < blocks; ++block) {
    const bool listed = next != u.probes.end() && *next == block;
    if (listed) ++next;
    if (listed || !u.mirror.is_received(block)) continue;
    const auto presence = u.mirror.presence[block];
    if (is_zero(presence.subspan(kBrickPlaceBytes))) continue;
    out.push_back({order_of(place_of(presence.data())), block});
  }
  std::sort(out.begin(), out.end());
}

void Bricks::reset(const Update& u, std::span<const std::uint32_t> positions) {
  side_ = u.desc.block.y;
  encoding_ = LightEncoding(u.desc.record);
  voxel_bytes_ = kVoxelDirections * std::size_t{u.desc.record.bytes};
  bricks_.clear();
  bricks_.reserve(positions.size());
  for (const std::uint32_t position : positions) {
    bricks_.push_back({order_of(place_of(u.presence_of(position).data())), position});
  }
  std::sort(bricks_.begin(), bricks_.end());
}

Bricks::Brick Bricks::listed(const Update& u, const BlockTable& records,
                             std::uint32_t position) const {
  const auto presence = u.presence_of(position);
  Brick brick;
  brick.now = records[position].data();
  brick.mask = presence.data() + kBrickPlaceBytes;
  const std::uint32_t block = u.probes[position];
  if (!u.update || u.mirror.presence.bytes == 0 || !u.mirror.is_received(block)) return brick;
  const auto before = u.mirror.presence[block];
  if (place_of(before.data()) != place_of(presence.data())) return brick;
  brick.previous = u.mirror.blocks[block].data();
  brick.previous_mask = before.data() + kBrickPlaceBytes;
  return brick;
}

Bricks::Brick Bricks::find(const Update& u, const BlockTable& records, std::uint64_t order,
                           std::size_t i) const {
  const auto less = [](const PlacedBrick& brick, std::uint64_t value) {
    return brick.order < value;
  };
  const auto end = bricks_.begin() + static_cast<std::ptrdiff_t>(i);
  const auto mine = std::lower_bound(bricks_.begin(), end, order, less);
  if (mine != end && mine->order == order) return listed(u, records, mine->at);
  if (u.held == nullptr) return {};
  const auto held = std::lower_bound(u.held->begin(), u.held->end(), order, less);
  if (held == u.held->end() || held->order != order) return {};
  Brick brick;
  brick.now = u.mirror.blocks[held->at].data();
  brick.mask = u.mirror.presence[held->at].data() + kBrickPlaceBytes;
  return brick;
}

std::uint32_t Bricks::enter(const Update& u, const BlockTable& records, std::size_t i) {
  const std::uint32_t position = bricks_[i].at;
  const auto presence = u.presence_of(position).first<kBrickPlaceBytes>();
  const auto level = static_cast<unsigned>(place_of(presence.data()) >> kBrickLevelShift);
  const std::array<std::uint32_t, 3> at = unpack_brick_place(presence).at;
  for (unsigned n = 0; n < kAround; ++n) {
    // 0 − 1 wraps, and is beyond the last brick too.
    const std::array<std::uint32_t, 3> there{at[0] + n % 3 - 1, at[1] + n / 3 % 3 - 1,
                                             at[2] + n / 9 - 1};
    const bool inside =
        there[0] < kMaxBrickSide && there[1] < kMaxBrickSide && there[2] < kMaxBrickSide;
    around_[n] = n == kHere ? listed(u, records, position)
                 : inside   ? find(u, records, order_at(level, there), i)
                            : Brick{};
  }
  parent_ = find(u, records, order_at(level + 1, {at[0] / 2, at[1] / 2, at[2] / 2}), i);
  for (unsigned axis = 0; axis < 3; ++axis) parent_at_[axis] = (at[axis] & 1) * side_ / 2;
  return position;
}

static unsigned voxel_of(const Curve::Voxel& v, unsigned side) {
  return v.x + side * (v.y + side * v.z);
}

bool Bricks::exists(unsigned m) const {
  return has(around_[kHere].mask, voxel_of(kCurve.voxel[m], side_));
}
std::size_t Bricks::offset(unsigned m) const {
  return voxel_of(kCurve.voxel[m], side_) * voxel_bytes_;
}

std::span<const std::byte> Bricks::previous(unsigned m) const {
  const Brick& here = around_[kHere];
  const unsigned voxel = voxel_of(kCurve.voxel[m], side_);
  if (here.previous == nullptr || !has(here.previous_mask, voxel)) return {};
  return {here.previous + voxel * voxel_bytes_, voxel_bytes_};
}

KnownLights::Neighbour Bricks::other(const Brick& brick, unsigned voxel,
                                     std::uint32_t distance) const {
  KnownLights::Neighbour other;
  if (brick.now == nullptr || !has(brick.mask, voxel)) return other;
  const std::size_t at = voxel * voxel_bytes_;
  other.now = brick.now + at;
  if (brick.previous != nullptr && has(brick.previous_mask, voxel))
    other.previous = brick.previous + at;
  other.distance = distance;
  other.lit = encoding_.lit(other.now);
  other.dark = other.lit == 0 && is_zero({other.now, voxel_bytes_});
  return other;
}

KnownLights::Neighbour Bricks::own(unsigned m, unsigned siblings, std::uint32_t distance) const {
  KnownLights::Neighbour one = other(around_[kHere], voxel_of(kCurve.voxel[m], side_), distance);
  if (one.now == nullptr || m / KnownLights::kChildren != siblings) return one;
  // Its light may not be coded yet.
  const LightOccupancy& occupancy = occupancy_[m % KnownLights::kChildren];
  one.lit = occupancy.lit;
  one.dark = !occupancy.any;
  return one;
}

KnownLights::Siblings Bricks::siblings(unsigned m) const {
  KnownLights::Siblings siblings;
  const Curve::Voxel v = kCurve.voxel[m];
  const unsigned above = parent_at_[0] + v.x / 2 +
                         side_ * (parent_at_[1] + v.y / 2 + side_ * (parent_at_[2] + v.z / 2));
  siblings.parent = other(parent_, above, 1);
  const unsigned first = m - m % KnownLights::kChildren;
  for (unsigned child = first; child < first + KnownLights::kChildren; ++child) {
    const KnownLights::Neighbour one = own(child, m / KnownLights::kChildren, 1);
    if (one.now == nullptr) continue;
    siblings.lit[siblings.children++] = one.lit;
    if (child < m) siblings.before[siblings.coded++] = one;
  }
  return siblings;
}

KnownLights Bricks::around(unsigned m, bool has_previous) const {
  KnownLights known;
  const Curve::Voxel v = kCurve.voxel[m];
  const auto side = static_cast<int>(side_);
  for (const NearbyOffset& o : kOffset) {
    const int x = v.x + o.x, y = v.y + o.y, z = v.z + o.z;
    // 0 before, 1 in, 2 after the brick.
    const auto part = [side](int c) { return c < 0 ? 0U : c < side ? 1U : 2U; };
    const unsigned n = part(x) + 3 * (part(y) + 3 * part(z));
    const auto within = [side](int c) { return static_cast<unsigned>((c + side) % side); };
    const unsigned lx = within(x), ly = within(y), lz = within(z);
    const unsigned number = kCurve.number[lx + kMaxSide * (ly + kMaxSide * lz)];
    if (n == kHere && number >= m) continue;
    const KnownLights::Neighbour one =
        n == kHere ? own(number, m / KnownLights::kChildren, o.distance)
                   : other(around_[n], lx + side_ * (ly + side_ * lz), o.distance);
    if (one.now == nullptr || (has_previous && one.previous == nullptr)) continue;
    known.other[known.count] = one;
    if (++known.count == kMaxAround) break;
  }
  known.siblings = siblings(m);
  return known;
}

}  // namespace gicodec::native
