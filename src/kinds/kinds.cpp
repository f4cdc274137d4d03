// The table of kinds, and the validation of volumes.
#include <gicodec/ao_points.h>
#include <gicodec/irradiance_maps.h>
#include <gicodec/irradiance_vectors.h>
#include <gicodec/kind.h>
#include <gicodec/photons.h>
#include <gicodec/probes.h>
#include <gicodec/textures.h>
#include <gicodec/voxels.h>

#include "base/text.h"

#include <algorithm>
#include <array>
#include <vector>

namespace gicodec {
namespace {

constexpr std::array<const Kind*, 7> kKinds{
    &kProbes, &kIrradianceVectors, &kTextures, &kIrradianceMaps, &kPhotons, &kAoPoints, &kVoxels};

template <typename Wanted>
const Kind* find(std::span<const Kind* const> others, const Wanted& wanted) {
  for (const auto list : {std::span<const Kind* const>(kKinds), others}) {
    for (const Kind* kind : list) {
      const bool whole = kind != nullptr && kind->write != nullptr && kind->read != nullptr;
      if (whole && wanted(*kind)) return kind;
    }
  }
  return nullptr;
}

bool same_blocks(const TextureDesc& a, const TextureDesc& b) {
  return a.space == b.space && a.grid == b.grid;
}

bool same_texture(const NamedTexture& a, const NamedTexture& b) noexcept {
  TextureDesc desc = b.desc;
  desc.layout = a.desc.layout;
  return a.name == b.name && a.desc == desc && a.threshold == b.threshold && a.preview == b.preview;
}

bool same_set(const TextureGroup& a, const TextureGroup& b) noexcept {
  return a.bundled == b.bundled && a.presence == b.presence && a.depends_on == b.depends_on &&
         a.dependencies == b.dependencies && a.rank == b.rank &&
         std::equal(a.textures.begin(), a.textures.end(), b.textures.begin(), b.textures.end(),
                    same_texture);
}

std::string_view problem_of_group(const VolumeDesc& volume, std::size_t place) {
  const TextureGroup& group = volume.groups[place];
  if (group.textures.empty()) return "groups: one has no textures";
  for (const NamedTexture& texture : group.textures) {
    if (const auto found = problem(texture.desc); !found.empty()) return found;
    if (!same_blocks(texture.desc, group.textures.front().desc)) {
      return "grid: the textures of a group have one space and one grid";
    }
  }
  const bool depends = group.depends_on != TextureGroup::kNone;
  if (depends != (group.dependencies != nullptr)) {
    return "depends_on: it and dependencies need each other";
  }
  if (depends && group.depends_on >= place) return "depends_on: it is an earlier group";
  const TextureDesc* presence = nullptr;
  if (group.presence != TextureGroup::kNone) {
    if (group.presence != 0 || !group.bundled) {
      return "presence: a group's is 0, its first texture, and the group is bundled";
    }
    presence = &group.textures[group.presence].desc;
  }
  for (const NamedTexture& texture : group.textures) {
    if (texture.desc.presence == Presence::all) continue;
    if (presence == nullptr || presence->presence != Presence::all ||
        presence_bytes(texture.desc) != block_bytes(*presence)) {
      return "presence: blocks of the group's first texture hold it, no more and no less";
    }
  }
  return {};
}

std::string_view problem_of_names(const VolumeDesc& volume) {
  std::size_t seen = 0;
  const auto known = [&](const std::string& name) {
    std::size_t before = seen;
    for (const TextureGroup& group : volume.groups) {
      for (const NamedTexture& texture : group.textures) {
        if (before-- == 0) return false;
        if (texture.name == name) return true;
      }
    }
    return false;
  };
  for (const TextureGroup& group : volume.groups) {
    for (const NamedTexture& texture : group.textures) {
      if (texture.name.empty() || texture.name.size() > kMaxName || !is_utf8(texture.name)) {
        return "name: each texture's is UTF-8 of 1 to 255 bytes";
      }
      if (known(texture.name)) return "name: two textures have the same";
      ++seen;
    }
  }
  return {};
}

}  // namespace

std::span<const Kind* const> built_in_kinds() noexcept { return kKinds; }

const Kind* find_kind(std::uint8_t id, std::span<const Kind* const> others) noexcept {
  return find(others, [id](const Kind& kind) { return kind.id == id; });
}

const Kind* find_kind(std::string_view name, std::span<const Kind* const> others) noexcept {
  return find(others, [name](const Kind& kind) { return kind.name == name; });
}

std::vector<const NamedTexture*> textures_of(const VolumeDesc& volume) {
  std::vector<const NamedTexture*> textures;
  for (const TextureGroup& group : volume.groups) {
    for (const NamedTexture& texture : group.textures) textures.push_back(&texture);
  }
  return textures;
}

bool same_but_layout(const VolumeDesc& a, const VolumeDesc& b) noexcept {
  return a.kind == b.kind &&
         std::equal(a.groups.begin(), a.groups.end(), b.groups.begin(), b.groups.end(), same_set);
}

std::string_view problem(const VolumeDesc& volume) noexcept {
  if (volume.kind == 0) return "kind: it is 1 to 255";
  if (volume.groups.empty() || volume.groups.size() > kMaxGroups) return "groups: 1 to 16";
  std::size_t textures = 0;
  for (std::size_t place = 0; place < volume.groups.size(); ++place) {
    if (const auto found = problem_of_group(volume, place); !found.empty()) return found;
    textures += volume.groups[place].textures.size();
  }
  if (textures > kMaxVolumeTextures) return "textures: 1 to 255";
  return problem_of_names(volume);
}

Status validate(const VolumeDesc& volume) noexcept {
  if (problem(volume).empty()) return Status::ok;
  for (const TextureGroup& group : volume.groups) {
    for (const NamedTexture& texture : group.textures) {
      const Status status = validate(texture.desc);
      if (status == Status::unsupported_format || status == Status::limit_exceeded) return status;
    }
  }
  return Status::invalid_description;
}

}  // namespace gicodec
