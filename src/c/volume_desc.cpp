// Descriptions of volumes.
#include "c/volume_desc.h"

#include "c/calls.h"
#include "c/json.h"

#include <gicodec/ao_points.h>
#include <gicodec/container.h>
#include <gicodec/engines.h>
#include <gicodec/irradiance_vectors.h>
#include <gicodec/photons.h>
#include <gicodec/probes.h>
#include <gicodec/textures.h>
#include <gicodec/voxels.h>

#include <utility>

using namespace gicodec;

const NamedTexture* gicodec_volume_desc::texture(std::uint32_t number) const noexcept {
  for (const TextureGroup& group : desc.groups) {
    if (number < group.textures.size()) return &group.textures[number];
    number -= static_cast<std::uint32_t>(group.textures.size());
  }
  return nullptr;
}

namespace gicodec::c {

Result<VolumeDesc> complete(const VolumeDesc& volume) {
  const Kind* const kind = find_kind(volume.kind);
  if (kind == nullptr) return Status::unknown_kind;
  std::vector<std::byte> bytes;
  Status status = validate(volume);
  if (status == Status::ok) status = kind->write(volume, bytes);
  if (status != Status::ok) return status;
  auto whole = kind->read(bytes);
  if (!whole)
    return whole.status() == Status::corrupt ? Status::invalid_description : whole.status();
  const auto own = textures_of(volume);
  if (own.size() != textures_of(*whole).size()) return Status::invalid_description;
  std::size_t place = 0;
  for (TextureGroup& group : whole->groups) {
    for (NamedTexture& texture : group.textures) {
      texture.desc.layout = own[place++]->desc.layout;
    }
  }
  return whole;
}

Status give_volume(VolumeDesc desc, gicodec_volume_desc** out) {
  *out = std::make_unique<gicodec_volume_desc>(gicodec_volume_desc{std::move(desc)}).release();
  return Status::ok;
}

namespace {

/// Stores what make() returns as a new handle.
template <typename Make>
[[nodiscard]] gicodec_status make_volume(gicodec_volume_desc** out, Make&& make) noexcept {
  if (out == nullptr) return GICODEC_INVALID_ARGUMENT;
  *out = nullptr;
  return call([&]() -> Status {
    Result<VolumeDesc> desc = make();
    return desc ? give_volume(*std::move(desc), out) : desc.status();
  });
}

}  // namespace
}  // namespace gicodec::c

