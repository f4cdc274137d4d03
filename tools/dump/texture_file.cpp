#include "dump/texture_file.h"

#include "dump/error.h"
#include "dump/file.h"
#include "dump/geometry_attributes.h"
#include "dump/internal.h"

#include <gicodec/container.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <system_error>

namespace gicodec::tools {
namespace {

constexpr std::array<std::string_view, 5> kHeadFields = {kDdsHeader, kKtx2Header, kKtx2Format,
                                                         kRawSidecar, kRawExtent};

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
      return read_raw_head(file, hints.desc);
  }
}

void drop_implied(DumpInfo& info, ImageKind kind) {
  if (kind == ImageKind::dds) drop_implied_dds(info);
  if (kind == ImageKind::ktx2) drop_implied_ktx2(info);
  if (kind == ImageKind::raw) drop_implied_raw(info);
}

/// Throws if the file lacks texels, or has more bytes, which would be lost.
void check_bytes(const TextureFile& file, const TextureHead& head, const TextureDesc& desc) {
  const std::uint64_t wanted = texture_bytes(desc);
  if (head.offset > file.size() || file.size() - head.offset < wanted) {
    fail(Exit::bad_input,
         "{}: is truncated: its texels take {} bytes from byte {} on, and it has {}", file.path(),
         wanted, head.offset, file.size());
  }
  if (head.bytes != wanted || file.size() - head.offset > wanted) {
    fail(Exit::bad_input,
         "{}: has {} bytes from its first texel on, but {} make its {}; check its format, or "
         "--vk-format",
         file.path(), std::max(head.bytes, file.size() - head.offset), wanted,
         find_format(desc.record.format)->name);
  }
}

/// Writes the sidecar; one that all frames share is written with the first.
void write_sidecar(const std::string& path, const DumpInfo& info, Existing existing) {
  const std::string text = raw_sidecar(info, path);
  if (text.empty()) return;
  const Attribute* where = find_attribute(info.attributes, kRawSidecar);
  const bool shared = where != nullptr && where->value == "shared";
  const std::string sidecar = raw_sidecar_path(path, shared);
  const auto bytes = std::as_bytes(std::span(text));
  std::error_code error;
  if (std::filesystem::file_size(sidecar, error) == bytes.size() && !error) {
    TextureFile old(sidecar);
    if (std::ranges::equal(old.read(0, bytes.size()), bytes)) return;
  }
  write_file(sidecar, bytes, existing);
}

}  // namespace

TextureFile::TextureFile(std::string path) : path_(std::move(path)) {
  // Opening a pipe would wait for its writer.
  std::error_code error;
  if (std::filesystem::exists(path_, error) && !std::filesystem::is_regular_file(path_, error)) {
    fail(Exit::io, "{}: is no regular file", path_);
  }
  file_.reset(std::fopen(path_.c_str(), "rb"));
  if (!file_) fail(Exit::io, "{}: cannot be opened: {}", path_, std::strerror(errno));
  size_ = std::filesystem::file_size(path_, error);
  if (error) fail(Exit::io, "{}: cannot be read: {}", path_, error.message());
}

void TextureFile::read(std::uint64_t offset, std::span<std::byte> into) {
  if (offset > size_ || into.size() > size_ - offset) {
    fail(Exit::bad_input, "{}: is truncated", path_);
  }
  if (std::fseek(file_.get(), static_cast<long>(offset), SEEK_SET) != 0 ||
      std::fread(into.data(), 1, into.size(), file_.get()) != into.size()) {
    fail(Exit::io, "{}: cannot be read: {}", path_, std::strerror(errno));
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

Grid texels_of(const TextureDesc& desc) noexcept {
  const Extent size = extent(desc);
  const std::uint64_t each = texels_of_record(desc.record.format);
  return {static_cast<std::uint32_t>(size.width * each),
          static_cast<std::uint32_t>(size.height * each), static_cast<std::uint32_t>(size.slices)};
}

Grid records_of(const Grid& texels, Format format) noexcept {
  const std::uint32_t each = texels_of_record(format);
  return {(texels.x - 1) / each + 1, (texels.y - 1) / each + 1, texels.z};
}

bool is_head_field(std::string_view name) noexcept {
  return std::ranges::find(kHeadFields, name) != kHeadFields.end();
}

void drop_size_fields(Attributes& attributes) {
  std::erase_if(attributes, [](const Attribute& attribute) {
    return attribute.name == "displayWindow" || attribute.name == kDdsHeader ||
           attribute.name == kKtx2Header || attribute.name == kRawExtent;
  });
}

bool fits(const TextureHead& head, const TextureDesc& desc) noexcept {
  const Grid records = records_of(head.texels, desc.record.format);
  const bool size = extent(desc) == Extent{records.x, records.y, records.z};
  return size && (!head.format || Record(*head.format).bytes == desc.record.bytes);
}

DumpInfo texture_info(const TextureHead& head, ImageKind kind, const Hints& hints,
                      const std::string& path) {
  DumpInfo info;
  info.attributes = head.attributes;
  FoundImage found;
  found.format = head.format;
  found.format_name = head.format_name;
  found.texels = head.texels;
  found.volume = head.volume;
  found.bytes = head.bytes;
  resolve(info, found, hints, path);
  const Record& record = info.desc.record;
  const bool other = head.format && *head.format != record.format;
  const bool format_given = hints.format || hints.any_format;
  if (other && (!format_given || Record(*head.format).bytes != record.bytes)) {
    fail(Exit::bad_input, "{}: is of format {}, not {}{}", path, find_format(*head.format)->name,
         find_format(record.format)->name,
         format_given ? ", whose texels have another size; check --vk-format" : "");
  }
  drop_implied(info, kind);
  return info;
}

Dump read_texture_file(const std::string& path, ImageKind kind, const Hints& hints, bool texels) {
  TextureFile file(path);
  const TextureHead head = read_head(file, kind, hints);
  Dump dump;
  dump.info = texture_info(head, kind, hints, path);
  check_bytes(file, head, dump.info.desc);
  if (!texels) return dump;
  try {
    dump.texels.resize(static_cast<std::size_t>(head.bytes));
  } catch (const std::bad_alloc&) {
    fail(Exit::internal, "{}: not enough memory", path);
  }
  file.read(head.offset, dump.texels);
  return dump;
}

void write_texture_file(const std::string& path, ImageKind kind, const DumpInfo& info,
                        std::span<const std::byte> texels, Existing existing) {
  check_texels(info, texels, path);
  std::vector<std::byte> head;
  if (kind == ImageKind::dds) head = dds_head(info, path);
  if (kind == ImageKind::ktx2) head = ktx2_head(info, path);
  AtomicFile file(path, existing);
  file.write(head);
  file.write(texels);
  // After the steps that fail most often, so that no sidecar is left without texels.
  if (kind == ImageKind::raw) write_sidecar(path, info, existing);
  file.commit();
}

std::vector<std::string> files_of(const std::string& path) {
  if (image_kind(path) != ImageKind::raw) return {path};
  return {path, raw_sidecar_path(path, false), raw_sidecar_path(path, true)};
}

}  // namespace gicodec::tools
