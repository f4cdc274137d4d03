#include "session/any_volume.h"

#include "shapes.h"

#include <gicodec/irradiance_vectors.h>
#include <gicodec/probes.h>

#include "bitstream/description.h"
#include "texture/view.h"

#include <algorithm>
#include <cstring>

namespace gicodec::test {
namespace {

std::size_t named_by(std::span<const std::byte> block, std::span<std::uint32_t> out) {
  const std::size_t count = block.size() / 4;
  std::memcpy(out.data(), block.data(), 4 * std::min(count, out.size()));
  return count;
}

float rank_of(std::span<const std::byte> block) { return std::to_integer<std::uint8_t>(block[0]); }

Status write(const VolumeDesc& volume, std::vector<std::byte>& out) {
  ByteWriter writer(out);
  writer.varint(volume.groups.size());
  for (const TextureGroup& group : volume.groups) {
    writer.fixed(static_cast<std::uint8_t>(group.bundled));
    writer.fixed(group.presence);
    writer.fixed(group.depends_on);
    writer.fixed(static_cast<std::uint8_t>(group.rank != nullptr));
    writer.varint(group.textures.size());
    for (const NamedTexture& texture : group.textures) {
      writer.text(texture.name);
      write_texture(texture.desc, writer);
    }
  }
  return Status::ok;
}

Result<VolumeDesc> read(std::span<const std::byte> description) {
  ByteReader reader(description);
  VolumeDesc volume{kKindAny, {}};
  volume.groups.resize(reader.varint(kMaxGroups));
  for (TextureGroup& group : volume.groups) {
    group.bundled = reader.fixed<std::uint8_t>() != 0;
    group.presence = reader.fixed<std::uint8_t>();
    group.depends_on = reader.fixed<std::uint8_t>();
    if (group.depends_on != TextureGroup::kNone) group.dependencies = named_by;
    if (reader.fixed<std::uint8_t>() != 0) group.rank = rank_of;
    group.textures.resize(reader.varint(kMaxVolumeTextures));
    for (NamedTexture& texture : group.textures) {
      texture.name = reader.text(255);
      texture.desc = read_texture(reader);
    }
  }
  if (!reader.ok() || !reader.rest().empty() || validate(volume) != Status::ok) {
    return Status::corrupt;
  }
  return volume;
}

constexpr std::uint32_t kMaxRecords = 64;  ///< of a block

TextureDesc plain(Format format, BlockShape block) {
  TextureDesc desc;
  desc.record = format;
  desc.block = block;
  desc.model = Model::none;
  return desc;
}

}  // namespace

constinit const Kind kAny{kKindAny, "any", write, read, nullptr};

Bytes block_of(const TextureDesc& desc, std::span<const std::byte> texels, std::uint32_t block) {
  const auto view = *check_view<const std::byte>(desc, ConstTextureView(texels));
  const std::byte* const first = view.at(block_origin(desc, block), desc.record.bytes);
  const std::size_t band = 2U * desc.guard_band;
  const std::size_t row = (desc.block.x + band) * desc.record.bytes;
  Bytes out;
  for (std::size_t z = 0; z < desc.block.z; ++z) {
    for (std::size_t y = 0; y < desc.block.y + band; ++y) {
      const std::byte* const from = first + z * view.slice_pitch + y * view.row_pitch;
      out.insert(out.end(), from, from + row);
    }
  }
  return out;
}

AnyVolume::AnyVolume(Random& random) {
  const Grid grid{pick(random, 1, 5), pick(random, 1, 4), pick(random, 1, 5)};
  geometry_.grid = grid;
  const auto kind = pick(random, 0, 3);
  if (kind == 0) make_probes(random);
  if (kind == 1) desc_ = *irradiance_vector_volume(grid, chance(random, 2));
  if (kind > 1) make_any(random);
  finish(random);
}

void AnyVolume::make_probes(Random& random) {
  std::vector<NamedTexture> textures;
  for (const char* name : {"first", "second"}) {
    TextureDesc desc = probe_desc(random, 1000);
    const auto core = static_cast<std::uint8_t>(pick(random, 1, 6));
    desc = probe_texture(desc.record, geometry_.grid, core, desc.guard_band);
    desc.layout = any_layout(random, desc);
    textures.push_back({name, desc});
  }
  desc_ = *probe_volume(textures);
}

TextureGroup AnyVolume::make_set(Random& random, std::size_t place) {
  TextureGroup group;
  group.bundled = chance(random, 2);
  for (std::uint32_t i = 0, textures = pick(random, 1, 2); i < textures; ++i) {
    TextureDesc desc;
    do {
      desc = any_desc(random, kMaxRecords);
    } while (record_count(desc.block) > kMaxRecords || validate(desc) != Status::ok);
    desc.records = {};
    if (i > 0 || chance(random, 3)) {
      desc.presence = Presence::all;
      if (desc.model == Model::octree) desc.model = Model::none;
    }
    group.textures.push_back({"", desc});
  }
  const TextureDesc& first = group.textures[0].desc;
  if (first.presence != Presence::all) {
    const auto bytes = static_cast<std::uint8_t>(presence_bytes(first));
    group.bundled = true;
    group.presence = 0;
    group.textures.insert(group.textures.begin(), {"", plain(Format::R8_UINT, {bytes, 1, 1})});
  } else if (place > 0 && chance(random, 2)) {
    group.depends_on = static_cast<std::uint8_t>(place - 1);
    group.dependencies = named_by;
    group.textures.insert(group.textures.begin(), {"", plain(Format::R32_UINT, {2, 1, 1})});
  }
  if (chance(random, 4)) group.rank = rank_of;
  return group;
}

void AnyVolume::make_any(Random& random) {
  desc_.kind = kKindAny;
  for (std::size_t place = 0, groups = pick(random, 1, 3); place < groups; ++place) {
    TextureGroup group = make_set(random, place);
    const bool bricks = std::ranges::any_of(group.textures, [](const NamedTexture& texture) {
      return texture.desc.presence == Presence::brick;
    });
    const bool pool = chance(random, 2) || bricks;
    Grid grid{pick(random, 1, 4), pick(random, 1, 3), pick(random, 1, 3)};
    if (pool) grid = {pick(random, 1, 30), 1, 1};
    if (place == 0) geometry_.grid = grid;
    for (NamedTexture& texture : group.textures) {
      TextureDesc& desc = texture.desc;
      desc.space = pool ? Space::pool : Space::grid;
      desc.grid = grid;
      const bool of_grids = desc.model == Model::stacked || desc.model == Model::continuous ||
                            desc.model == Model::hemispheres;
      if (pool && of_grids) desc.model = Model::none;
      desc.layout = {};
      desc.layout = any_layout(random, desc);
      texture.name =
          "texture " + std::to_string(place) + "." + std::to_string(&texture - &group.textures[0]);
    }
    desc_.groups.push_back(std::move(group));
  }
}

void AnyVolume::finish(Random& random) {
  const bool linked = std::ranges::any_of(desc_.groups, [](const TextureGroup& group) {
    return group.depends_on != TextureGroup::kNone;
  });
  std::uint32_t interval = pick(random, 1, 2);
  for (const TextureGroup& group : desc_.groups) {
    if (!linked) interval = pick(random, 1, 2);
    for (const NamedTexture& texture : group.textures) {
      if (!linked && !group.bundled) interval = pick(random, 1, 2);
      streamed_.push_back({texture.name, interval, 0});
      textures_.push_back(std::make_unique<Texture>(texture.desc));
    }
  }
  sent_.resize(textures_.size());
}

std::uint8_t AnyVolume::first_of(std::size_t group) const {
  std::size_t first = 0;
  for (std::size_t s = 0; s < group; ++s) first += desc_.groups[s].textures.size();
  return static_cast<std::uint8_t>(first);
}

std::uint32_t AnyVolume::blocks(std::size_t group) const {
  return block_count(desc_.groups[group].textures[0].desc);
}

std::optional<std::uint8_t> AnyVolume::presence_of(std::uint8_t id) const {
  if (texture(id).presence == Presence::all) return std::nullopt;
  std::size_t group = 0;
  while (first_of(group + 1) <= id) ++group;
  return static_cast<std::uint8_t>(first_of(group) + desc_.groups[group].presence);
}

Scroll AnyVolume::scroll(Random& random) {
  const Scroll before = geometry_.scroll;
  for (auto& cells : geometry_.scroll) {
    cells += static_cast<std::int32_t>(pick(random, 0, 4)) - 2;
  }
  entered_ = entering_blocks(geometry_.grid, before, geometry_.scroll);
  return geometry_.scroll;
}

void AnyVolume::fill(Random& random, std::size_t group, std::uint8_t id,
                     std::span<const std::uint32_t> blocks_in) {
  const TextureGroup& of = desc_.groups[group];
  Texture& texture = *textures_[id];
  const bool depends = of.depends_on != TextureGroup::kNone && id == first_of(group);
  for (const std::uint32_t block : blocks_in) {
    if (depends) {
      for (std::uint32_t x = 0; x < 2; ++x) {
        const std::uint32_t name = pick(random, 0, blocks(of.depends_on) + 1);
        std::memcpy(texture.record(block, x, 0).data(), &name, sizeof name);
      }
      continue;
    }
    texture.fill_block(block, chance(random, 4) ? Fill::zero : Fill::noise, random);
    if (!chance(random, 4)) texture.fill_band(block);
  }
}

void AnyVolume::change(Random& random,
                       const std::function<Status(std::uint8_t, ConstTextureView)>& publish) {
  const auto say = [&](std::uint8_t id) {
    if (publish(id, std::as_const(*textures_[id]).view()) != Status::ok) std::abort();
  };
  for (std::size_t s = 0; s < desc_.groups.size(); ++s) {
    const TextureGroup& group = desc_.groups[s];
    const std::uint8_t first = first_of(s);
    const bool scrolls = group.textures[0].desc.space == Space::grid &&
                         group.textures[0].desc.grid == geometry_.grid;
    const auto changed = [&] {
      auto selection = random_selection(random, blocks(s));
      if (scrolls) selection.insert(selection.end(), entered_.begin(), entered_.end());
      return selection;
    };
    const bool moved = first_ || (scrolls && !entered_.empty());
    bool presence = false;
    if (group.presence != TextureGroup::kNone && (moved || chance(random, 2))) {
      presence = true;
      for (std::size_t i = 0; i < group.textures.size(); ++i) {
        const TextureDesc& desc = group.textures[i].desc;
        if (desc.presence == Presence::all) continue;
        const Bytes all = any_presence(random, desc);
        const std::size_t size = presence_bytes(desc);
        for (const std::uint32_t block : changed()) {
          textures_[first + group.presence]->set_block(block,
                                                       std::span(all).subspan(block * size, size));
        }
      }
      say(static_cast<std::uint8_t>(first + group.presence));
    }
    for (std::size_t i = 0; i < group.textures.size(); ++i) {
      if (i == group.presence) continue;
      const bool must = moved || (presence && group.textures[i].desc.presence != Presence::all);
      if (!must && chance(random, 4)) continue;
      const auto id = static_cast<std::uint8_t>(first + i);
      fill(random, s, id, changed());
      say(id);
    }
  }
  entered_.clear();
  first_ = false;
}

void AnyVolume::updated(std::uint64_t update) {
  for (std::uint8_t id = 0; id < textures_.size(); ++id) {
    if (update % streamed_[id].interval != 0) continue;
    sent_[id].clear();
    for (std::uint32_t b = 0; b < block_count(texture(id)); ++b) sent_[id].push_back(block(id, b));
  }
}

Bytes AnyVolume::block(std::uint8_t id, std::uint32_t block, bool sent) const {
  if (sent) return sent_[id].empty() ? Bytes() : sent_[id][block];
  Bytes records = textures_[id]->block(block);
  if (const auto presence = presence_of(id)) {
    clear_absent_records(texture(id), textures_[*presence]->block(block), records);
  }
  return records;
}

std::vector<std::uint32_t> AnyVolume::dependencies(std::size_t group, const Bytes& records) const {
  const TextureGroup& of = desc_.groups[group];
  if (of.depends_on == TextureGroup::kNone) return {};
  std::vector<std::uint32_t> blocks_of(2);
  static_cast<void>(of.dependencies(records, blocks_of));
  std::erase_if(blocks_of, [&](std::uint32_t name) { return name >= blocks(of.depends_on); });
  return blocks_of;
}

std::vector<BlockMask> AnyVolume::wanted(std::vector<BlockMask> visible,
                                         const std::vector<BlockMask>& active) const {
  for (std::size_t s = visible.size(); s-- > 0;) {
    for (std::uint32_t block = 0; block < visible[s].size(); ++block) {
      if (!active[s].empty() && active[s][block] == 0) visible[s][block] = 0;
      if (visible[s][block] == 0) continue;
      for (const std::uint32_t name : dependencies(s, textures_[first_of(s)]->block(block)))
        visible[desc_.groups[s].depends_on][name] = 1;
    }
  }
  return visible;
}

std::uint32_t AnyVolume::missing(const std::vector<BlockMask>& visible,
                                 const std::vector<BlockMask>& active, const Held& held) const {
  if (first_) return 0;
  std::uint32_t count = 0;
  const auto masks = wanted(visible, active);
  for (std::size_t s = 0; s < masks.size(); ++s) {
    const TextureGroup& group = desc_.groups[s];
    for (std::uint32_t b = 0; b < masks[s].size(); ++b) {
      if (masks[s][b] == 0) continue;
      std::uint32_t missing = 0;
      for (std::size_t i = 0; i < group.textures.size(); ++i) {
        const auto id = static_cast<std::uint8_t>(first_of(s) + i);
        const auto found = held(id, b);
        missing += !found || *found != block(id, b);
      }
      count += group.bundled ? std::min(missing, 1U) : missing;
    }
  }
  return count;
}

}  // namespace gicodec::test
