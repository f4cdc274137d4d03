// Descriptions of containers.
#include "c/container.h"

#include "bitstream/container_metadata.h"
#include "c/json.h"
#include "c/volume_desc.h"

#include <gicodec/version.h>

#include <limits>
#include <utility>

using namespace gicodec;

namespace gicodec::c {

Status take_geometry(const gicodec_geometry* given, VolumeGeometry& out) noexcept {
  if (given == nullptr) return Status::invalid_argument;
  gicodec_geometry geometry;
  if (const Status status = take(given, geometry); status != Status::ok) return status;
  out.grid = {geometry.grid[0], geometry.grid[1], geometry.grid[2]};
  std::copy(std::begin(geometry.origin), std::end(geometry.origin), out.origin.begin());
  std::copy(std::begin(geometry.spacing), std::end(geometry.spacing), out.spacing.begin());
  std::copy(std::begin(geometry.scroll), std::end(geometry.scroll), out.scroll.begin());
  return validate(out);
}

Status give_geometry(const VolumeGeometry& geometry, gicodec_geometry* out) noexcept {
  gicodec_geometry given{};
  given.grid[0] = geometry.grid.x;
  given.grid[1] = geometry.grid.y;
  given.grid[2] = geometry.grid.z;
  std::copy(geometry.origin.begin(), geometry.origin.end(), given.origin);
  std::copy(geometry.spacing.begin(), geometry.spacing.end(), given.spacing);
  std::copy(geometry.scroll.begin(), geometry.scroll.end(), given.scroll);
  return give(given, out);
}

namespace {

const VolumeEntry* find_volume(const gicodec_container* container, std::uint32_t volume) {
  const bool there = container != nullptr && volume < container->description.volumes.size();
  return there ? &container->description.volumes[volume] : nullptr;
}

const TextureEntry* find_texture(const gicodec_container* container, std::uint32_t texture) {
  const bool there = container != nullptr && texture < container->description.textures.size();
  return there ? &container->description.textures[texture] : nullptr;
}

/// The metadata of what is named; null if there is none.
const Metadata* find_metadata_of(const gicodec_container* container, std::uint32_t of,
                                 std::uint32_t index) {
  if (container == nullptr) return nullptr;
  if (of == GICODEC_METADATA_CONTAINER && index == 0) return &container->description.metadata;
  if (of == GICODEC_METADATA_VOLUME) {
    const VolumeEntry* const volume = find_volume(container, index);
    return volume == nullptr ? nullptr : &volume->metadata;
  }
  const TextureEntry* const texture =
      of == GICODEC_METADATA_TEXTURE ? find_texture(container, index) : nullptr;
  return texture == nullptr ? nullptr : &texture->metadata;
}

const std::pair<std::string, std::string>* find_pair(const gicodec_container* container,
                                                     std::uint32_t of, std::uint32_t index,
                                                     std::uint32_t pair) {
  const Metadata* const metadata = find_metadata_of(container, of, index);
  return metadata != nullptr && pair < metadata->size() ? &(*metadata)[pair] : nullptr;
}

}  // namespace
}  // namespace gicodec::c

