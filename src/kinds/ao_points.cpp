// Kind 6, AO points (FORMAT.md, "Kinds" and "AO points").
#include <gicodec/ao_points.h>

#include "base/float_bits.h"
#include "base/guard.h"
#include "bitstream/description.h"
#include "kinds/made_volume.h"
#include "kinds/octahedral_code.h"
#include "kinds/record_parts.h"

#include <algorithm>
#include <cmath>

namespace gicodec {
namespace {

Record point_record() noexcept {
  using enum ComponentType;
  return record_of({{"used", 1, opaque},
                    {"x", 5, unorm},
                    {"y", 5, unorm},
                    {"z", 5, unorm},
                    {"u", 4, snorm},
                    {"v", 4, snorm},
                    {"visible", 8, unorm}});
}

// z crosses a 32-bit boundary, which components may not, and so is split.
Record entry_record() noexcept {
  using enum ComponentType;
  return record_of({{"x", 13, uint},
                    {"y", 13, uint},
                    {"z_low", 6, uint},
                    {"z_high", 7, uint},
                    {"used", 1, opaque},
                    {"slot", 24, uint}});
}

Record grid_record() noexcept {
  using enum ComponentType;
  return record_of({{"object", 32, uint},
                    {"mesh", 32, uint},
                    {"x", 32, sfloat},
                    {"y", 32, sfloat},
                    {"z", 32, sfloat},
                    {"cell", 32, sfloat},
                    {"nx", 16, uint},
                    {"ny", 16, uint},
                    {"nz", 16, uint},
                    {"zero", 16, opaque},
                    {"first", 32, uint},
                    {"buckets", 32, uint},
                    {"radius", 32, sfloat}});
}

Record transform_record() noexcept {
  using enum ComponentType;
  return record_of({{"m00", 32, sfloat},
                    {"m01", 32, sfloat},
                    {"m02", 32, sfloat},
                    {"m03", 32, sfloat},
                    {"m10", 32, sfloat},
                    {"m11", 32, sfloat},
                    {"m12", 32, sfloat},
                    {"m13", 32, sfloat},
                    {"m20", 32, sfloat},
                    {"m21", 32, sfloat},
                    {"m22", 32, sfloat},
                    {"m23", 32, sfloat}});
}

std::uint64_t entry_at(std::span<const std::byte> bytes, std::size_t place) noexcept {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    bits |= std::to_integer<std::uint64_t>(bytes[8 * place + i]) << 8 * i;
  }
  return bits;
}

/// Dependencies of a bucket: the cells of its entries, which a client needs with it.
std::size_t cells_of(std::span<const std::byte> bucket, std::span<std::uint32_t> out) {
  std::size_t count = 0;
  for (std::size_t place = 0; place < bucket.size() / 8; ++place) {
    const auto entry = unpack_ao_entry(entry_at(bucket, place));
    if (!entry) continue;
    if (count < out.size()) out[count] = entry->slot;
    ++count;
  }
  return count;
}

Status write(const VolumeDesc& volume, std::vector<std::byte>& out) {
  if (volume.kind != kKindAoPoints || volume.groups.size() != 3) return Status::invalid_description;
  for (const TextureGroup& group : volume.groups) {
    if (group.textures.empty()) return Status::invalid_description;
  }
  const auto slots = [&](std::size_t group) {
    return volume.groups[group].textures.front().desc.grid.x;
  };
  const auto made = ao_point_volume(slots(0), slots(1), slots(2));
  return write_made(volume, made, out, [&](ByteWriter& writer) {
    for (std::size_t group = 0; group < 3; ++group) writer.varint(slots(group));
  });
}

Result<VolumeDesc> read(std::span<const std::byte> description) {
  ByteReader reader(description);
  const auto cells = static_cast<std::uint32_t>(reader.varint(kMaxBlocks));
  const auto buckets = static_cast<std::uint32_t>(reader.varint(kMaxBlocks));
  const auto instances = static_cast<std::uint32_t>(reader.varint(kMaxBlocks));
  if (!reader.ok() || !reader.rest().empty()) return Status::corrupt;
  return read_made(ao_point_volume(cells, buckets, instances));
}

constexpr std::int32_t kNormalSteps = 7;  // codes of an axis: -7..7, and -8, which means -7

std::array<double, 3> from_octahedral(Octahedral code) noexcept {
  return octahedral::direction(code, kNormalSteps);
}

/// The nearest of the four codes around; the first of equally near ones.
Octahedral to_octahedral(const std::array<float, 3>& normal) noexcept {
  std::array<double, 3> n{normal[0], normal[1], normal[2]};
  const double size = std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]);
  if (!(size > 0) || !std::isfinite(size)) return {};
  for (double& axis : n) axis /= size;
  double a = n[0], b = n[1];
  if (n[2] < 0) octahedral::fold(a, b);
  const auto u = static_cast<std::int32_t>(std::floor(a * kNormalSteps));
  const auto v = static_cast<std::int32_t>(std::floor(b * kNormalSteps));
  Octahedral best;
  double nearest = -2;
  for (std::int32_t i = 0; i < 4; ++i) {
    const auto within = [](std::int32_t c) { return std::clamp(c, -kNormalSteps, kNormalSteps); };
    const Octahedral code{within(u + i % 2), within(v + i / 2)};
    const auto d = from_octahedral(code);
    const double cosine = d[0] * n[0] + d[1] * n[1] + d[2] * n[2];
    if (cosine > nearest) nearest = cosine, best = code;
  }
  return octahedral::unique(best, kNormalSteps);
}

