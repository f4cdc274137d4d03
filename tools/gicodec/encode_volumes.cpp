#include "encode_volumes.h"

#include "common/volume_words.h"
#include "dump/block_place.h"
#include "dump/cure.h"
#include "dump/error.h"

#include <gicodec/engines.h>
#include <gicodec/probes.h>
#include <gicodec/textures.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <set>

namespace gicodec::tools {
namespace {

using Input = std::pair<const Sequence*, StoredTexture>;
using Textures = std::span<const StoredTexture* const>;

/// True if two textures belong to one volume.
bool side_by_side(const TextureDesc& a, const TextureDesc& b) {
  return a.grid == b.grid && is_probes(a) == is_probes(b);
}

/// The inputs in the order of a layout's textures. Throws if one is missing.
std::vector<Input> by_layout(const GeometryFlags& flags, const VolumeDesc& volume,
                             const std::vector<Sequence>& sequences) {
  // Reports files that the layout does not have before missing ones.
  for (const Sequence& sequence : sequences) (void)hints_for(flags, sequence.name);
  std::vector<Input> all;
  for (const NamedTexture* texture : textures_of(volume)) {
    const auto found = std::ranges::find(sequences, texture->name, &Sequence::name);
    if (found == sequences.end()) {
      fail(Exit::usage, "--layout {} has textures {}, and there are no files of {}", flags.layout,
           texture_names(volume), texture->name);
    }
    auto textures_found = inspect(*found, hints_for(flags, found->name));
    if (textures_found.size() != 1) {
      fail(Exit::bad_input, "{}: holds {} images, and --layout {} has one in each file",
           found->frames.front().path, textures_found.size(), flags.layout);
    }
    all.emplace_back(&*found, std::move(textures_found.front()));
  }
  return all;
}

std::set<std::string> names_of(const VolumeDesc& volume) {
  std::set<std::string> names;
  for (const NamedTexture* texture : textures_of(volume)) names.insert(texture->name);
  return names;
}

/// The geometry of a texture, if all its dumps agree.
std::optional<VolumeGeometry> stored_geometry(const StoredTexture& texture) {
  for (const FrameAttribute& change : texture.changes) {
    const std::string& name = change.attribute.name;
    if (name == kOriginAttribute || name == kSpacingAttribute) return std::nullopt;
  }
  const auto origin = find_floats(texture.info.attributes, kOriginAttribute, 3);
  const auto spacing = find_floats(texture.info.attributes, kSpacingAttribute, 3);
  if (!origin || !spacing) return std::nullopt;
  VolumeGeometry place{texture.info.desc.grid};
  std::ranges::copy(*origin, place.origin.begin());
  std::ranges::copy(*spacing, place.spacing.begin());
  if (validate(place) != Status::ok) return std::nullopt;
  return place;
}

/// The geometry on which all textures of a volume agree, over the grid of the first.
std::optional<VolumeGeometry> common_place(Textures textures) {
  const auto place = stored_geometry(*textures.front());
  for (const StoredTexture* texture : textures) {
    auto own = stored_geometry(*texture);
    if (own) own->grid = textures.front()->info.desc.grid;
    if (own != place) return std::nullopt;
  }
  return place;
}

/// A volume of kind probes if possible, else of kind textures, a group for each run of one grid.
Result<VolumeDesc> volume_of(const std::vector<NamedTexture>& textures) {
  const auto alike = [&](const NamedTexture& other) {
    return side_by_side(textures.front().desc, other.desc);
  };
  if (is_probes(textures.front().desc) && std::ranges::all_of(textures, alike)) {
    return probe_volume(textures);
  }
  std::vector<TextureGroup> groups;
  for (const NamedTexture& texture : textures) {
    const bool joins =
        !groups.empty() && side_by_side(groups.back().textures.front().desc, texture.desc);
    if (!joins) groups.emplace_back();
    groups.back().textures.push_back(texture);
  }
  return texture_volume(groups);
}

/// How many textures make the next volume: all images of a file, or those of one grid that are
/// alone in their files.
std::size_t next_volume(Textures textures) {
  const auto alone = [&](std::size_t i) {
    return i + 1 == textures.size() || !of_one_file(*textures[i], *textures[i + 1]);
  };
  constexpr std::size_t kMost = 255;  ///< of a volume
  const StoredTexture& first = *textures.front();
  std::size_t count = 1;
  if (!alone(0)) {
    while (count < textures.size() && count < kMost && of_one_file(first, *textures[count]))
      ++count;
    return count;
  }
  while (count < textures.size() && count < kMost && alone(count) &&
         side_by_side(textures[count]->info.desc, first.info.desc)) {
    ++count;
  }
  return count;
}

}  // namespace

std::string layout_question(const GeometryFlags& flags, const std::vector<Sequence>& sequences) {
  const bool layout_given = !flags.layout.empty() || !flags.grid.empty() || !flags.block.empty();
  std::set<std::string> names;
  for (const Sequence& sequence : sequences) {
    names.insert(sequence.name);
    // Other files describe themselves.
    if (layout_given || image_kind(sequence.frames.front().path) != ImageKind::dds) return "";
  }
  for (const EngineLayout& layout : engine_layouts()) {
    const auto volume = layout.make({1, 1, 1});
    if (!volume || names_of(*volume) != names) continue;
    return fmt::format(
        "the files are named as the textures of --layout {} are: with it, and --grid, they are "
        "packed as what they are there rather than as any textures",
        layout.name);
  }
  return "";
}

std::vector<Input> inspect_all(const GeometryFlags& flags, const std::vector<Sequence>& sequences) {
  if (const auto layout = layout_volume(flags)) return by_layout(flags, *layout, sequences);
  std::vector<Input> all, images;
  for (const Sequence& sequence : sequences) {
    auto textures = inspect(sequence, hints_for(flags, sequence.name));
    if (textures.size() > 1) {
      for (StoredTexture& image : textures) images.emplace_back(&sequence, std::move(image));
      continue;
    }
    StoredTexture& stored = textures.front();
    const auto last = std::find_if(all.rbegin(), all.rend(), [&](const auto& other) {
      return side_by_side(other.second.info.desc, stored.info.desc);
    });
    all.insert(last == all.rend() ? all.end() : last.base(), Input(&sequence, std::move(stored)));
  }
  std::ranges::move(images, std::back_inserter(all));
  return all;
}

void add_volumes(ContainerDescription& description, const GeometryFlags& flags, Textures textures,
                 const std::string& output) {
  if (const auto layout = layout_volume(flags)) {
    check(add_volume(description, flags.layout, *layout), output);
    description.volumes.back().geometry = common_place(textures);
    return;
  }
  while (!textures.empty()) {
    const Textures own = textures.first(next_volume(textures));
    const StoredTexture& first = *own.front();
    const bool images = own.size() > 1 && of_one_file(first, *own[1]);
    const std::string name = images ? first.file : to_string(first.info.desc.grid);
    std::vector<NamedTexture> named;
    for (const StoredTexture* texture : own) {
      named.push_back({texture->name, texture->info.desc, {}, {}});
    }
    const std::string where =
        images ? fmt::format("{}: the {} images of {}", output, named.size(), name)
               : fmt::format("{}: {} textures of grid {}", output, named.size(), name);
    check(add_volume(description, name, take(volume_of(named), where)), where);
    description.volumes.back().geometry = common_place(own);
    textures = textures.subspan(own.size());
  }
}

void spread_metadata(Described& described, std::size_t frames, const std::string& output) {
  constexpr std::size_t kLong = 1024, kMax = std::size_t{256} << 10, kPair = 8;
  const auto bytes_of = [](const Metadata& metadata) {
    std::uint64_t bytes = 0;
    for (const auto& [name, value] : metadata) bytes += name.size() + value.size() + kPair;
    return bytes;
  };
  auto& textures = described.description.textures;
  std::uint64_t stay = 0, beside = 0;
  for (TextureEntry& texture : textures) {
    described.beside.push_back(take_beside(texture.metadata, kLong));
    stay += bytes_of(texture.metadata);
    beside += bytes_of(described.beside.back());
  }
  for (std::size_t i = 0; stay > kMax && i < textures.size(); ++i) {
    Metadata more = take_beside(textures[i].metadata, 0);
    beside += bytes_of(more);
    std::ranges::move(more, std::back_inserter(described.beside[i]));
  }
  const std::uint64_t limit = DecodeLimits{}.max_metadata_bytes;
  if (beside <= limit) return;
  std::size_t largest = 0;
  for (std::size_t i = 0; i < textures.size(); ++i) {
    if (bytes_of(described.beside[i]) > bytes_of(described.beside[largest])) largest = i;
  }
  fail(Exit::bad_input,
       "{}: attributes of the files take {} bytes, of texture {} alone {}, and a container holds "
       "{}; {}",
       output, beside, textures[largest].name, bytes_of(described.beside[largest]), limit,
       to_cure(frames > 1 ? Cure::fewer_frames : Cure::erase_attribute));
}

/// Throws for a texture that no decoder would take.
void require_size(const StoredTexture& texture, const std::string& path) {
  const std::uint64_t bytes = texture_bytes(texture.info.desc),
                      most = DecodeLimits{}.max_texture_bytes;
  if (bytes <= most) return;
  const Extent size = extent(texture.info.desc);
  fail(Exit::bad_input,
       "{}: {}x{}x{} records of {} take {} bytes, and a texture of a container may have {}; {}",
       path, size.width, size.height, size.slices, record_text(texture.info.desc.record), bytes,
       most, to_cure(Cure::crop));
}

/// Throws for texels in no block, which would be lost.
void require_nothing_outside(const Dump& dump, const std::string& path) {
  const TextureDesc& desc = dump.info.desc;
  const auto record = record_in_no_block(desc, dump.texels);
  if (!record) return;
  const std::uint64_t width = extent(desc).width;
  fail(Exit::bad_input, "{}: texel ({}, {}) is not zero and in no block, and would be lost; {}",
       path, *record % width, *record / width, to_cure(Cure::leave_layout_out));
}

Grid region_of(const std::string& flag) {
  if (flag.empty()) return {};
  const auto region = grid_from_string(flag);
  if (!region) {
    fail(Exit::usage, "--region {}: takes blocks along each axis, such as 8x8x8", flag);
  }
  return *region;
}

}  // namespace gicodec::tools