extern "C" {

gicodec_status gicodec_container_create(gicodec_container** out) {
  if (out == nullptr) return GICODEC_INVALID_ARGUMENT;
  *out = nullptr;
  return c::call([&] {
    *out = new gicodec_container;
    return Status::ok;
  });
}

void gicodec_container_destroy(gicodec_container* container) { delete container; }

gicodec_status gicodec_container_add_volume(gicodec_container* container, const char* name,
                                            const gicodec_volume_desc* volume) {
  if (container == nullptr || volume == nullptr) return GICODEC_INVALID_ARGUMENT;
  return c::call([&]() -> Status {
    const std::string_view given = c::text(name);
    if (given.size() > kMaxName || !is_utf8(given)) return Status::invalid_name;
    const auto completed = c::complete(volume->desc);
    if (!completed) return completed.status();
    return add_volume(container->description, std::string(given), *completed);
  });
}

gicodec_status gicodec_container_set_geometry(gicodec_container* container, uint32_t volume,
                                              const gicodec_geometry* geometry) {
  if (container == nullptr) return GICODEC_INVALID_ARGUMENT;
  if (c::find_volume(container, volume) == nullptr) return GICODEC_UNKNOWN_VOLUME;
  VolumeGeometry taken;
  const Status status = c::take_geometry(geometry, taken);
  if (status != Status::ok) return c::number(status);
  VolumeEntry& entry = container->description.volumes[volume];
  const auto& groups = entry.desc.groups;  // none if the kind is unknown
  if (!groups.empty() && !(groups.front().textures.front().desc.grid == taken.grid)) {
    return GICODEC_INVALID_GEOMETRY;
  }
  entry.geometry = taken;
  return GICODEC_OK;
}

gicodec_status gicodec_container_set_largest_error(gicodec_container* container, uint32_t texture,
                                                   float error) {
  if (container == nullptr) return GICODEC_INVALID_ARGUMENT;
  if (c::find_texture(container, texture) == nullptr) return GICODEC_UNKNOWN_TEXTURE;
  if (!(error >= 0)) return GICODEC_INVALID_BOUND;
  container->description.textures[texture].largest_error = error;
  return GICODEC_OK;
}

gicodec_status gicodec_container_add_metadata(gicodec_container* container, uint32_t of,
                                              uint32_t index, const char* name, const char* value) {
  if (container == nullptr || name == nullptr || value == nullptr) {
    return GICODEC_INVALID_ARGUMENT;
  }
  if (!is_utf8(name) || !is_utf8(value)) return GICODEC_INVALID_NAME;
  if (std::strlen(name) > kMaxMetadataText || std::strlen(value) > kMaxMetadataText) {
    return GICODEC_LIMIT_EXCEEDED;
  }
  auto* const metadata = const_cast<Metadata*>(c::find_metadata_of(container, of, index));
  if (metadata == nullptr) return GICODEC_INVALID_ARGUMENT;
  return c::call([&] {
    metadata->emplace_back(name, value);
    return Status::ok;
  });
}

uint32_t gicodec_container_metadata_count(const gicodec_container* container, uint32_t of,
                                          uint32_t index) {
  const Metadata* const metadata = c::find_metadata_of(container, of, index);
  return metadata == nullptr ? 0 : static_cast<uint32_t>(metadata->size());
}

const char* gicodec_container_metadata_name(const gicodec_container* container, uint32_t of,
                                            uint32_t index, uint32_t pair) {
  const auto* const found = c::find_pair(container, of, index, pair);
  return found == nullptr ? nullptr : found->first.c_str();
}

const char* gicodec_container_metadata_value(const gicodec_container* container, uint32_t of,
                                             uint32_t index, uint32_t pair, size_t* size) {
  const auto* const found = c::find_pair(container, of, index, pair);
  if (size != nullptr) *size = found == nullptr ? 0 : found->second.size();
  return found == nullptr ? nullptr : found->second.c_str();
}

gicodec_status gicodec_container_set_scene(gicodec_container* container, const char* name,
                                           uint64_t geometry) {
  if (container == nullptr) return GICODEC_INVALID_ARGUMENT;
  const std::string_view given = c::text(name);
  if (given.size() > kMaxName || !is_utf8(given)) return GICODEC_INVALID_NAME;
  return c::call([&] {
    container->description.scene = {std::string(given), geometry};
    return Status::ok;
  });
}

const char* gicodec_container_scene(const gicodec_container* container, uint64_t* geometry) {
  if (geometry != nullptr) {
    *geometry = container == nullptr ? 0 : container->description.scene.geometry;
  }
  return container == nullptr ? "" : container->description.scene.name.c_str();
}

gicodec_status gicodec_container_version(const void* head, size_t size, uint32_t* major,
                                         uint32_t* minor, uint32_t* readable) {
  if (c::is_missing(head, size) || major == nullptr || minor == nullptr || readable == nullptr) {
    return GICODEC_INVALID_ARGUMENT;
  }
  const auto version = container_version(c::bytes(head, size));
  if (!version) return c::number(version.status());
  *major = version->major;
  *minor = version->minor;
  *readable = kContainerMajor;
  return GICODEC_OK;
}

uint32_t gicodec_container_volumes(const gicodec_container* container) {
  return container == nullptr ? 0 : static_cast<uint32_t>(container->description.volumes.size());
}

uint32_t gicodec_container_textures(const gicodec_container* container) {
  return container == nullptr ? 0 : static_cast<uint32_t>(container->description.textures.size());
}

const char* gicodec_container_volume_name(const gicodec_container* container, uint32_t volume) {
  const VolumeEntry* const found = c::find_volume(container, volume);
  return found == nullptr ? nullptr : found->name.c_str();
}

gicodec_status gicodec_container_volume(const gicodec_container* container, uint32_t volume,
                                        gicodec_volume_desc** out) {
  if (container == nullptr || out == nullptr) return GICODEC_INVALID_ARGUMENT;
  *out = nullptr;
  const VolumeEntry* const found = c::find_volume(container, volume);
  if (found == nullptr) return GICODEC_UNKNOWN_VOLUME;
  if (found->desc.groups.empty()) return GICODEC_UNKNOWN_KIND;
  return c::call([&] { return c::give_volume(found->desc, out); });
}

gicodec_status gicodec_container_geometry(const gicodec_container* container, uint32_t volume,
                                          gicodec_geometry* out) {
  if (container == nullptr) return GICODEC_INVALID_ARGUMENT;
  const VolumeEntry* const found = c::find_volume(container, volume);
  if (found == nullptr) return GICODEC_UNKNOWN_VOLUME;
  return found->geometry ? c::number(c::give_geometry(*found->geometry, out)) : GICODEC_END;
}

const char* gicodec_container_texture_name(const gicodec_container* container, uint32_t texture) {
  const TextureEntry* const found = c::find_texture(container, texture);
  return found == nullptr ? nullptr : found->name.c_str();
}

gicodec_status gicodec_container_texture(const gicodec_container* container, uint32_t texture,
                                         gicodec_texture_desc* out, uint32_t* volume) {
  if (container == nullptr) return GICODEC_INVALID_ARGUMENT;
  const TextureEntry* const found = c::find_texture(container, texture);
  if (found == nullptr) return GICODEC_UNKNOWN_TEXTURE;
  if (volume != nullptr) *volume = found->volume;
  if (!is_known(*found)) return GICODEC_UNKNOWN_KIND;
  return c::number(c::give(c::desc_for_c(found->desc), out));
}

float gicodec_container_largest_error(const gicodec_container* container, uint32_t texture) {
  const TextureEntry* const found = c::find_texture(container, texture);
  return found == nullptr ? std::numeric_limits<float>::infinity() : found->largest_error;
}

gicodec_status gicodec_container_json(const gicodec_container* container, char* out,
                                      size_t capacity, size_t* size) {
  if (container == nullptr) return GICODEC_INVALID_ARGUMENT;
  return c::call([&] {
    c::Json json;
    c::describe(container->description, json);
    return c::copy_text(json.text(), out, capacity, size);
  });
}

}  // extern "C"
