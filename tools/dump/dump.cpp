#include "dump/dump.h"

#include "dump/error.h"
#include "dump/internal.h"
#include "dump/text.h"

#include <algorithm>
#include <charconv>
#include <filesystem>

namespace gicodec::tools {
namespace {

Dump read(const std::string& path, const Hints& hints, bool texels) {
  const ImageKind kind = require_image_kind(path);
  return kind == ImageKind::exr ? read_exr(path, hints, texels)
                                : read_image(path, kind, hints, texels);
}

}  // namespace

std::optional<ImageKind> image_kind(const std::string& path) {
  const std::string ending = lower_case(std::filesystem::path(path).extension().string());
  if (ending.empty() || ending == ".exr") return ImageKind::exr;
  if (ending == ".png") return ImageKind::png;
  if (ending == ".tif" || ending == ".tiff") return ImageKind::tiff;
  if (ending == ".dpx") return ImageKind::dpx;
  return std::nullopt;
}

ImageKind require_image_kind(const std::string& path) {
  if (const auto kind = image_kind(path)) return *kind;
  fail(Exit::bad_input,
       "{}: is named like no image that is read: .exr, .png, .tif, .tiff, .dpx; name the dumps, or "
       "the folder of EXR dumps",
       path);
}

DumpInfo read_dump_info(const std::string& path, const Hints& hints) {
  return read(path, hints, false).info;
}

Dump read_dump(const std::string& path, const Hints& hints) { return read(path, hints, true); }

ChannelLayout default_channels(Format format) {
  const FormatInfo& info = *find_format(format);
  ChannelLayout channels;
  for (std::size_t i = 0; i < info.record.count; ++i) {
    for (const SampleType type : {SampleType::uint32, SampleType::float32, SampleType::half}) {
      if (can_hold(type, info.record.components[i], info.record)) channels.types[i] = type;
    }
  }
  return channels;
}

std::string channel_name(const ChannelLayout& channels, Format format, std::size_t component) {
  if (!channels.names[component].empty()) return channels.names[component];
  return std::string{letter(find_format(format)->record.components[component])};
}

std::string to_string(const ChannelLayout& channels, Format format) {
  std::string text;
  const FormatInfo& info = *find_format(format);
  for (std::size_t i = 0; i < info.record.count; ++i) {
    const char name = letter(info.record.components[i]);
    if (name == 'A' && !channels.alpha) continue;
    text += fmt::format("{}{}:{}", text.empty() ? "" : " ", name, to_string(channels.types[i]));
  }
  return text;
}

std::optional<ChannelLayout> channels_from_string(std::string_view text, Format format) {
  const FormatInfo& info = *find_format(format);
  ChannelLayout channels;
  if (text.ends_with(' ')) return std::nullopt;
  for (std::size_t i = 0; i < info.record.count; ++i) {
    const Component& component = info.record.components[i];
    const std::string_view item = text.substr(0, text.find(' '));
    if (item.size() < 3 || item[0] != letter(component) || item[1] != ':') {
      if (letter(component) != 'A') return std::nullopt;
      channels.alpha = false;
      continue;
    }
    const auto type = sample_type_from_string(item.substr(2));
    if (!type || !can_hold(*type, component, info.record)) return std::nullopt;
    channels.types[i] = *type;
    text.remove_prefix(std::min(text.size(), item.size() + 1));
  }
  if (!text.empty()) return std::nullopt;
  return channels;
}

Hints hints_of(const TextureDesc& desc) {
  return {desc.record.format, desc.grid, desc.block.x, desc.guard_band, desc.layout.tiling, {}};
}

Hints hints_of(const DumpInfo& info) {
  Hints hints = hints_of(info.desc);
  const auto& names = info.channels.names;
  if (std::all_of(names.begin(), names.end(), [](const auto& name) { return name.empty(); })) {
    return hints;
  }
  const Record& record = info.desc.record;
  for (std::size_t i = 0; i < record.count; ++i) {
    const char name = letter(record.components[i]);
    if (name == 'A' && !info.channels.alpha) continue;
    hints.channels[name] = channel_name(info.channels, info.desc.record.format, i);
  }
  return hints;
}

DumpInfo make_info(const TextureDesc& desc) {
  DumpInfo info{desc, default_channels(desc.record.format), {}, {}, {}};
  describe(info.attributes, desc);
  return info;
}

Extent image_extent(const TextureDesc& desc) noexcept {
  const Extent size = extent(desc);
  return {size.width, size.height * size.slices, 1};
}

Grid block_position(const TextureDesc& desc, std::uint32_t probe) noexcept {
  const Grid& grid = desc.grid;
  return {probe % grid.x, probe / grid.x % grid.y, probe / grid.x / grid.y};
}

TexelPlace locate(const TextureDesc& desc, std::uint32_t x, std::uint32_t y) {
  const std::uint64_t slice_height = extent(desc).height;
  const std::uint32_t side = desc.block.x + 2U * desc.guard_band;
  TexelPlace place{x, y, 0, {}, x % side, static_cast<std::uint32_t>(y % slice_height % side)};
  for (std::uint32_t probe = 0; probe < block_count(desc); ++probe) {
    const BlockOrigin origin = block_origin(desc, probe);
    if (origin.x != x - place.block_x) continue;
    // An array of blocks has one in each slice.
    if (origin.y + (origin.slice + origin.block) * slice_height != y - place.block_y) continue;
    place.probe = probe;
    break;
  }
  place.position = block_position(desc, place.probe);
  return place;
}

std::string to_string(const TexelPlace& place) {
  return fmt::format("texel ({}, {}), probe {} ({}, {}, {})", place.x, place.y, place.probe,
                     place.position.x, place.position.y, place.position.z);
}

std::optional<Grid> grid_from_string(std::string_view text, std::uint32_t least) {
  std::uint32_t sides[3] = {};
  char separator = 'x';
  const char* at = text.data();
  const char* const end = at + text.size();
  for (int i = 0; i < 3; ++i) {
    if (i > 0 && (at == end || (*at != 'x' && *at != ',') || *at != separator)) return std::nullopt;
    if (i > 0) ++at;
    const auto parsed = std::from_chars(at, end, sides[i]);
    if (parsed.ec != std::errc{} || sides[i] < least) return std::nullopt;
    at = parsed.ptr;
    if (i == 0 && at != end) separator = *at;
  }
  if (at != end) return std::nullopt;
  return Grid{sides[0], sides[1], sides[2]};
}

std::string to_string(const Grid& grid) { return fmt::format("{}x{}x{}", grid.x, grid.y, grid.z); }

void fail_sample(const DumpInfo& info, const Component& component, SampleType type,
                 std::uint32_t sample, std::uint32_t x, std::uint32_t y, const std::string& path) {
  const std::string place = to_string(locate(info.desc, x, y));
  const std::size_t channels = info.desc.record.count;
  const std::size_t index = channels > 2 ? 2 : channels - 1;
  constexpr std::array<const char*, 3> kHalves = {"R16_SFLOAT", "R16G16_SFLOAT",
                                                  "R16G16B16A16_SFLOAT"};
  constexpr std::array<const char*, 3> kFloats = {"R32_SFLOAT", "R32G32_SFLOAT",
                                                  "R32G32B32A32_SFLOAT"};
  const std::string value = sample_text(type, sample);
  if (component.kind == ComponentKind::unorm && type != SampleType::uint32) {
    fail(Exit::bad_input,
         "{}: channel {}, {}: {} is not n/{}, so it is no {}-bit code; --vk-format {} keeps such "
         "values as they are",
         path, letter(component), place, value, max_code(component), component.bits,
         (type == SampleType::half ? kHalves : kFloats)[index]);
  }
  fail(Exit::bad_input, "{}: channel {}, {}: {} is no {}-bit code, which go from 0 to {}", path,
       letter(component), place, value, component.bits, max_code(component));
}

}  // namespace gicodec::tools
