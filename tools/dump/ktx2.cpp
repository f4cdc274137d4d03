// KTX2 files (Khronos, "KTX File Format Specification, Version 2").
#include "dump/error.h"
#include "dump/ktx2_format.h"
#include "dump/texture_file.h"

#include <gicodec/container.h>

#include <algorithm>
#include <array>
#include <numeric>

namespace gicodec::tools {
namespace {

constexpr std::array<unsigned char, 12> kIdentifier = {0xAB, 'K',  'T',  'X',  ' ',  '2',
                                                       '0',  0xBB, '\r', '\n', 0x1A, '\n'};
/// The head: fields, then offsets of the file's parts, then the first level's.
constexpr std::size_t kFixedBytes = 48, kHeadBytes = 104;
constexpr std::size_t kVkFormat = 12, kTypeSize = 16, kWidth = 20, kHeight = 24, kDepth = 28,
                      kLayers = 32, kFaces = 36, kLevels = 40, kScheme = 44, kDfdOffset = 48,
                      kDfdBytes = 52, kKvdOffset = 56, kKvdBytes = 60, kSgdBytes = 72,
                      kLevelOffset = 80, kLevelBytes = 88, kUnpackedBytes = 96;

std::uint64_t long_at(std::span<const std::byte> bytes, std::size_t offset) {
  return word_at(bytes, offset) | std::uint64_t{word_at(bytes, offset + 4)} << 32;
}
void set_long(std::span<std::byte> bytes, std::size_t offset, std::uint64_t value) {
  set_word(bytes, offset, static_cast<std::uint32_t>(value));
  set_word(bytes, offset + 4, static_cast<std::uint32_t>(value >> 32));
}
constexpr std::size_t padded(std::size_t bytes) { return (bytes + 3) / 4 * 4; }

bool is_ktx2(std::span<const std::byte> fixed) {
  return std::memcmp(fixed.data(), kIdentifier.data(), kIdentifier.size()) == 0;
}

std::string scheme_name(std::uint32_t scheme) {
  constexpr std::array<const char*, 4> kSchemes = {"none", "BasisLZ", "Zstandard", "ZLIB"};
  return scheme < kSchemes.size() ? kSchemes[scheme] : fmt::format("scheme {}", scheme);
}

/// `fixed`: the first kFixedBytes bytes of a file.
TextureHead parse(std::span<const std::byte> fixed, const std::string& path) {
  if (const std::uint32_t scheme = word_at(fixed, kScheme); scheme != 0) {
    fail(Exit::bad_input,
         "{}: is supercompressed ({}); write it without, since a container compresses it", path,
         scheme_name(scheme));
  }
  if (const std::uint32_t levels = word_at(fixed, kLevels); levels > 1) {
    fail(Exit::bad_input,
         "{}: has {} mipmaps; write it with one level, as ktx create --levels 1 does", path,
         levels);
  }
  const std::uint32_t faces = word_at(fixed, kFaces), depth = word_at(fixed, kDepth),
                      layers = word_at(fixed, kLayers);
  if (faces == 6) {
    fail(Exit::bad_input, "{}: is a cube map; write its faces as a texture array", path);
  }
  if (depth > 0 && layers > 0) {
    fail(Exit::bad_input, "{}: is an array of 3D textures; write a file for each", path);
  }
  TextureHead head;
  head.volume = depth > 0;
  head.texels = {word_at(fixed, kWidth), std::max(1U, word_at(fixed, kHeight)),
                 std::max({1U, depth, layers})};
  if (head.texels.x == 0 || faces != 1) {
    fail(Exit::bad_input, "{}: its KTX2 header is damaged", path);
  }
  const std::uint32_t number = word_at(fixed, kVkFormat);
  head.format_name = fmt::format("VkFormat {}", number);
  if (number != 0 && find_format(static_cast<Format>(number)) != nullptr) {
    head.format = static_cast<Format>(number);
  }
  return head;
}

/// Reads a key, NUL, and a value, which is text if its only NUL is its last byte.
Attribute read_entry(std::span<const std::byte> entry, const std::string& path) {
  const std::string_view text(reinterpret_cast<const char*>(entry.data()), entry.size());
  const std::size_t end = text.find('\0');
  const std::string key(text.substr(0, end));
  if (end == std::string_view::npos || key.empty() || !is_utf8(key) || is_head_field(key)) {
    fail(Exit::bad_input, "{}: its key {} cannot be kept", path, key);
  }
  const std::string_view value = text.substr(end + 1);
  const bool is_text = value.find('\0') + 1 == value.size() && !value.empty() && is_utf8(value) &&
                       !value.starts_with("0x");
  if (is_text) return text_attribute(key, value.substr(0, value.size() - 1));
  return bytes_attribute(key, entry.subspan(end + 1));
}

Attributes read_entries(std::span<const std::byte> bytes, const std::string& path) {
  Attributes attributes;
  while (!bytes.empty()) {
    if (bytes.size() < 4 || word_at(bytes, 0) > bytes.size() - 4) {
      fail(Exit::bad_input, "{}: its keys and values are damaged", path);
    }
    const std::size_t size = word_at(bytes, 0);
    if (attributes.size() == kMaxAttributes) {
      fail(Exit::bad_input, "{}: has more than {} keys", path, kMaxAttributes);
    }
    attributes.push_back(read_entry(bytes.subspan(4, size), path));
    bytes = bytes.subspan(std::min(bytes.size(), padded(4 + size)));
  }
  std::ranges::sort(attributes, {}, &Attribute::name);
  const auto twice = std::ranges::adjacent_find(attributes, {}, &Attribute::name);
  if (twice != attributes.end()) {
    fail(Exit::bad_input, "{}: has key {} twice", path, twice->name);
  }
  return attributes;
}

std::vector<std::byte> write_entries(const Attributes& attributes, const std::string& path) {
  std::vector<std::byte> all;
  for (const Attribute& attribute : attributes) {
    if (is_head_field(attribute.name)) continue;
    std::vector<std::byte> value;
    if (attribute.value.starts_with("0x")) {
      value = attribute_bytes(attribute, path);
    } else {
      const auto text = std::as_bytes(std::span(attribute.value));
      value.assign(text.begin(), text.end());
      value.push_back(std::byte{0});
    }
    const auto key = std::as_bytes(std::span(attribute.name));
    if (attribute.name.empty() || attribute.name.find('\0') != std::string::npos) {
      fail(Exit::bad_input, "{}: attribute {} cannot be written as a key of KTX2", path,
           attribute.name);
    }
    const std::size_t size = key.size() + 1 + value.size();
    if (size > kMaxHeadBytes || all.size() > kMaxHeadBytes) {
      fail(Exit::bad_input, "{}: its attributes take more than {} bytes", path, kMaxHeadBytes);
    }
    const std::size_t at = all.size();
    all.resize(at + padded(4 + size));
    set_word(all, at, static_cast<std::uint32_t>(size));
    std::ranges::copy(key, all.begin() + static_cast<std::ptrdiff_t>(at + 4));
    std::ranges::copy(value, all.begin() + static_cast<std::ptrdiff_t>(at + 5 + key.size()));
  }
  return all;
}

/// The default first kFixedBytes bytes of a texture's file.
std::vector<std::byte> implied_header(const TextureDesc& desc) {
  const Grid texels = texels_of(desc);
  const bool volume = is_volume(desc);
  std::vector<std::byte> fixed(kFixedBytes);
  std::memcpy(fixed.data(), kIdentifier.data(), kIdentifier.size());
  set_word(fixed, kVkFormat, static_cast<std::uint32_t>(desc.record.format));
  set_word(fixed, kTypeSize, ktx2_type_size(desc.record));
  set_word(fixed, kWidth, texels.x);
  set_word(fixed, kHeight, texels.y);
  set_word(fixed, kDepth, volume ? texels.z : 0);
  set_word(fixed, kLayers, volume || texels.z == 1 ? 0 : texels.z);
  set_word(fixed, kFaces, 1);
  set_word(fixed, kLevels, 1);
  return fixed;
}

/// The bytes of attribute `name`, or else `implied`.
std::vector<std::byte> kept(const DumpInfo& info, const char* name, std::vector<std::byte> implied,
                            const std::string& path) {
  const Attribute* attribute = find_attribute(info.attributes, name);
  return attribute == nullptr ? std::move(implied) : attribute_bytes(*attribute, path);
}

}  // namespace

TextureHead read_ktx2_head(TextureFile& file) {
  const std::string& path = file.path();
  if (file.size() < kIdentifier.size() || !is_ktx2(file.read(0, kIdentifier.size()))) {
    fail(Exit::bad_input, "{}: is not a KTX2 file", path);
  }
  const auto start = file.read(0, kHeadBytes);
  const std::span fixed = std::span(start).first(kFixedBytes);
  TextureHead head = parse(fixed, path);
  const std::uint64_t dfd = word_at(start, kDfdBytes), kvd = word_at(start, kKvdBytes);
  if (dfd < 4 || dfd > kMaxHeadBytes || kvd > kMaxHeadBytes || long_at(start, kSgdBytes) != 0) {
    fail(Exit::bad_input, "{}: its KTX2 header is damaged", path);
  }
  const auto descriptor = file.read(word_at(start, kDfdOffset), static_cast<std::size_t>(dfd));
  if (word_at(descriptor, 0) != dfd) {
    fail(Exit::bad_input, "{}: its data format descriptor is damaged", path);
  }
  if (kvd > 0) {
    const auto entries = file.read(word_at(start, kKvdOffset), static_cast<std::size_t>(kvd));
    head.attributes = read_entries(entries, path);
  }
  head.offset = long_at(start, kLevelOffset);
  head.bytes = long_at(start, kLevelBytes);
  if (long_at(start, kUnpackedBytes) != head.bytes) {
    fail(Exit::bad_input, "{}: its KTX2 header is damaged", path);
  }
  set_attribute(head.attributes, bytes_attribute(kKtx2Header, fixed));
  set_attribute(head.attributes, bytes_attribute(kKtx2Format, descriptor));
  return head;
}

void drop_implied_ktx2(DumpInfo& info) {
  std::erase(info.attributes, bytes_attribute(kKtx2Header, implied_header(info.desc)));
  std::erase(info.attributes, bytes_attribute(kKtx2Format, ktx2_descriptor(info.desc.record)));
}

std::vector<std::byte> ktx2_head(const DumpInfo& info, const std::string& path) {
  const auto fixed = kept(info, kKtx2Header, implied_header(info.desc), path);
  if (fixed.size() != kFixedBytes || !is_ktx2(fixed) || !fits(parse(fixed, path), info.desc)) {
    fail(Exit::bad_input, "{}: attribute {} is of another texture", path, kKtx2Header);
  }
  const auto descriptor = kept(info, kKtx2Format, ktx2_descriptor(info.desc.record), path);
  if (descriptor.size() < 4 || word_at(descriptor, 0) != descriptor.size()) {
    fail(Exit::bad_input, "{}: attribute {} is damaged", path, kKtx2Format);
  }
  const auto entries = write_entries(info.attributes, path);
  const std::size_t dfd_offset = kHeadBytes, kvd_offset = dfd_offset + descriptor.size();
  // The analyzer also considers invalid textures, with 0 bytes.
  const std::size_t texel = std::max<std::size_t>(1, info.desc.record.bytes);
  const std::size_t alignment = std::lcm<std::size_t>(texel, 4);
  const std::size_t end = kvd_offset + entries.size();
  const std::size_t offset = (end + alignment - 1) / alignment * alignment;
  const std::uint64_t bytes = texture_bytes(info.desc);
  std::vector<std::byte> head(offset);
  std::ranges::copy(fixed, head.begin());
  set_word(head, kDfdOffset, static_cast<std::uint32_t>(dfd_offset));
  set_word(head, kDfdBytes, static_cast<std::uint32_t>(descriptor.size()));
  set_word(head, kKvdOffset, entries.empty() ? 0 : static_cast<std::uint32_t>(kvd_offset));
  set_word(head, kKvdBytes, static_cast<std::uint32_t>(entries.size()));
  set_long(head, kLevelOffset, offset);
  set_long(head, kLevelBytes, bytes);
  set_long(head, kUnpackedBytes, bytes);
  std::ranges::copy(descriptor, head.begin() + kHeadBytes);
  std::ranges::copy(entries, head.begin() + static_cast<std::ptrdiff_t>(kvd_offset));
  return head;
}

}  // namespace gicodec::tools
