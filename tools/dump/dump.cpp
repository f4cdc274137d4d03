#include "dump/dump.h"

#include "dump/block_place.h"
#include "dump/cure.h"
#include "dump/error.h"
#include "dump/file_system.h"
#include "dump/internal.h"
#include "dump/text.h"
#include "dump/texture_file.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace gicodec::tools {
namespace {

/// Throws for a pipe: files are read twice, and opening a pipe would wait for its writer.
void require_no_pipe(const std::string& path) {
  std::error_code error;
  const auto type = std::filesystem::status(native_path(path), error).type();
  using enum std::filesystem::file_type;
  if (error || type == regular || type == directory || type == not_found) return;
  fail(Exit::io, "{}: is no regular file; dumps are read more than once, so copy it into one",
       path);
}

/// Throws for the file of three lines that Git LFS has in place of a large one.
void require_no_pointer(const std::string& path) {
  std::string line;
  std::ifstream file(native_path(path), std::ios::binary);
  line.resize(24);
  file.read(line.data(), static_cast<std::streamsize>(line.size()));
  if (!line.starts_with("version https://git-lfs")) return;
  fail(Exit::bad_input, "{}: is a pointer of Git LFS to a file, and not that file; {}", path,
       to_cure(Cure::fetch_lfs));
}

std::vector<Dump> read(const std::string& path, const Hints& hints, bool texels) {
  const ImageKind kind = require_image_kind(path);
  require_no_pipe(path);
  require_no_pointer(path);
  if (kind == ImageKind::exr) return read_exr(path, hints, texels);
  return is_written(kind) ? read_texture_file(path, kind, hints, texels)
                          : read_image(path, kind, hints, texels);
}

Dump only(std::vector<Dump> images, const std::string& path) {
  if (images.size() == 1) return std::move(images.front());
  fail(Exit::bad_input, "{}: holds {} images ({}), and one is expected", path, images.size(),
       listed(images, [](const Dump& image) { return image_words(image.info); }));
}

}  // namespace

std::string image_words(const DumpInfo& info) {
  return info.image.empty() ? "its main image" : info.image;
}

std::optional<ImageKind> image_kind(const std::string& path) {
  const std::string ending = lower_case(path_text(native_path(path).extension()));
  if (ending.empty() || ending == ".exr") return ImageKind::exr;
  if (ending == ".png") return ImageKind::png;
  if (ending == ".tif" || ending == ".tiff") return ImageKind::tiff;
  if (ending == ".dpx") return ImageKind::dpx;
  if (ending == ".dds") return ImageKind::dds;
  if (ending == ".ktx2") return ImageKind::ktx2;
  if (ending == ".raw" || ending == ".bin") return ImageKind::raw;
  return std::nullopt;
}

bool has_format(ImageKind kind, Format format) noexcept {
  return kind == ImageKind::dds ? dds_has_format(format) : is_written(kind);
}

ImageKind require_image_kind(const std::string& path) {
  if (const auto kind = image_kind(path)) return *kind;
  if (lower_case(path_text(native_path(path).extension())) == ".gic") {
    if (std::error_code error; !std::filesystem::exists(native_path(path), error)) {
      fail(Exit::io, "{}: cannot be opened: {}", path,
           std::make_error_code(std::errc::no_such_file_or_directory).message());
    }
    if (!is_container_file(path)) fail(Exit::bad_input, "{}: is not a .gic container", path);
    fail(Exit::bad_input, "{}: is a container; {}", path,
         to_cure(Cure::decode_first, shell_word(path)));
  }
  fail(Exit::bad_input,
       "{}: is named like no image that is read: .exr, .dds, .ktx2, .raw, .bin, .png, .tif, .tiff, "
       ".dpx; {}",
       path, to_cure(Cure::name_dumps));
}

std::vector<DumpInfo> read_dump_infos(const std::string& path, const Hints& hints) {
  std::vector<DumpInfo> infos;
  for (Dump& dump : read(path, hints, false)) infos.push_back(std::move(dump.info));
  return infos;
}

std::vector<Dump> read_dumps(const std::string& path, const Hints& hints) {
  return read(path, hints, true);
}

DumpInfo read_dump_info(const std::string& path, const Hints& hints) {
  return std::move(only(read(path, hints, false), path).info);
}

Dump read_dump(const std::string& path, const Hints& hints) {
  return only(read(path, hints, true), path);
}

Hints settle_formats(std::span<const std::string> paths, Hints hints) {
  for (const std::string& path : paths) {
    if (hints.plain) break;
    for (const DumpInfo& info : read_dump_infos(path, hints)) {
      if (!info.guessed) continue;
      try {
        (void)read_dump(path, hints_of(info));
      } catch (const Error& error) {
        if (error.code() != Exit::bad_input) throw;
        hints.plain = true;  // Or a damaged file, of which reading it again tells.
        break;
      }
    }
  }
  return hints;
}

void check_texels(const DumpInfo& info, std::span<const std::byte> texels,
                  const std::string& path) {
  check(validate(info.desc), path);
  if (texels.size() == texture_bytes(info.desc)) return;
  fail(Exit::internal, "{}: {} bytes of texels given, the texture has {}", path, texels.size(),
       texture_bytes(info.desc));
}