std::uint32_t to_place(double place) noexcept {
  return place > 0 ? static_cast<std::uint32_t>(std::min(place * 32, 31.0)) : 0;
}

}  // namespace

constinit const Kind kAoPoints{kKindAoPoints, "ao_points", write, read, nullptr};

Result<VolumeDesc> ao_point_volume(std::uint32_t cells, std::uint32_t buckets,
                                   std::uint32_t instances) {
  return guarded([&]() -> Result<VolumeDesc> {
    constexpr BlockShape kOne{1, 1, 1};
    VolumeDesc volume{kKindAoPoints, {{}, {}, {}}};
    volume.groups[0].textures = {
        {"cells", pool_texture(point_record(), cells, {kAoCellPoints, 1, 1}), Threshold::exact}};
    volume.groups[1].textures = {{"buckets",
                                  pool_texture(entry_record(), buckets, {kAoBucketEntries, 1, 1}),
                                  Threshold::exact}};
    volume.groups[1].depends_on = 0;
    volume.groups[1].dependencies = cells_of;
    volume.groups[2].textures = {
        {"grid", pool_texture(grid_record(), instances, kOne), Threshold::exact},
        {"transform", pool_texture(transform_record(), instances, kOne), Threshold::exact}};
    if (const Status status = validate(volume); status != Status::ok) return status;
    return volume;
  });
}

std::uint32_t pack_ao_point(const AoPoint& point) noexcept {
  const Octahedral normal = to_octahedral(point.normal);
  const auto nibble = [](std::int32_t code) { return static_cast<std::uint32_t>(code) & 15U; };
  return 1U | to_place(point.place[0]) << 1 | to_place(point.place[1]) << 6 |
         to_place(point.place[2]) << 11 | nibble(normal.u) << 16 | nibble(normal.v) << 20 |
         std::uint32_t{point.visible} << 24;
}

std::optional<AoPoint> unpack_ao_point(std::uint32_t bits) noexcept {
  if ((bits & 1U) == 0) return std::nullopt;
  const auto code = [](std::uint32_t nibble) {
    return static_cast<std::int32_t>((nibble & 15U) ^ 8U) - 8;
  };
  AoPoint point;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    point.place[axis] = (static_cast<float>(bits >> (1 + 5 * axis) & 31U) + 0.5F) / 32;
  }
  const auto normal = from_octahedral({code(bits >> 16), code(bits >> 20)});
  for (std::size_t axis = 0; axis < 3; ++axis) {
    point.normal[axis] = static_cast<float>(normal[axis]);
  }
  point.visible = static_cast<std::uint8_t>(bits >> 24);
  return point;
}

