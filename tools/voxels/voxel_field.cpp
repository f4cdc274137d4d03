#include "voxel_field.h"

#include <algorithm>
#include <cmath>

namespace gicodec::voxels {
namespace {

std::uint64_t place_code(unsigned level, const Cell& brick) {
  return std::uint64_t{level} << kBrickLevelShift | morton_key(brick);
}

}  // namespace

std::optional<BrickPlace> brick_in(std::span<const std::byte> block) {
  const auto mask = block.subspan(kBrickPlaceBytes);
  const bool used = std::ranges::any_of(mask, [](std::byte b) { return b != std::byte{0}; });
  if (!used) return {};
  return unpack_brick_place(block.first<kBrickPlaceBytes>());
}

float level_of(double width, double size) {
  const double level = size > 0 && width > size ? std::log2(width / size) : 0;
  return static_cast<float>(std::clamp<double>(level, 0, kMaxBrickLevel));
}

BrickIndex::BrickIndex(std::span<const std::byte> bricks, BrickShape shape,
                       const std::function<bool(std::size_t)>& has) {
  const std::size_t block = shape.place_bytes();
  for (std::size_t slot = 0; slot < bricks.size() / block; ++slot) {
    const auto place = brick_in(bricks.subspan(slot * block, block));
    if (!place || (has && !has(slot))) continue;
    entries_.push_back({place_code(place->level, place->at), static_cast<std::uint32_t>(slot)});
  }
  std::ranges::sort(entries_);
  const auto same = [](const Entry& a, const Entry& b) { return a.place == b.place; };
  entries_.erase(std::unique(entries_.begin(), entries_.end(), same), entries_.end());
  for (unsigned level = 0; level < begin_.size(); ++level) {
    const auto at = std::ranges::lower_bound(entries_, std::uint64_t{level} << kBrickLevelShift, {},
                                             &Entry::place);
    begin_[level] = static_cast<std::size_t>(at - entries_.begin());
  }
  if (!entries_.empty()) coarsest_ = level(entries_.back());
}

unsigned BrickIndex::level(const Entry& entry) {
  return static_cast<unsigned>(entry.place >> kBrickLevelShift);
}

std::optional<std::uint32_t> BrickIndex::find(unsigned level, const Cell& brick) const {
  const auto of_level =
      std::span(entries_).subspan(begin_[level], begin_[level + 1] - begin_[level]);
  const std::uint64_t place = place_code(level, brick);
  const auto at = std::ranges::lower_bound(of_level, place, {}, &Entry::place);
  if (at == of_level.end() || at->place != place) return {};
  return at->slot;
}

void VoxelField::assign(const VolumeGeometry& geometry, std::span<const std::byte> bricks,
                        std::span<const std::byte> light,
                        const std::function<bool(std::size_t)>& has) {
  for (std::size_t axis = 0; axis < 3; ++axis) origin_[axis] = geometry.origin[axis];
  size_ = geometry.spacing[0];
  bricks_.assign(bricks.begin(), bricks.end());
  light_.assign(light.begin(), light.end());
  index_ = BrickIndex(bricks, shape_, has);
  coarsest_ = {};
  std::array<double, kVoxelDirections> lit{};
  std::array<std::array<double, 3>, kVoxelDirections> sum{};
  const auto entries = index_.entries();
  for (std::size_t i = entries.size(); i-- > 0;) {
    if (BrickIndex::level(entries[i]) != index_.coarsest()) break;
    for (unsigned bit = 0; bit < shape_.voxels(); ++bit) {
      if (!exists(entries[i].slot, bit)) continue;
      const std::size_t voxel = std::size_t{entries[i].slot} * shape_.voxels() + bit;
      for (std::size_t d = 0; d < kVoxelDirections; ++d) {
        const Vec3 c = code_.color(&light_[voxel * code_.bytes()], d);
        if (c == Vec3{}) continue;
        lit[d] += 1;
        sum[d][0] += c.x, sum[d][1] += c.y, sum[d][2] += c.z;
      }
    }
  }
  for (std::size_t d = 0; d < kVoxelDirections; ++d) {
    if (lit[d] == 0) continue;
    coarsest_.color[d] = {static_cast<float>(sum[d][0] / lit[d]),
                          static_cast<float>(sum[d][1] / lit[d]),
                          static_cast<float>(sum[d][2] / lit[d])};
  }
}

Vec3 VoxelField::irradiance(Vec3 position, Vec3 normal, float width) const {
  const std::array<double, 3> place{(position.x - origin_[0]) / size_,
                                    (position.y - origin_[1]) / size_,
                                    (position.z - origin_[2]) / size_};
  const float level = std::min(level_of(width, size_), static_cast<float>(index_.coarsest()));
  const float whole = std::floor(level);
  const auto fine = static_cast<unsigned>(whole);
  const Vec3 light = at_or_above(place, normal, fine);
  if (level == whole) return light;
  return lerp(light, at_or_above(place, normal, fine + 1), level - whole);
}

Vec3 VoxelField::at_or_above(const std::array<double, 3>& place, Vec3 normal,
                             unsigned level) const {
  for (; level <= index_.coarsest(); ++level) {
    const Sum sum = around(place, normal, level);
    if (sum.found) return sum.along(normal);
  }
  Sum sum;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float side = axis == 0 ? normal.x : axis == 1 ? normal.y : normal.z;
    sum.color[axis] = coarsest_.color[2 * axis + (side >= 0 ? 0 : 1)];
    sum.weight[axis] = sum.color[axis] == Vec3{} ? 0.0F : 1.0F;
  }
  return sum.along(normal);
}

