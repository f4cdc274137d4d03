// KTX2 files (Khronos, "KTX File Format Specification, Version 2").
#include "dump/cure.h"
#include "dump/error.h"
#include "dump/internal.h"
#include "dump/ktx2_format.h"
#include "dump/ktx2_keys.h"
#include "dump/texture_file.h"

#include <gicodec/container.h>

#include <algorithm>
#include <array>
#include <numeric>

namespace gicodec::tools {
namespace {

constexpr std::array<unsigned char, 12> kIdentifier = {0xAB, 'K',  'T',  'X',  ' ',  '2',
                                                       '0',  0xBB, '\r', '\n', 0x1A, '\n'};
/// The head: fields, offsets of the file's parts, then three numbers for each level.
constexpr std::size_t kFixedBytes = 48, kIndexBytes = 80, kLevelBytes = 24;
constexpr std::size_t kVkFormat = 12, kTypeSize = 16, kWidth = 20, kHeight = 24, kDepth = 28,
                      kLayers = 32, kFaces = 36, kLevels = 40, kScheme = 44, kDfdOffset = 48,
                      kDfdBytes = 52, kKvdOffset = 56, kKvdBytes = 60, kSgdBytes = 72;
constexpr std::uint32_t kUastc = 166;  ///< a colour model

std::uint64_t long_at(std::span<const std::byte> bytes, std::size_t offset) {
  return word_at(bytes, offset) | std::uint64_t{word_at(bytes, offset + 4)} << 32;
}
void set_long(std::span<std::byte> bytes, std::size_t offset, std::uint64_t value) {
  set_word(bytes, offset, static_cast<std::uint32_t>(value));
  set_word(bytes, offset + 4, static_cast<std::uint32_t>(value >> 32));
}

bool is_ktx2(std::span<const std::byte> fixed) {
  return std::memcmp(fixed.data(), kIdentifier.data(), kIdentifier.size()) == 0;
}

[[noreturn]] void fail_basis(const std::string& path, std::string_view what) {
  fail(Exit::bad_input, "{}: holds {}, which is made for transcoding; {}", path, what,
       to_cure(Cure::transcode));
}

/// Throws if levels claim to unpack to more than packed ones do.
void check_unpacked(const TextureHead& head, const std::string& path) {
  constexpr std::uint64_t kZstdRatio = 100000;
  std::uint64_t bytes = 0;
  for (const StoredLevel& level : head.stored) bytes += level.unpacked;
  if (head.scheme == Scheme::none) return;
  check_image_bytes(bytes, head.scheme == Scheme::zlib ? kMaxRatio : kZstdRatio, path);
}

/// `fixed`: the first kFixedBytes bytes of a file.
TextureHead parse(std::span<const std::byte> fixed, const std::string& path) {
  TextureHead head;
  const std::uint32_t scheme = word_at(fixed, kScheme);
  if (scheme == static_cast<std::uint32_t>(Scheme::basis_lz)) fail_basis(path, "BasisLZ");
  if (scheme > static_cast<std::uint32_t>(Scheme::zlib)) {
    fail(Exit::bad_input, "{}: is supercompressed by scheme {}, which is unknown; {}", path, scheme,
         to_cure(Cure::write_plain));
  }
  head.scheme = static_cast<Scheme>(scheme);
  const std::uint32_t depth = word_at(fixed, kDepth), layers = word_at(fixed, kLayers);
  if (depth > 0 && layers > 0) {
    fail(Exit::bad_input, "{}: is an array of 3D textures; {}", path, to_cure(Cure::split_array));
  }
  head.volume = depth > 0;
  head.texels = {word_at(fixed, kWidth), std::max(1U, word_at(fixed, kHeight)),
                 std::max({1U, depth, layers})};
  head.levels = std::max(1U, word_at(fixed, kLevels));
  head.faces = word_at(fixed, kFaces);
  std::string fault;
  if (head.texels.x == 0) fault = "a width of 0";
  if (head.faces != 1 && (head.faces != 6 || head.volume))
    fault = fmt::format("{} faces", head.faces);
  if (head.levels > max_levels(head)) {
    fault = fmt::format("{} levels of {} texels", head.levels, to_string(head.texels));
  }
  if (!fault.empty()) fail(Exit::bad_input, "{}: its KTX2 header is damaged: {}", path, fault);
  const std::uint32_t number = word_at(fixed, kVkFormat);
  head.format_name = fmt::format("VkFormat {}", number);
  if (number != 0 && find_format(static_cast<Format>(number)) != nullptr) {
    head.format = static_cast<Format>(number);
  }
  return head;
}

/// The place of a level's three numbers.
constexpr std::size_t level_at(std::uint32_t level) { return kIndexBytes + kLevelBytes * level; }

void set_level(std::span<std::byte> head, std::uint32_t level, const StoredLevel& stored) {
  set_long(head, level_at(level), stored.offset);
  set_long(head, level_at(level) + 8, stored.bytes);
  set_long(head, level_at(level) + 16, stored.unpacked);
}

/// Bytes between the starts of levels, which are multiples of it.
std::uint64_t alignment_of(Scheme scheme, const Record& record) {
  // The analyzer also considers invalid textures, with 0 bytes.
  const std::uint64_t texel = std::max<std::uint64_t>(1, record.bytes);
  return scheme == Scheme::none ? std::lcm<std::uint64_t>(texel, 4) : 1;
}

/// Sets the levels' places behind `begin`, smallest first, in a head too.
void place_levels(std::vector<StoredLevel>& levels, std::uint64_t begin, std::uint64_t alignment,
                  std::span<std::byte> head) {
  for (auto level = static_cast<std::uint32_t>(levels.size()); level-- > 0;) {
    levels[level].offset = (begin + alignment - 1) / alignment * alignment;
    set_level(head, level, levels[level]);
    begin = levels[level].offset + levels[level].bytes;
  }
}

/// A head with levels of these sizes, which stand behind it, smallest first; sets their offsets.
std::vector<std::byte> implied_head(const TextureHead& head, const DumpInfo& first,
                                    std::vector<StoredLevel>& levels, const std::string& path) {
  const Record& record = first.desc.record;
  const auto descriptor = ktx2_descriptor(record);
  const auto entries = write_ktx2_keys(first.attributes, path);
  const std::size_t dfd_offset = level_at(head.levels), kvd_offset = dfd_offset + descriptor.size();
  std::vector<std::byte> bytes(kvd_offset + entries.size());
  const auto set = [&](std::size_t at, std::size_t value) {
    set_word(bytes, at, static_cast<std::uint32_t>(value));
  };
  std::memcpy(bytes.data(), kIdentifier.data(), kIdentifier.size());
  set(kVkFormat, static_cast<std::uint32_t>(record.format));
  set(kTypeSize, ktx2_type_size(record));
  set(kWidth, head.texels.x);
  set(kHeight, head.texels.y);
  set(kDepth, head.volume ? head.texels.z : 0);
  set(kLayers, head.volume || head.texels.z == 1 ? 0 : head.texels.z);
  set(kFaces, head.faces);
  set(kLevels, head.levels);
  set(kScheme, static_cast<std::size_t>(head.scheme));
  set(kDfdOffset, dfd_offset);
  set(kDfdBytes, descriptor.size());
  set(kKvdOffset, entries.empty() ? 0 : kvd_offset);
  set(kKvdBytes, entries.size());
  std::ranges::copy(descriptor, bytes.begin() + static_cast<std::ptrdiff_t>(dfd_offset));
  std::ranges::copy(entries, bytes.begin() + static_cast<std::ptrdiff_t>(kvd_offset));
  place_levels(levels, bytes.size(), alignment_of(head.scheme, record), bytes);
  bytes.resize(static_cast<std::size_t>(levels[head.levels - 1].offset));
  return bytes;
}

std::vector<StoredLevel> stored_levels(std::span<const std::byte> head, std::uint32_t count) {
  std::vector<StoredLevel> levels;
  for (std::uint32_t level = 0; level < count; ++level) {
    const std::size_t at = level_at(level);
    levels.push_back({long_at(head, at), long_at(head, at + 8), long_at(head, at + 16)});
  }
  return levels;
}

/// The levels by their places in the file. Throws unless they stand behind one another.
std::vector<std::uint32_t> by_offset(std::span<const StoredLevel> levels, std::uint64_t first,
                                     const std::string& path) {
  std::vector<std::uint32_t> order(levels.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, {}, [&](std::uint32_t level) { return levels[level].offset; });
  std::uint64_t end = first;
  for (const std::uint32_t level : order) {
    if (levels[level].offset < end) {
      fail(Exit::bad_input,
           "{}: its KTX2 header is damaged: level {} begins within what is before it", path, level);
    }
    end = levels[level].offset + levels[level].bytes;
  }
  return order;
}

/// All bytes of a file but those of its levels.
std::vector<std::byte> bytes_around(TextureFile& file, const TextureHead& head) {
  std::vector<std::byte> rest;
  std::uint64_t at = 0;
  const auto take = [&](std::uint64_t end) {
    if (end - at > kMaxHeadBytes || rest.size() > kMaxHeadBytes) {
      fail(Exit::bad_input, "{}: has more than {} bytes that are no texels", file.path(),
           kMaxHeadBytes);
    }
    const auto part = file.read(at, static_cast<std::size_t>(end - at));
    rest.insert(rest.end(), part.begin(), part.end());
  };
  for (const std::uint32_t level : by_offset(head.stored, level_at(head.levels), file.path())) {
    take(head.stored[level].offset);
    at = head.stored[level].offset + head.stored[level].bytes;
  }
  take(file.size());
  return rest;
}

/// A head with offsets and sizes of levels set to 0: they differ when it is packed anew.
std::vector<std::byte> without_index(std::vector<std::byte> head, std::uint32_t levels) {
  for (std::uint32_t level = 0; level < levels; ++level) set_level(head, level, {});
  return head;
}

/// A level of all faces.
std::vector<std::byte> level_of(std::span<const Dump> images, const TextureHead& head,
                                std::uint32_t level) {
  const Format format = images.front().info.desc.record.format;
  std::vector<std::byte> bytes(static_cast<std::size_t>(level_bytes(head, level, format)));
  for (const Dump& image : images) {
    if (image.info.place.level != level) continue;
    scatter(image.texels, runs_by_level(head, image.info.place, format), bytes);
  }
  return bytes;
}

}  // namespace

TextureHead read_ktx2_head(TextureFile& file) {
  const std::string& path = file.path();
  if (file.size() < kIdentifier.size() || !is_ktx2(file.read(0, kIdentifier.size()))) {
    fail(Exit::bad_input, "{}: is not a KTX2 file", path);
  }
  const auto start = file.read(0, kIndexBytes);
  TextureHead head = parse(std::span(start).first(kFixedBytes), path);
  const auto index = file.read(0, level_at(head.levels));
  head.stored = stored_levels(index, head.levels);
  const std::uint64_t dfd = word_at(start, kDfdBytes), kvd = word_at(start, kKvdBytes);
  std::string fault;
  if (dfd < 4 || dfd > kMaxHeadBytes) fault = fmt::format("a format descriptor of {} bytes", dfd);
  if (kvd > kMaxHeadBytes) fault = fmt::format("keys and values of {} bytes", kvd);
  if (long_at(start, kSgdBytes) != 0)
    fault = "global data of supercompression, which only BasisLZ has";
  for (const StoredLevel& level : head.stored) {
    if (level.bytes > kMaxImageBytes || level.unpacked > kMaxImageBytes) {
      fault = fmt::format("a level of {} bytes, {} unpacked", level.bytes, level.unpacked);
    } else if (level.bytes > file.size()) {
      fail(Exit::bad_input, "{}: is truncated: a level takes {} bytes, and it has {}", path,
           level.bytes, file.size());
    }
    if (head.scheme == Scheme::none && level.unpacked != level.bytes) {
      fault = fmt::format("a level of {} bytes, {} unpacked, and no supercompression", level.bytes,
                          level.unpacked);
    }
  }
  if (!fault.empty()) fail(Exit::bad_input, "{}: its KTX2 header is damaged: {}", path, fault);
  check_unpacked(head, path);
  const auto descriptor = file.read(word_at(start, kDfdOffset), static_cast<std::size_t>(dfd));
  if (word_at(descriptor, 0) != dfd) {
    fail(Exit::bad_input, "{}: its data format descriptor is damaged: it says {} bytes, not {}",
         path, word_at(descriptor, 0), dfd);
  }
  if (dfd > 12 && (word_at(descriptor, 12) & 0xFF) == kUastc) fail_basis(path, "UASTC");
  if (kvd > 0) {
    const auto entries = file.read(word_at(start, kKvdOffset), static_cast<std::size_t>(kvd));
    head.attributes = read_ktx2_keys(entries, path);
  }
  head.offset = head.stored.front().offset;
  head.bytes = head.stored.front().unpacked;
  return head;
}

void keep_ktx2_head(TextureFile& file, const TextureHead& head, DumpInfo& first) {
  if (head.scheme != Scheme::none) {
    set_attribute(first.attributes, {kKtx2Scheme, "string", std::string(to_string(head.scheme))});
  }
  std::vector<StoredLevel> levels = head.stored;
  auto around = bytes_around(file, head);
  TextureHead own = head;
  own.texels = texels_of(first.desc);
  auto implied = implied_head(own, first, levels, file.path());
  if (head.scheme == Scheme::none) {
    std::uint64_t end = implied.size();
    // What stands between implied levels is zeros that align them.
    for (std::uint32_t level = head.levels; level-- > 0;) {
      implied.resize(implied.size() + static_cast<std::size_t>(levels[level].offset - end));
      end = levels[level].offset + levels[level].bytes;
    }
  } else {
    const auto begin = std::ranges::min(head.stored, {}, &StoredLevel::offset).offset;
    if (around.size() > begin) {
      const auto rest = std::span(around).subspan(static_cast<std::size_t>(begin));
      if (std::ranges::any_of(rest, [](std::byte byte) { return byte != std::byte{0}; })) {
        first.lost.emplace_back("bytes between its levels or behind them");
      }
      around.resize(static_cast<std::size_t>(begin));
    }
    around = without_index(std::move(around), head.levels);
    implied = without_index(std::move(implied), head.levels);
  }
  if (around != implied) set_attribute(first.attributes, bytes_attribute(kKtx2Head, around));
}

namespace {

/// How a file packs its levels: as it was packed, unless the attribute was taken away.
Scheme scheme_of(const DumpInfo& first, const std::string& path) {
  const Attribute* const attribute = find_attribute(first.attributes, kKtx2Scheme);
  if (attribute == nullptr) return Scheme::none;
  const auto known = scheme_from_string(attribute->value);
  if (known && *known != Scheme::basis_lz) return *known;
  fail(Exit::bad_input, "{}: attribute {} is damaged", path, kKtx2Scheme);
}

/// The kept bytes that are no texels, and how their levels were packed; empty: none are kept.
struct KeptHead {
  std::vector<std::byte> bytes;
  TextureHead head;
};

KeptHead kept_head(std::span<const Dump> images, const std::string& path) {
  const Attribute* const attribute = find_attribute(images.front().info.attributes, kKtx2Head);
  if (attribute == nullptr) return {};
  KeptHead kept{attribute_bytes(*attribute, path), {}};
  if (kept.bytes.size() >= kIndexBytes && is_ktx2(kept.bytes)) {
    kept.head = parse(std::span(kept.bytes).first(kFixedBytes), path);
  }
  if (kept.head.texels.x == 0 || kept.bytes.size() < level_at(kept.head.levels)) {
    fail(Exit::bad_input, "{}: attribute {} is damaged", path, kKtx2Head);
  }
  require_fit(kept.head, images, kKtx2Head, path);
  return kept;
}

/// The levels at the places that a kept head says. Throws if they have other sizes.
std::vector<StoredLevel> levels_of(const KeptHead& kept, std::span<const StoredLevel> levels,
                                   const std::string& path) {
  auto stored = stored_levels(kept.bytes, kept.head.levels);
  if (!std::ranges::equal(stored, levels, {}, &StoredLevel::bytes, &StoredLevel::bytes)) {
    fail(Exit::bad_input, "{}: attribute {} is of another texture", path, kKtx2Head);
  }
  return stored;
}

/// A file: levels at their places, `around` them in all other ones, and zeros where that has ended.
std::vector<std::byte> assemble(std::span<const std::vector<std::byte>> data,
                                std::span<const StoredLevel> levels,
                                std::span<const std::byte> around, const std::string& path) {
  std::vector<std::byte> file;
  for (const std::uint32_t level :
       by_offset(levels, level_at(static_cast<std::uint32_t>(levels.size())), path)) {
    const std::size_t gap = static_cast<std::size_t>(levels[level].offset) - file.size();
    constexpr std::size_t kMostZeros = 256;  // They align levels.
    const std::size_t known = std::min(gap, around.size());
    if (gap - known > kMostZeros) {
      fail(Exit::bad_input, "{}: attribute {} is damaged", path, kKtx2Head);
    }
    file.insert(file.end(), around.begin(), around.begin() + static_cast<std::ptrdiff_t>(known));
    file.resize(file.size() + gap - known);
    around = around.subspan(known);
    file.insert(file.end(), data[level].begin(), data[level].end());
  }
  file.insert(file.end(), around.begin(), around.end());
  return file;
}

}  // namespace

std::vector<std::byte> ktx2_file(std::span<const Dump> images, const std::string& path) {
  const DumpInfo& first = images.front().info;
  KeptHead kept = kept_head(images, path);
  TextureHead head = kept.bytes.empty() ? head_of(images, path) : kept.head;
  head.scheme = scheme_of(first, path);
  std::vector<std::vector<std::byte>> data;
  std::vector<StoredLevel> levels;
  for (std::uint32_t level = 0; level < head.levels; ++level) {
    data.push_back(level_of(images, head, level));
    const std::uint64_t unpacked = data.back().size();
    if (head.scheme != Scheme::none) data.back() = pack_level(head.scheme, data.back(), path);
    levels.push_back({0, data.back().size(), unpacked});
  }
  if (kept.bytes.empty()) {
    const auto around = implied_head(head, first, levels, path);
    return assemble(data, levels, around, path);
  }
  if (head.scheme == Scheme::none && kept.head.scheme == Scheme::none) {
    return assemble(data, levels_of(kept, levels, path), kept.bytes, path);
  }
  set_word(kept.bytes, kScheme, static_cast<std::uint32_t>(head.scheme));
  place_levels(levels, kept.bytes.size(), alignment_of(head.scheme, first.desc.record), kept.bytes);
  return assemble(data, levels, kept.bytes, path);
}

}  // namespace gicodec::tools