void write_dumps(const std::string& path, std::span<const Dump> images, Existing existing) {
  require_place(path);
  const ImageKind kind = image_kind(path).value_or(ImageKind::exr);
  if (kind == ImageKind::exr || !is_written(kind)) {
    write_file(path, to_exr(images, path), existing);
  } else {
    write_texture_file(path, kind, images, existing);
  }
}

void write_dump(const std::string& path, const DumpInfo& info, std::span<const std::byte> texels,
                Existing existing) {
  const Dump image{info, {texels.begin(), texels.end()}};
  write_dumps(path, {&image, 1}, existing);
}

ChannelLayout default_channels(Format format) {
  const FormatInfo* const info = find_format(format);
  ChannelLayout channels;
  for (std::size_t i = 0; info != nullptr && i < info->record.count; ++i) {
    for (const SampleType type : {SampleType::uint32, SampleType::float32, SampleType::half}) {
      if (can_hold(type, info->record.components[i], info->record)) channels.types[i] = type;
    }
  }
  return channels;
}

bool has_channel(const ChannelLayout& channels, const Component& component) noexcept {
  if (component.type == ComponentType::exponent) return channels.exponent;
  return channels.alpha || letter(component) != 'A';
}

bool can_hold(const ChannelLayout& channels, SampleType type, const Component& component,
              const Record& record) noexcept {
  return channels.exponent ? can_hold(type, component, record) : type != SampleType::uint32;
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
    if (!has_channel(channels, info.record.components[i])) continue;
    text += fmt::format("{}{}:{}", text.empty() ? "" : " ", name, to_string(channels.types[i]));
  }
  return text;
}

std::optional<ChannelLayout> channels_from_string(std::string_view text, Format format) {
  const FormatInfo& info = *find_format(format);
  ChannelLayout channels;
  if (text.ends_with(' ')) return std::nullopt;
  channels.exponent = !has_exponent(info.record) || text.find("E:") != std::string_view::npos;
  for (std::size_t i = 0; i < info.record.count; ++i) {
    const Component& component = info.record.components[i];
    const std::string_view item = text.substr(0, text.find(' '));
    if (item.size() < 3 || item[0] != letter(component) || item[1] != ':') {
      if (has_channel(channels, component) && letter(component) != 'A') return std::nullopt;
      if (letter(component) == 'A') channels.alpha = false;
      continue;
    }
    const auto type = sample_type_from_string(item.substr(2));
    if (!type || !can_hold(channels, *type, component, info.record)) return std::nullopt;
    channels.types[i] = *type;
    text.remove_prefix(std::min(text.size(), item.size() + 1));
  }
  if (!text.empty()) return std::nullopt;
  return channels;
}

Hints hints_of(const TextureDesc& desc) {
  Hints hints;
  hints.desc = desc;
  hints.any_format = true;
  return hints;
}

Hints hints_of(const DumpInfo& info) {
  Hints hints = hints_of(info.desc);
  hints.place = info.place;
  hints.image = info.image;
  hints.head = info.head;
  const Record& record = info.desc.record;
  for (std::size_t i = 0; i < record.count; ++i) {
    const char name = letter(record.components[i]);
    if (!has_channel(info.channels, record.components[i])) continue;
    hints.channels[name] = channel_name(info.channels, info.desc.record.format, i);
  }
  return hints;
}

DumpInfo make_info(const TextureDesc& desc) {
  DumpInfo info;
  info.desc = desc;
  info.channels = default_channels(desc.record.format);
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

const char* block_word(const TextureDesc& desc) noexcept {
  return is_probes(desc) ? "probe" : "block";
}

TexelPlace locate(const TextureDesc& desc, std::uint32_t x, std::uint32_t y) {
  const Extent size = extent(desc);
  TexelPlace place{block_word(desc), x, y, 0, {}, 0, 0};
  for (std::uint32_t block = 0; block < block_count(desc); ++block) {
    const BlockPlace at = block_place(desc, size, block);
    if (x < at.x || x - at.x >= at.width || y < at.y) continue;
    const std::uint64_t row = (y - at.y) % size.height, slice = (y - at.y) / size.height;
    if (row >= at.rows || slice >= at.slices) continue;
    place.probe = block;
    place.block_x = static_cast<std::uint32_t>(x - at.x);
    place.block_y = static_cast<std::uint32_t>(row);
    break;
  }
  place.position = block_position(desc, place.probe);
  return place;
}

std::string to_string(const TexelPlace& place) {
  return fmt::format("texel ({}, {}), {} {} ({}, {}, {})", place.x, place.y, place.word,
                     place.probe, place.position.x, place.position.y, place.position.z);
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
  const std::string fault =
      component.type == ComponentType::unorm && type != SampleType::uint32
          ? fmt::format("is not n/{}, so it is no {}-bit code", max_code(component), component.bits)
      : component.type == ComponentType::sfloat
          ? fmt::format("is no float of {} bits", component.bits)
          : fmt::format("is no {}-bit code; files of this format hold codes 0 to {}",
                        component.bits, max_code(component));
  const std::string cure =
      type == SampleType::uint32
          ? ""
          : "; " +
                to_cure(Cure::keep_values, (type == SampleType::half ? kHalves : kFloats)[index]);
  fail(Exit::bad_input, "{}: channel {}, {}: {} {}{}", path, letter(component), place, value, fault,
       cure);
}

}  // namespace gicodec::tools