VoxelField::Sum VoxelField::around(const std::array<double, 3>& place, Vec3 normal,
                                   unsigned level) const {
  constexpr float kMinWeight = 1e-6F;
  const std::int64_t cells = std::int64_t{kMaxBrickSide} * shape_.side;
  Sum sum;
  std::array<std::int64_t, 3> first{};
  std::array<std::array<float, 2>, 3> weight{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double at = std::ldexp(place[axis], -static_cast<int>(level)) - 0.5;
    if (!(at >= -1 && at < static_cast<double>(cells))) return sum;
    const double whole = std::floor(at);
    first[axis] = static_cast<std::int64_t>(whole);
    weight[axis][1] = static_cast<float>(at - whole);
    weight[axis][0] = 1 - weight[axis][1];
  }
  std::optional<std::uint32_t> slot;
  Cell last{~0U, ~0U, ~0U};
  for (unsigned i = 0; i < 8; ++i) {
    const std::array<unsigned, 3> step{i & 1, i >> 1 & 1, i >> 2};
    const float w = weight[0][step[0]] * weight[1][step[1]] * weight[2][step[2]];
    Cell cell{};
    bool inside = w > kMinWeight;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t at = first[axis] + step[axis];
      inside = inside && at >= 0 && at < cells;
      cell[axis] = static_cast<std::uint32_t>(at);
    }
    if (!inside) continue;
    const Cell brick{cell[0] / shape_.side, cell[1] / shape_.side, cell[2] / shape_.side};
    if (brick != last) slot = index_.find(level, brick);
    last = brick;
    const unsigned bit = shape_.bit_of(cell);
    if (slot && exists(*slot, bit)) {
      add(sum, std::size_t{*slot} * shape_.voxels() + bit, normal, w);
    }
  }
  return sum;
}

void VoxelField::add(Sum& sum, std::size_t voxel, Vec3 normal, float weight) const {
  sum.found = true;
  const std::array<bool, 3> negative{normal.x < 0, normal.y < 0, normal.z < 0};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Vec3 c = code_.color(&light_[voxel * code_.bytes()], 2 * axis + (negative[axis] ? 1 : 0));
    if (c == Vec3{}) continue;
    sum.color[axis] += c * weight;
    sum.weight[axis] += weight;
  }
}

Vec3 VoxelField::Sum::along(Vec3 normal) const {
  const std::array<float, 3> share{normal.x * normal.x, normal.y * normal.y, normal.z * normal.z};
  Vec3 light;
  float shares = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(weight[axis] > 0)) continue;
    light += color[axis] * (share[axis] / weight[axis]);
    shares += share[axis];
  }
  constexpr float kMinShare = 1e-6F;
  return shares > kMinShare ? light / shares : Vec3{};
}

bool VoxelField::exists(std::uint32_t slot, unsigned bit) const {
  const std::byte* const mask = &bricks_[slot * shape_.place_bytes() + kBrickPlaceBytes];
  return (mask[bit / 8] >> (bit % 8) & std::byte{1}) != std::byte{0};
}

}  // namespace gicodec::voxels
