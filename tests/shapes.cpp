#include "shapes.h"

#include <algorithm>
#include <array>

namespace gicodec::test {

Record custom_record(Random& random, std::uint8_t bytes) {
  struct Piece {
    unsigned offset, bits;
  };
  std::vector<Piece> pieces;
  const unsigned words = (bytes + 3U) / 4;
  for (unsigned word = 0; word < words; ++word) {
    const unsigned end = std::min(bytes * 8U, word * 32 + 32);
    for (unsigned at = word * 32; at < end;) {
      // What is left is enough for one piece of each word to come.
      const auto room = kMaxComponents - pieces.size() - (words - word - 1);
      const unsigned bits = room == 1 ? end - at : pick(random, 1, end - at);
      pieces.push_back({at, bits});
      at += bits;
    }
  }
  std::shuffle(pieces.begin(), pieces.end(), random);
  Record record;
  record.bytes = bytes;
  for (const auto& [offset, bits] : pieces) {
    constexpr std::array kKinds{ComponentType::unorm,  ComponentType::snorm,
                                ComponentType::uint,   ComponentType::opaque,
                                ComponentType::ufloat, ComponentType::sfloat};
    auto kind = kKinds[random() % kKinds.size()];
    if (kind == ComponentType::ufloat && bits > 11) kind = ComponentType::uint;
    if (kind == ComponentType::sfloat && bits != 16 && bits != 32) kind = ComponentType::exponent;
    record.components[record.count] = {std::string("c").append(std::to_string(record.count)),
                                       static_cast<std::uint16_t>(offset),
                                       static_cast<std::uint8_t>(bits), kind};
    ++record.count;
  }
  return record;
}

Record any_record(Random& random) {
  if (chance(random, 2)) return formats()[random() % formats().size()].record;
  constexpr std::array<std::uint8_t, 5> kOdd{1, 3, 5, 12, 64};
  return custom_record(random, chance(random, 2)
                                   ? kOdd[random() % kOdd.size()]
                                   : static_cast<std::uint8_t>(pick(random, 1, kMaxRecordBytes)));
}

Layout any_layout(Random& random, const TextureDesc& desc) {
  Layout layout(static_cast<Tiling>(random() % kTilingCount));
  if (desc.records == Grid{} && chance(random, 3)) {
    layout.pad_before = static_cast<std::uint8_t>(random() % 3);
    layout.pad_after = static_cast<std::uint8_t>(random() % 3);
  }
  if (desc.space == Space::pool && chance(random, 2)) {
    layout.slots.x = pick(random, 1, desc.grid.x);
    layout.slots.y = pick(random, 1, (desc.grid.x + layout.slots.x - 1) / layout.slots.x);
    const std::uint32_t plane = layout.slots.x * layout.slots.y;
    layout.slots.z = (desc.grid.x + plane - 1) / plane + random() % 2;
  }
  return layout;
}

namespace {

/// Halves the longest axes of a grid until the texture has at most so many records.
void shrink(TextureDesc& desc, std::uint32_t max_records) {
  const std::size_t block = guarded_bytes(desc) / desc.record.bytes;
  while (block_count(desc) > 1 && block_count(desc) * block > max_records) {
    auto& grid = desc.grid;
    auto& widest = grid.x >= std::max(grid.y, grid.z)   ? grid.x
                   : std::max(grid.y, grid.z) == grid.y ? grid.y
                                                        : grid.z;
    widest = (widest + 1) / 2;
  }
}

std::uint8_t any_side(Random& random) {
  return static_cast<std::uint8_t>(pick(random, 1, chance(random, 8) ? kMaxBlockSide : 6));
}

Model any_model(Random& random, const TextureDesc& desc) {
  const bool plain = desc.guard_band == 0 && desc.records == Grid{};
  if (plain && desc.presence != Presence::mask && chance(random, 6)) return Model::unordered;
  if (desc.space == Space::pool || chance(random, 3)) return Model::none;
  return chance(random, 2) ? Model::stacked : Model::continuous;
}

}  // namespace

TextureDesc probe_desc(Random& random, std::uint32_t max_records) {
  TextureDesc desc;
  desc.record = formats()[random() % formats().size()].record;
  constexpr std::array<std::uint8_t, 4> kUsual{6, 8, 14, 16};
  desc.block.x =
      chance(random, 3)
          ? kUsual[random() % kUsual.size()]
          : static_cast<std::uint8_t>(pick(random, 1, chance(random, 4) ? kMaxBlockSide : 9));
  desc.block.y = desc.block.x;
  desc.guard_band = static_cast<std::uint8_t>(random() % 2);
  desc.grid = {pick(random, 1, 7), pick(random, 1, 5), pick(random, 1, 5)};
  shrink(desc, max_records);
  desc.layout = any_layout(random, desc);
  return desc;
}

TextureDesc any_desc(Random& random, std::uint32_t max_records) {
  if (chance(random, 4)) return probe_desc(random, max_records);
  TextureDesc desc;
  if (chance(random, 12)) {
    desc.record = colored_direction(chance(random, 2));
    desc.block = {6, 1, 1};
    desc.grid = {pick(random, 1, 6), pick(random, 1, 4), pick(random, 1, 4)};
    shrink(desc, max_records);
    desc.model = Model::hemispheres;
    desc.layout = any_layout(random, desc);
    return desc;
  }
  desc.record = any_record(random);
  if (chance(random, 12)) {
    constexpr std::array kLight{Format::E5B9G9R9_UFLOAT_PACK32, Format::R16G16B16A16_SFLOAT};
    if (!chance(random, 4)) desc.record = kLight[random() % kLight.size()];
    const std::uint8_t side = chance(random, 4) ? 4 : 2;
    desc.block = {static_cast<std::uint8_t>(kVoxelDirections * side), side, side};
    desc.space = Space::pool;
    desc.grid = {pick(random, 1, 16), 1, 1};
    shrink(desc, max_records);
    desc.presence = Presence::brick;
    desc.model = Model::octree;
    desc.layout = any_layout(random, desc);
    return desc;
  }
  desc.block = {any_side(random), any_side(random), any_side(random)};
  while (record_count(desc.block) > std::min(kMaxBlockRecords, max_records)) {
    desc.block.z = static_cast<std::uint8_t>((desc.block.z + 1) / 2);
    desc.block.y = static_cast<std::uint8_t>((desc.block.y + 1) / 2);
  }
  if (chance(random, 4)) {
    desc.block = {desc.block.y, desc.block.y, 1};
    desc.guard_band = static_cast<std::uint8_t>(random() % 2);
  }
  desc.grid = {pick(random, 1, 6), pick(random, 1, 4), pick(random, 1, 4)};
  if (chance(random, 3)) {
    desc.space = Space::pool;
    desc.grid = {pick(random, 1, 60), 1, 1};
  }
  shrink(desc, max_records);
  // What does not exist is zero: no guard band could follow from it by the rule.
  if (desc.guard_band == 0) desc.presence = static_cast<Presence>(random() % 3);
  if (desc.space == Space::grid && desc.guard_band == 0 && chance(random, 3)) {
    desc.records = {desc.grid.x * desc.block.x - pick(random, 0, desc.block.x - 1U),
                    desc.grid.y * desc.block.y - pick(random, 0, desc.block.y - 1U),
                    desc.grid.z * desc.block.z - pick(random, 0, desc.block.z - 1U)};
  }
  desc.model = any_model(random, desc);
  desc.layout = any_layout(random, desc);
  return desc;
}

TextureDesc bricks() {
  TextureDesc desc = probe_texture(Format::R32_SFLOAT, {3, 2, 5}, 8, 0);
  desc.block.z = 2;
  return desc;
}

namespace {

/// Eight bytes of a brick at one of 3·4³ places.
void put_place(std::uint32_t number, Bytes& presence) {
  presence[0] = static_cast<std::byte>(number & 63);
  presence[7] = static_cast<std::byte>(number / 64 % 3);
}

/// With exists(block, record) and place(block).
template <typename Exists, typename Place>
Bytes presence_by(const TextureDesc& desc, Exists&& exists, Place&& place) {
  const std::uint32_t records = record_count(desc.block);
  Bytes all;
  for (std::uint32_t block = 0; block < block_count(desc); ++block) {
    Bytes one(presence_bytes(desc));
    std::uint32_t count = 0;
    for (std::uint32_t r = 0; r < records; ++r) {
      if (!exists(block, r)) continue;
      ++count;
      if (desc.presence == Presence::mask) one[r / 8] |= static_cast<std::byte>(1U << r % 8);
      if (desc.presence == Presence::brick) {
        const std::uint32_t voxel = r / kVoxelDirections;
        one[8 + voxel / 8] |= static_cast<std::byte>(1U << voxel % 8);
      }
    }
    if (desc.presence == Presence::count) {
      one = {static_cast<std::byte>(count & 255), static_cast<std::byte>(count >> 8)};
    }
    if (desc.presence == Presence::brick) put_place(place(block), one);
    all.insert(all.end(), one.begin(), one.end());
  }
  return all;
}

}  // namespace

Bytes any_presence(Random& random, const TextureDesc& desc) {
  std::uint32_t seen = block_count(desc);
  std::uint32_t one_in = 0;
  const auto exists = [&](std::uint32_t block, std::uint32_t) {
    if (block != seen) one_in = static_cast<std::uint32_t>(random() % 4);  // Nothing, all, some.
    seen = block;
    return one_in != 0 && chance(random, one_in);
  };
  // Mostly where it was.
  const auto place = [&](std::uint32_t block) {
    return chance(random, 4) ? static_cast<std::uint32_t>(random()) : block * 5;
  };
  return presence_by(desc, exists, place);
}

Bytes full_presence(const TextureDesc& desc) {
  return presence_by(
      desc, [](std::uint32_t, std::uint32_t) { return true; },
      [](std::uint32_t block) { return block; });
}

}  // namespace gicodec::test
