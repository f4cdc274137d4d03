// Descriptions of textures.
#include "c/calls.h"
#include "c/volume_desc.h"

#include <gicodec/probes.h>
#include <gicodec/textures.h>

#include <algorithm>

namespace gicodec::c {
namespace {

/// A number of a field of one byte. Numbers beyond 255 become 255, which no field allows.
template <typename Field>
[[nodiscard]] constexpr Field saturated(std::uint32_t number) noexcept {
  static_assert(sizeof(Field) == 1);
  return static_cast<Field>(std::min<std::uint32_t>(number, UINT8_MAX));
}

/// The record of a format, or that of the components.
[[nodiscard]] Status take_record(const gicodec_texture_desc& desc, Record& out) noexcept {
  if (desc.format != 0) {
    out = Record(static_cast<Format>(desc.format));
    const bool same = (desc.record_bytes == 0 || desc.record_bytes == out.bytes) &&
                      (desc.component_count == 0 || desc.component_count == out.count);
    return out.bytes != 0 && same ? Status::ok : Status::unsupported_format;
  }
  out = {};
  if (desc.component_count > kMaxComponents) return Status::unsupported_format;
  out.bytes = saturated<std::uint8_t>(desc.record_bytes);
  out.count = saturated<std::uint8_t>(desc.component_count);
  for (std::size_t i = 0; i < out.count; ++i) {
    const gicodec_component& component = desc.components[i];
    std::copy(std::begin(component.name), std::end(component.name),
              out.components[i].characters.begin());
    out.components[i].offset = component.offset;
    out.components[i].bits = component.bits;
    out.components[i].type = static_cast<ComponentType>(component.type);
  }
  return is_valid(out) ? Status::ok : Status::unsupported_format;
}

void give_grid(const Grid& grid, std::uint32_t (&out)[3]) noexcept {
  out[0] = grid.x;
  out[1] = grid.y;
  out[2] = grid.z;
}
[[nodiscard]] Grid grid_of(const std::uint32_t (&given)[3]) noexcept {
  return {given[0], given[1], given[2]};
}

/// A description as the caller's struct, also one that is not valid, and whether it is.
[[nodiscard]] gicodec_status give_texture(const TextureDesc& desc, gicodec_texture_desc* out) {
  const Status given = give(desc_for_c(desc), out);
  return number(given == Status::ok ? validate(desc) : given);
}

/// A caller's description that is valid.
[[nodiscard]] Status take_valid(const gicodec_texture_desc* given, TextureDesc& out) noexcept {
  const Status status = take_desc(given, out);
  return status == Status::ok ? validate(out) : status;
}

}  // namespace

Status take_desc(const gicodec_texture_desc* given, TextureDesc& out) noexcept {
  if (given == nullptr) return Status::invalid_argument;
  gicodec_texture_desc desc;
  if (const Status status = take(given, desc); status != Status::ok) return status;
  out = {};
  if (const Status status = take_record(desc, out.record); status != Status::ok) return status;
  out.grid = grid_of(desc.grid);
  out.records = grid_of(desc.records);
  out.layout.slots = grid_of(desc.slots);
  out.block = {saturated<std::uint8_t>(desc.block[0]), saturated<std::uint8_t>(desc.block[1]),
               saturated<std::uint8_t>(desc.block[2])};
  out.guard_band = saturated<std::uint8_t>(desc.guard_band);
  out.space = saturated<Space>(desc.space);
  out.presence = saturated<Presence>(desc.presence);
  out.model = saturated<Model>(desc.model);
  out.layout.tiling = saturated<Tiling>(desc.tiling);
  out.layout.pad_before = saturated<std::uint8_t>(desc.pad_before);
  out.layout.pad_after = saturated<std::uint8_t>(desc.pad_after);
  return Status::ok;
}

gicodec_texture_desc desc_for_c(const TextureDesc& desc) noexcept {
  gicodec_texture_desc out{};
  out.struct_size = sizeof out;
  out.format = static_cast<std::uint32_t>(desc.record.format);
  give_grid(desc.grid, out.grid);
  give_grid({desc.block.x, desc.block.y, desc.block.z}, out.block);
  out.guard_band = desc.guard_band;
  out.space = static_cast<std::uint32_t>(desc.space);
  out.presence = static_cast<std::uint32_t>(desc.presence);
  out.model = static_cast<std::uint32_t>(desc.model);
  give_grid(desc.records, out.records);
  out.tiling = static_cast<std::uint32_t>(desc.layout.tiling);
  out.pad_before = desc.layout.pad_before;
  out.pad_after = desc.layout.pad_after;
  give_grid(desc.layout.slots, out.slots);
  out.record_bytes = desc.record.bytes;
  out.component_count = desc.record.count;
  for (std::size_t i = 0; i < desc.record.count; ++i) {
    const Component& component = desc.record.components[i];
    gicodec_component& to = out.components[i];
    std::copy(component.characters.begin(), component.characters.end(), to.name);
    to.offset = component.offset;
    to.bits = component.bits;
    to.type = static_cast<std::uint8_t>(component.type);
  }
  return out;
}

}  // namespace gicodec::c