extern "C" {

gicodec_status gicodec_volume_desc_create(uint32_t kind, gicodec_volume_desc** out) {
  return c::make_volume(out, [&]() -> Result<VolumeDesc> {
    if (kind > UINT8_MAX || find_kind(static_cast<uint8_t>(kind)) == nullptr) {
      return Status::unknown_kind;
    }
    VolumeDesc desc;
    desc.kind = static_cast<uint8_t>(kind);
    return desc;
  });
}

gicodec_status gicodec_volume_desc_add_group(gicodec_volume_desc* volume, uint32_t bundled) {
  if (volume == nullptr) return GICODEC_INVALID_ARGUMENT;
  if (volume->desc.groups.size() >= kMaxGroups) return GICODEC_LIMIT_EXCEEDED;
  return c::call([&] {
    volume->desc.groups.emplace_back().bundled = bundled != 0;
    return Status::ok;
  });
}

gicodec_status gicodec_volume_desc_add_texture(gicodec_volume_desc* volume, const char* name,
                                               const gicodec_texture_desc* desc) {
  if (volume == nullptr || name == nullptr) return GICODEC_INVALID_ARGUMENT;
  return c::call([&]() -> Status {
    NamedTexture texture;
    if (const Status status = c::take_desc(desc, texture.desc); status != Status::ok) return status;
    texture.name = name;
    if (texture.name.empty() || texture.name.size() > kMaxName || !is_utf8(texture.name)) {
      return Status::invalid_name;
    }
    if (gicodec_volume_desc_textures(volume) >= kMaxVolumeTextures) return Status::limit_exceeded;
    if (volume->desc.groups.empty()) {
      std::vector<TextureGroup> groups(1);
      groups.front().textures.push_back(std::move(texture));
      volume->desc.groups = std::move(groups);
    } else {
      volume->desc.groups.back().textures.push_back(std::move(texture));
    }
    return Status::ok;
  });
}

gicodec_status gicodec_volume_desc_from_layout(const char* layout, uint32_t x, uint32_t y,
                                               uint32_t z, gicodec_volume_desc** out) {
  return c::make_volume(out, [&]() -> Result<VolumeDesc> {
    const EngineLayout* const found = find_engine_layout(c::text(layout));
    return found == nullptr ? Result<VolumeDesc>(Status::invalid_name) : found->make({x, y, z});
  });
}

gicodec_status gicodec_photon_volume(uint32_t batches, uint32_t capacity, uint32_t form,
                                     gicodec_volume_desc** out) {
  return c::make_volume(out, [&]() -> Result<VolumeDesc> {
    if (form > 1) return Status::invalid_description;
    return photon_volume(batches, capacity, static_cast<PhotonForm>(form));
  });
}

gicodec_status gicodec_voxel_volume(uint32_t bricks, uint32_t side, uint32_t form,
                                    gicodec_volume_desc** out) {
  return c::make_volume(out, [&]() -> Result<VolumeDesc> {
    if (form > 1 || side > UINT8_MAX) return Status::invalid_description;
    return voxel_volume(bricks, static_cast<uint8_t>(side), static_cast<VoxelForm>(form));
  });
}

gicodec_status gicodec_ao_point_volume(uint32_t cells, uint32_t buckets, uint32_t instances,
                                       gicodec_volume_desc** out) {
  return c::make_volume(out, [&] { return ao_point_volume(cells, buckets, instances); });
}

gicodec_status gicodec_irradiance_vector_volume(uint32_t nx, uint32_t ny, uint32_t nz,
                                                uint32_t floats, gicodec_volume_desc** out) {
  return c::make_volume(out, [&] { return irradiance_vector_volume({nx, ny, nz}, floats != 0); });
}

uint32_t gicodec_layout_count(void) { return static_cast<uint32_t>(engine_layouts().size()); }
const char* gicodec_layout_name(uint32_t layout) {
  const auto layouts = engine_layouts();
  return layout < layouts.size() ? layouts[layout].name.data() : nullptr;
}
const char* gicodec_layout_summary(uint32_t layout) {
  const auto layouts = engine_layouts();
  return layout < layouts.size() ? layouts[layout].summary.data() : nullptr;
}

gicodec_status gicodec_volume_desc_read(uint32_t kind, const void* bytes, size_t size,
                                        gicodec_volume_desc** out) {
  return c::make_volume(out, [&]() -> Result<VolumeDesc> {
    if (c::is_missing(bytes, size)) return Status::invalid_argument;
    const Kind* const found = kind > UINT8_MAX ? nullptr : find_kind(static_cast<uint8_t>(kind));
    if (found == nullptr) return Status::unknown_kind;
    if (size > kMaxKindDescription) return Status::limit_exceeded;
    return found->read(c::bytes(bytes, size));
  });
}

gicodec_status gicodec_volume_desc_write(const gicodec_volume_desc* volume, void* out,
                                         size_t capacity, size_t* size) {
  if (volume == nullptr) return GICODEC_INVALID_ARGUMENT;
  return c::call([&]() -> Status {
    const Kind* const kind = find_kind(volume->desc.kind);
    if (kind == nullptr) return Status::unknown_kind;
    std::vector<std::byte> bytes;
    Status status = validate(volume->desc);
    if (status == Status::ok) status = kind->write(volume->desc, bytes);
    return status == Status::ok ? c::copy_out(bytes, out, capacity, size) : status;
  });
}

gicodec_status gicodec_volume_desc_copy(const gicodec_volume_desc* volume,
                                        gicodec_volume_desc** out) {
  return c::make_volume(out, [&]() -> Result<VolumeDesc> {
    if (volume == nullptr) return Status::invalid_argument;
    return VolumeDesc(volume->desc);
  });
}

void gicodec_volume_desc_destroy(gicodec_volume_desc* volume) { delete volume; }

gicodec_status gicodec_volume_desc_check(const gicodec_volume_desc* volume) {
  if (volume == nullptr) return GICODEC_INVALID_ARGUMENT;
  return c::call([&] { return c::complete(volume->desc).status(); });
}

const char* gicodec_volume_desc_problem(const gicodec_volume_desc* volume) {
  if (volume == nullptr) return to_string(Status::invalid_argument).data();
  const std::string_view found = problem(volume->desc);
  if (!found.empty()) return found.data();
  const gicodec_status status = gicodec_volume_desc_check(volume);
  if (status == GICODEC_OK) return nullptr;
  if (status != GICODEC_INVALID_DESCRIPTION) return gicodec_status_text(status);
  switch (volume->desc.kind) {
    case kKindProbes:
      return "kind: probes are one group of square blocks of depth 1, not cut, model stacked";
    case kKindTextures:
      return "kind: textures do not depend on one another, and have no presence";
    default:
      return "kind: its volumes have other textures; make them by the kind's own function";
  }
}

uint32_t gicodec_volume_desc_kind(const gicodec_volume_desc* volume) {
  return volume == nullptr ? 0 : volume->desc.kind;
}

const char* gicodec_kind_name(uint32_t kind) {
  const Kind* const found = kind > UINT8_MAX ? nullptr : find_kind(static_cast<uint8_t>(kind));
  return found == nullptr ? nullptr : found->name.data();
}

uint32_t gicodec_volume_desc_groups(const gicodec_volume_desc* volume) {
  return volume == nullptr ? 0 : static_cast<uint32_t>(volume->desc.groups.size());
}

uint32_t gicodec_volume_desc_textures(const gicodec_volume_desc* volume) {
  size_t textures = 0;
  if (volume == nullptr) return 0;
  for (const TextureGroup& group : volume->desc.groups) textures += group.textures.size();
  return static_cast<uint32_t>(textures);
}

uint32_t gicodec_volume_desc_group_of(const gicodec_volume_desc* volume, uint32_t texture) {
  if (volume == nullptr) return GICODEC_NO_GROUP;
  uint32_t place = 0;
  for (const TextureGroup& group : volume->desc.groups) {
    if (texture < group.textures.size()) return place;
    texture -= static_cast<uint32_t>(group.textures.size());
    ++place;
  }
  return GICODEC_NO_GROUP;
}

const char* gicodec_volume_desc_texture_name(const gicodec_volume_desc* volume, uint32_t texture) {
  const NamedTexture* const found = volume == nullptr ? nullptr : volume->texture(texture);
  return found == nullptr ? nullptr : found->name.c_str();
}

gicodec_status gicodec_volume_desc_texture(const gicodec_volume_desc* volume, uint32_t texture,
                                           gicodec_texture_desc* out) {
  if (volume == nullptr) return GICODEC_INVALID_ARGUMENT;
  const NamedTexture* const found = volume->texture(texture);
  if (found == nullptr) return GICODEC_UNKNOWN_TEXTURE;
  return c::number(c::give(c::desc_for_c(found->desc), out));
}

gicodec_status gicodec_volume_desc_json(const gicodec_volume_desc* volume, char* out,
                                        size_t capacity, size_t* size) {
  if (volume == nullptr) return GICODEC_INVALID_ARGUMENT;
  return c::call([&] {
    c::Json json;
    c::describe(volume->desc, json);
    return c::copy_text(json.text(), out, capacity, size);
  });
}

}  // extern "C"