std::uint64_t pack_ao_entry(const AoEntry& entry) noexcept {
  return std::uint64_t{entry.cell.x} | std::uint64_t{entry.cell.y} << 13 |
         std::uint64_t{entry.cell.z} << 26 | std::uint64_t{1} << 39 |
         std::uint64_t{entry.slot} << 40;
}

std::optional<AoEntry> unpack_ao_entry(std::uint64_t bits) noexcept {
  if ((bits >> 39 & 1U) == 0) return std::nullopt;
  const auto side = [](std::uint64_t v) { return static_cast<std::uint32_t>(v & 0x1FFFU); };
  return AoEntry{{side(bits), side(bits >> 13), side(bits >> 26)},
                 static_cast<std::uint32_t>(bits >> 40)};
}

namespace {

constexpr std::size_t kGridWords = kAoGridBytes / 4;

}  // namespace

void pack_ao_grid(const AoGrid& grid, std::span<std::byte, kAoGridBytes> out) noexcept {
  const std::array<std::uint32_t, kGridWords> words{grid.object,
                                                    grid.mesh,
                                                    bits_of(grid.origin[0]),
                                                    bits_of(grid.origin[1]),
                                                    bits_of(grid.origin[2]),
                                                    bits_of(grid.cell),
                                                    grid.cells.x | grid.cells.y << 16,
                                                    grid.cells.z,
                                                    grid.first_bucket,
                                                    grid.buckets,
                                                    bits_of(grid.radius)};
  for (std::size_t i = 0; i < kAoGridBytes; ++i) {
    out[i] = static_cast<std::byte>(words[i / 4] >> i % 4 * 8);
  }
}

AoGrid unpack_ao_grid(std::span<const std::byte, kAoGridBytes> bytes) noexcept {
  std::array<std::uint32_t, kGridWords> words{};
  for (std::size_t i = 0; i < kAoGridBytes; ++i) {
    words[i / 4] |= std::to_integer<std::uint32_t>(bytes[i]) << i % 4 * 8;
  }
  AoGrid grid;
  grid.object = words[0];
  grid.mesh = words[1];
  grid.origin = {float_of(words[2]), float_of(words[3]), float_of(words[4])};
  grid.cell = float_of(words[5]);
  grid.cells = {words[6] & 0xFFFFU, words[6] >> 16, words[7] & 0xFFFFU};
  grid.first_bucket = words[8];
  grid.buckets = words[9];
  grid.radius = float_of(words[10]);
  return grid;
}

std::uint64_t ao_bucket(const AoGrid& grid, const Grid& cell) noexcept {
  // At most 2^13 · 2^13 · 2^13 · 32: no overflow.
  const std::uint64_t dx = grid.cells.x, dy = grid.cells.y;
  const std::uint64_t hash = cell.x + cell.y * dx * 17 + cell.z * dx * dy * 31;
  return grid.first_bucket + hash % grid.buckets;
}

std::optional<std::uint32_t> find_ao_cell(const AoGrid& grid, const Grid& cell,
                                          std::span<const std::byte> buckets,
                                          std::uint32_t cells) noexcept {
  constexpr std::size_t kBucketBytes = 8 * kAoBucketEntries;
  const Grid& sides = grid.cells;
  if (grid.buckets == 0 || std::max({sides.x, sides.y, sides.z}) > kMaxAoGridSide ||
      cell.x >= sides.x || cell.y >= sides.y || cell.z >= sides.z) {
    return std::nullopt;
  }
  const std::uint64_t bucket = ao_bucket(grid, cell);
  if (bucket >= buckets.size() / kBucketBytes) return std::nullopt;
  const auto block = buckets.subspan(static_cast<std::size_t>(bucket) * kBucketBytes, kBucketBytes);
  for (std::size_t place = 0; place < kAoBucketEntries; ++place) {
    const auto entry = unpack_ao_entry(entry_at(block, place));
    if (entry && entry->cell == cell) {
      return entry->slot < cells ? std::optional(entry->slot) : std::nullopt;
    }
  }
  return std::nullopt;
}

}  // namespace gicodec