using namespace gicodec;

extern "C" {

gicodec_status gicodec_ddgi_irradiance(uint32_t nx, uint32_t ny, uint32_t nz, uint32_t format,
                                       gicodec_texture_desc* out) {
  return c::give_texture(ddgi_irradiance({nx, ny, nz}, static_cast<Format>(format)), out);
}

gicodec_status gicodec_ddgi_visibility(uint32_t nx, uint32_t ny, uint32_t nz, uint32_t format,
                                       gicodec_texture_desc* out) {
  return c::give_texture(ddgi_visibility({nx, ny, nz}, static_cast<Format>(format)), out);
}

gicodec_status gicodec_map_texture(uint32_t width, uint32_t height, uint32_t depth,
                                   uint32_t block_x, uint32_t block_y, uint32_t block_z,
                                   uint32_t format, gicodec_texture_desc* out) {
  const auto side = [](uint32_t given) { return c::saturated<uint8_t>(given); };
  const BlockShape block{side(block_x), side(block_y), side(block_z)};
  const Record record{static_cast<Format>(format)};
  const auto fits = [](uint8_t given) { return given >= 1 && given <= kMaxBlockSide; };
  if (!fits(block.x) || !fits(block.y) || !fits(block.z)) {
    TextureDesc none;
    none.record = record;
    none.block = block;
    return c::give_texture(none, out);
  }
  return c::give_texture(map_texture(record, {width, height, depth}, block), out);
}

uint32_t gicodec_format_from_name(const char* name) {
  const FormatInfo* const info = name == nullptr ? nullptr : find_format(std::string_view(name));
  return info == nullptr ? 0 : static_cast<uint32_t>(info->record.format);
}

const char* gicodec_format_name(uint32_t format) {
  const FormatInfo* const info = find_format(static_cast<Format>(format));
  return info == nullptr ? nullptr : info->name.data();
}

uint32_t gicodec_format_count(void) { return static_cast<uint32_t>(formats().size()); }

uint32_t gicodec_format_at(uint32_t place) {
  return place < formats().size() ? static_cast<uint32_t>(formats()[place].record.format) : 0;
}

gicodec_status gicodec_texture_desc_check(const gicodec_texture_desc* desc) {
  TextureDesc texture;
  return c::number(c::take_valid(desc, texture));
}

const char* gicodec_texture_desc_problem(const gicodec_texture_desc* desc) {
  TextureDesc texture;
  const Status status = c::take_desc(desc, texture);
  if (status == Status::unsupported_format) return problem(TextureDesc{}).data();
  if (desc != nullptr && status == Status::invalid_argument) {
    return "struct_size: it is not the size of the struct";
  }
  if (status != Status::ok) return to_string(status).data();
  const std::string_view found = problem(texture);
  return found.empty() ? nullptr : found.data();
}

gicodec_status gicodec_texture_desc_info(const gicodec_texture_desc* desc,
                                         gicodec_texture_info* out) {
  TextureDesc texture;
  if (const Status status = c::take_valid(desc, texture); status != Status::ok) {
    return c::number(status);
  }
  const Extent size = extent(texture);
  gicodec_texture_info info{};
  info.blocks = block_count(texture);
  info.texture_bytes = texture_bytes(texture);
  info.width = size.width;
  info.height = size.height;
  info.slices = size.slices;
  info.block_bytes = static_cast<uint32_t>(block_bytes(texture));
  info.presence_bytes = static_cast<uint32_t>(presence_bytes(texture));
  return c::number(c::give(info, out));
}

gicodec_status gicodec_texture_desc_complete(gicodec_texture_desc* desc) {
  TextureDesc texture;
  const Status status = c::take_valid(desc, texture);
  return status == Status::ok ? c::number(c::give(c::desc_for_c(texture), desc))
                              : c::number(status);
}

gicodec_status gicodec_texture_desc_origin(const gicodec_texture_desc* desc, uint32_t block,
                                           uint64_t out[4]) {
  TextureDesc texture;
  if (const Status status = c::take_valid(desc, texture); status != Status::ok) {
    return c::number(status);
  }
  if (out == nullptr) return GICODEC_INVALID_ARGUMENT;
  if (block >= block_count(texture)) return GICODEC_BLOCK_OUT_OF_RANGE;
  const BlockOrigin origin = block_origin(texture, block);
  out[0] = origin.x;
  out[1] = origin.y;
  out[2] = origin.slice;
  out[3] = origin.block;
  return GICODEC_OK;
}

}  // extern "C"
