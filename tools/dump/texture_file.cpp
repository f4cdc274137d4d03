#include "dump/texture_file.h"

#include "dump/cure.h"
#include "dump/error.h"
#include "dump/file.h"
#include "dump/file_system.h"
#include "dump/geometry_attributes.h"
#include "dump/internal.h"

#include <gicodec/container.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

namespace gicodec::tools {
namespace {

constexpr std::array<std::string_view, 8> kHeadFields = {kDdsHeader,  kKtx2Head,   kKtx2Scheme,
                                                         kRawSidecar, kRawExtent,  kExrOrigin,
                                                         kExrLinear,  kExrSampling};

/// Types of the gicodec:* attributes that are not strings.
struct TypeRow {
  std::string_view name, type;
};
constexpr std::array<TypeRow, 7> kTypes{{{kGrid, "v3i"},
                                         {kCore, "int"},
                                         {kBorder, "int"},
                                         {kBlock, "v3i"},
                                         {kExtent, "v3i"},
                                         {kOriginAttribute, "v3f"},
                                         {kSpacingAttribute, "v3f"}}};

TextureHead read_head(TextureFile& file, ImageKind kind, const Hints& hints) {
  switch (kind) {
    case ImageKind::dds:
      return read_dds_head(file);
    case ImageKind::ktx2:
      return read_ktx2_head(file);
    default:
      return read_raw_head(file, hints);
  }
}

/// Attributes of the head that do not follow from the texture.
void keep_head(TextureFile& file, const TextureHead& head, ImageKind kind, DumpInfo& first) {
  if (kind == ImageKind::dds) keep_dds_header(head, first);
  if (kind == ImageKind::ktx2) keep_ktx2_head(file, head, first);
  if (kind == ImageKind::raw) drop_implied_raw(first);
}

/// Throws if the file lacks texels, or has more bytes, which would be lost.
void check_bytes(const TextureFile& file, const TextureHead& head, Format format) {
  const std::uint64_t wanted = all_bytes(head, format);
  if (!head.stored.empty()) {
    for (std::uint32_t level = 0; level < head.levels; ++level) {
      const StoredLevel& stored = head.stored[level];
      const std::uint64_t own = level_bytes(head, level, format);
      if (stored.offset > file.size() || file.size() - stored.offset < stored.bytes) {
        fail(Exit::bad_input,
             "{}: is truncated: level {} takes {} bytes from byte {} on, and it has {}",
             file.path(), level, stored.bytes, stored.offset, file.size());
      }
      if (stored.unpacked != own) {
        fail(Exit::bad_input, "{}: level {} has {} bytes, and {} texels of {} take {}; {}",
             file.path(), level, stored.unpacked, to_string(level_texels(head, level)),
             find_format(format)->name, own, to_cure(Cure::fix_format));
      }
    }
    return;
  }
  if (head.offset > file.size() || file.size() - head.offset < wanted) {
    fail(Exit::bad_input,
         "{}: is truncated: its texels take {} bytes from byte {} on, and it has {}", file.path(),
         wanted, head.offset, file.size());
  }
  if (head.format == format && file.size() - head.offset > wanted) {
    fail(Exit::bad_input,
         "{}: has {} bytes behind the texels that its head describes, which would be lost; {}",
         file.path(), file.size() - head.offset - wanted,
         to_cure(Cure::cut_rest, head.offset + wanted, shell_word(file.path())));
  }
  if (head.bytes != wanted || file.size() - head.offset > wanted) {
    fail(Exit::bad_input, "{}: has {} bytes from its first texel on, but {} make its {}; {}",
         file.path(), std::max(head.bytes, file.size() - head.offset), wanted,
         find_format(format)->name, to_cure(Cure::fix_format));
  }
}

/// Reads an image's slices from where they are.
std::vector<std::byte> read_slices(TextureFile& file, const TextureHead& head, ImageKind kind,
                                   const DumpInfo& info) {
  const Format format = info.desc.record.format;
  const bool levels = kind == ImageKind::ktx2;
  const Runs runs =
      levels ? runs_by_level(head, info.place, format) : runs_by_element(head, info.place, format);
  std::vector<std::byte> texels(runs.count * runs.bytes);
  if (head.scheme != Scheme::none) {
    const StoredLevel& stored = head.stored[info.place.level];
    const auto packed = file.read(stored.offset, static_cast<std::size_t>(stored.bytes));
    const auto level =
        unpack_level(head.scheme, packed, static_cast<std::size_t>(stored.unpacked), file.path());
    gather(level, runs, texels);
    return texels;
  }
  const std::uint64_t begin =
      runs.first + (levels ? head.stored[info.place.level].offset : head.offset);
  for (std::uint32_t i = 0; i < runs.count; ++i) {
    file.read(begin + i * runs.stride, std::span(texels).subspan(i * runs.bytes, runs.bytes));
  }
  return texels;
}

/// The name of a sidecar to write and its text; no text if it follows from the texels, or if the
/// file there, which all frames may share, has it already.
std::pair<std::string, std::string> missing_sidecar(const std::string& path, const DumpInfo& info) {
  std::string text = raw_sidecar(info, path);
  const Attribute* where = find_attribute(info.attributes, kRawSidecar);
  const bool shared = where != nullptr && where->value == "shared";
  std::string sidecar = raw_sidecar_path(path, shared);
  if (!text.empty() && size_of_file(sidecar) == text.size()) {
    TextureFile old(sidecar);
    if (std::ranges::equal(old.read(0, text.size()), std::as_bytes(std::span(text)))) text.clear();
  }
  return {std::move(sidecar), std::move(text)};
}

/// Both files or none.
void write_with_sidecar(AtomicFile& texels, const std::string& path, const std::string& text,
                        Existing existing) {
  require_place(path);
  AtomicFile sidecar(path, existing);
  sidecar.write(std::as_bytes(std::span(text)));
  sidecar.sync();
  texels.sync();
  texels.commit();
  sidecar.commit();
}

}  // namespace

TextureFile::TextureFile(std::string path) : path_(std::move(path)) {
  // Opening a pipe would wait for its writer.
  std::error_code error;
  if (std::filesystem::exists(native_path(path_), error) &&
      !std::filesystem::is_regular_file(native_path(path_), error)) {
    fail(Exit::io, "{}: is no regular file", path_);
  }
  file_.reset(open_input(path_));
  if (!file_) fail(Exit::io, "{}: cannot be opened: {}", path_, reason(errno));
  const auto state = state_of(file_.get());
  if (!state) fail(Exit::io, "{}: cannot be read: {}", path_, reason(errno));
  size_ = state->size;
}

void TextureFile::read(std::uint64_t offset, std::span<std::byte> into) {
  if (offset > size_ || into.size() > size_ - offset) {
    fail(Exit::bad_input, "{}: is truncated", path_);
  }
  if (!seek_file(file_.get(), offset) ||
      std::fread(into.data(), 1, into.size(), file_.get()) != into.size()) {
    fail(Exit::io, "{}: cannot be read: {}", path_, reason(errno));
  }
}

std::vector<std::byte> TextureFile::read(std::uint64_t offset, std::size_t bytes) {
  if (offset > size_ || bytes > size_ - offset) fail(Exit::bad_input, "{}: is truncated", path_);
  std::vector<std::byte> all(bytes);
  read(offset, all);
  return all;
}

Attribute bytes_attribute(std::string name, std::span<const std::byte> bytes) {
  return {std::move(name), "bytes",
          "0x" + to_hex({reinterpret_cast<const char*>(bytes.data()), bytes.size()})};
}

std::vector<std::byte> attribute_bytes(const Attribute& attribute, const std::string& path) {
  std::string bytes;
  if (!attribute.value.starts_with("0x") || !from_hex(attribute.value.substr(2), bytes)) {
    fail(Exit::bad_input, "{}: attribute {} is not bytes in hexadecimal", path, attribute.name);
  }
  const auto all = std::as_bytes(std::span(bytes));
  return {all.begin(), all.end()};
}

Attribute text_attribute(std::string name, std::string_view text) {
  const auto* row = std::ranges::find(kTypes, name, &TypeRow::name);
  return {std::move(name), row == kTypes.end() ? "string" : std::string(row->type),
          std::string(text)};
}

bool is_compressed(Format format) noexcept {
  const FormatInfo* const info = find_format(format);
  return info != nullptr && info->width > 1;
}

Grid texels_of(const TextureDesc& desc) noexcept {
  const Extent size = extent(desc);
  const FormatInfo* const format = find_format(desc.record.format);
  const std::uint64_t width = format == nullptr ? 1 : format->width,
                      height = format == nullptr ? 1 : format->height;
  return {static_cast<std::uint32_t>(size.width * width),
          static_cast<std::uint32_t>(size.height * height),
          static_cast<std::uint32_t>(size.slices)};
}

Grid records_of(const Grid& texels, Format format) noexcept {
  const FormatInfo* const info = find_format(format);
  if (info == nullptr) return texels;
  return {(texels.x - 1) / info->width + 1, (texels.y - 1) / info->height + 1, texels.z};
}

bool is_head_field(std::string_view name) noexcept {
  return std::ranges::find(kHeadFields, name) != kHeadFields.end();
}

std::vector<std::string> drop_size_fields(Attributes& attributes) {
  std::vector<std::string> dropped;
  std::erase_if(attributes, [&](const Attribute& attribute) {
    const std::string& name = attribute.name;
    const bool follows = name == kRawExtent;
    const bool drops = follows || name == "displayWindow" || name == kDdsHeader ||
                       name == kKtx2Head || name == kExrOrigin;
    if (drops && !follows) dropped.push_back(name);
    return drops;
  });
  return dropped;
}

namespace {

DumpInfo texture_info(const TextureHead& head, const ImagePlace& place, bool first,
                      const Hints& hints, const std::string& path) {
  DumpInfo info;
  info.place = place;
  info.image = image_name(head, place);
  info.head = first;
  if (first) info.attributes = head.attributes;
  FoundImage found;
  found.format = head.format;
  found.format_name = head.format_name;
  found.texels = level_texels(head, place.level);
  found.volume = head.volume;
  found.bytes = head.levels > 1 || head.faces > 1 ? 0 : head.bytes;
  resolve(info, found, hints, path);
  const Record& record = info.desc.record;
  const bool other = head.format && *head.format != record.format;
  const bool format_given = hints.format || hints.any_format;
  if (other && (!format_given || Record(*head.format).bytes != record.bytes)) {
    fail(Exit::bad_input, "{}: is of format {}, not {}{}", path, find_format(*head.format)->name,
         find_format(record.format)->name,
         format_given ? ", whose texels have another size; " + to_cure(Cure::check_format) : "");
  }
  return info;
}

}  // namespace

std::vector<DumpInfo> texture_infos(const TextureHead& head, const Hints& hints,
                                    const std::string& path) {
  const std::vector<ImagePlace> places = places_of(head);
  if (hints.place) {
    const auto at = std::ranges::find(places, *hints.place);
    if (at == places.end()) {
      fail(Exit::bad_input, "{}: has no image {}: another file took its place?", path,
           hints.image.empty() ? "0" : hints.image);
    }
    return {texture_info(head, *at, at == places.begin(), hints, path)};
  }
  std::vector<DumpInfo> infos;
  Hints own = hints;
  for (const ImagePlace& place : places) {
    infos.push_back(texture_info(head, place, infos.empty(), own, path));
    if (infos.size() > 1) continue;
    // The others are read as the first is, in blocks of their own size.
    own = {};
    own.format = infos.front().desc.record.format;
    own.block = hints.block;
  }
  return infos;
}

std::vector<Dump> read_texture_file(const std::string& path, ImageKind kind, const Hints& hints,
                                    bool texels) {
  TextureFile file(path);
  const TextureHead head = read_head(file, kind, hints);
  std::vector<Dump> dumps;
  for (DumpInfo& info : texture_infos(head, hints, path)) {
    if (dumps.empty()) check_bytes(file, head, info.desc.record.format);
    if (info.head) keep_head(file, head, kind, info);
    dumps.push_back({std::move(info), {}});
  }
  try {
    for (Dump& dump : dumps) {
      if (texels) dump.texels = read_slices(file, head, kind, dump.info);
    }
  } catch (const std::bad_alloc&) {
    fail(Exit::internal, "{}: not enough memory", path);
  }
  return dumps;
}

void write_texture_file(const std::string& path, ImageKind kind, std::span<const Dump> images,
                        Existing existing) {
  for (const Dump& image : images) check_texels(image.info, image.texels, path);
  if (kind == ImageKind::dds) return write_file(path, dds_file(images, path), existing);
  if (kind == ImageKind::ktx2) return write_file(path, ktx2_file(images, path), existing);
  if (images.size() > 1) {
    fail(Exit::bad_input, "{}: a raw file holds one image, and there are {}", path, images.size());
  }
  AtomicFile file(path, existing);
  file.write(images.front().texels);
  const auto [sidecar, text] = missing_sidecar(path, images.front().info);
  if (text.empty()) return file.commit();
  write_with_sidecar(file, sidecar, text, existing);
}

std::vector<std::string> files_of(const std::string& path) {
  if (image_kind(path) != ImageKind::raw) return {path};
  return {path, raw_sidecar_path(path, false), raw_sidecar_path(path, true)};
}

}  // namespace gicodec::tools
