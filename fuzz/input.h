// What the fuzz targets share: taking values from the input, exactly sized buffers, failing loudly.
#pragma once

#include <gicodec/backend.h>
#include <gicodec/decoder.h>
#include <gicodec/encoder.h>
#include <gicodec/probes.h>

#include "base/checksum.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <span>
#include <vector>

namespace gicodec::fuzz {

/// A broken promise of the library is a crash for the fuzzer.
inline void check(bool kept, const char* promise) {
  if (kept) return;
  std::fprintf(stderr, "broken: %s\n", promise);
  std::abort();
}

/// Fills what is to be overwritten. The two patterns differ in every byte, so that a byte that is
/// not written, or depends on what stood there, differs after doing the same with both.
inline void soil(std::span<std::byte> bytes, unsigned pattern) {
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = std::byte(i * 151 + 77) ^ (pattern % 2 == 0 ? std::byte{0} : std::byte{0xFF});
  }
}

/// Bytes in a heap block of just their size, so that AddressSanitizer sees every step beyond.
class Exact {
 public:
  explicit Exact(std::size_t size, unsigned pattern = 0) : data_(new std::byte[size]), size_(size) {
    soil(span(), pattern);
  }
  explicit Exact(std::span<const std::byte> bytes)
      : data_(new std::byte[bytes.size()]), size_(bytes.size()) {
    std::ranges::copy(bytes, data_.get());
  }
  [[nodiscard]] std::span<std::byte> span() { return {data_.get(), size_}; }

 private:
  std::unique_ptr<std::byte[]> data_;
  std::size_t size_;
};

inline bool same(std::span<const std::byte> a, std::span<const std::byte> b) {
  return std::ranges::equal(a, b);
}

/// One of several parts of an input: two bytes with its size and two flags, then its bytes.
struct Part {
  std::span<const std::byte> bytes;
  unsigned flags = 0;
};
inline constexpr std::uint32_t kMaxPart = 0x3FFF;

/// By a number; the first ones are those that the corpora were grown with.
inline std::vector<Format> presets() {
  std::vector<Format> all{Format::R8G8B8A8_UNORM,
                          Format::A2R10G10B10_UNORM_PACK32,
                          Format::A2B10G10R10_UNORM_PACK32,
                          Format::R16_SFLOAT,
                          Format::R16G16_SFLOAT,
                          Format::R16G16B16A16_SFLOAT,
                          Format::R32_SFLOAT,
                          Format::R32G32_SFLOAT,
                          Format::R32G32B32A32_SFLOAT,
                          Format::B10G11R11_UFLOAT_PACK32,
                          Format::E5B9G9R9_UFLOAT_PACK32};
  for (const FormatInfo& info : formats()) {
    if (std::ranges::find(all, info.record.format) == all.end()) all.push_back(info.record.format);
  }
  return all;
}
inline Record preset(std::size_t number) {
  static const std::vector<Format> all = presets();
  return all[number % all.size()];
}

/// Values from the front of the input; zeros when it is used up.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size)
      : rest_(reinterpret_cast<const std::byte*>(data), size) {}
  explicit Input(std::span<const std::byte> bytes) : rest_(bytes) {}

  [[nodiscard]] bool empty() const { return rest_.empty(); }
  std::uint8_t byte() {
    if (rest_.empty()) return 0;
    const auto value = std::to_integer<std::uint8_t>(rest_[0]);
    rest_ = rest_.subspan(1);
    return value;
  }
  /// 0..limit - 1.
  std::uint32_t below(std::uint32_t limit) { return byte() % limit; }
  std::uint32_t u16() {
    const std::uint32_t low = byte();
    return low | std::uint32_t{byte()} << 8;
  }
  std::span<const std::byte> bytes(std::size_t size) {
    const auto taken = rest_.first(std::min(size, rest_.size()));
    rest_ = rest_.subspan(taken.size());
    return taken;
  }
  std::span<const std::byte> rest() { return bytes(rest_.size()); }
  Part part() {
    const auto head = u16();
    return {bytes(head & kMaxPart), head >> 14};
  }

  /// Six bytes: probes of any format, with or without guard band, in any tiling; many of them or
  /// large blocks, not both.
  TextureDesc desc() {
    const std::array head{byte(), byte(), byte(), byte(), byte(), byte()};
    return probes_of(head);
  }
  /// Six bytes: probes as above, or blocks of any shape on a grid or in a pool, of records of the
  /// application's own, in any layout, where not every record need exist, or that are sets.
  TextureDesc any_desc() {
    const std::array head{byte(), byte(), byte(), byte(), byte(), byte()};
    return head[0] < 192 ? probes_of(head) : general(head);
  }
  /// A byte: a preset, or a record of the application's own.
  Record record() {
    const std::uint8_t choice = byte();
    return choice < 128 ? preset(choice)
                        : plain_record(static_cast<std::uint8_t>(1 + choice % kMaxRecordBytes));
  }
  /// For every block of a texture, bytes over and over that say which records exist.
  std::vector<std::byte> presence(const TextureDesc& desc) {
    const std::size_t size = presence_bytes(desc);
    std::vector<std::byte> all(size * block_count(desc));
    if (all.empty()) return all;
    const auto pattern = bytes(below(16));
    const std::uint32_t records = record_count(desc.block);
    for (std::size_t i = 0; i < all.size(); ++i) {
      all[i] = pattern.empty() ? std::byte{0xFF} : pattern[i % pattern.size()];
    }
    for (std::uint32_t block = 0; block < block_count(desc); ++block) {
      std::byte* const one = all.data() + block * size;
      if (desc.presence == Presence::count) {
        const auto low = std::to_integer<std::uint32_t>(one[0]);
        const std::uint32_t count =
            (low | std::to_integer<std::uint32_t>(one[1]) << 8) % (records + 1);
        one[0] = static_cast<std::byte>(count & 255);
        one[1] = static_cast<std::byte>(count >> 8);
      } else if (desc.presence == Presence::brick) {
        // A few places, so that there are neighbours and parents.
        for (std::size_t i = 1; i < 7; ++i) one[i] = std::byte{0};
        one[0] &= std::byte{0x3F};
        one[7] &= std::byte{3};
      } else if (records % 8 != 0) {
        one[size - 1] &= static_cast<std::byte>((1U << records % 8) - 1);
      }
    }
    return all;
  }
  /// Blocks of a texture, ascending: all, the last ones, a mask, or a mask that repeats.
  std::vector<std::uint32_t> blocks(const TextureDesc& desc) {
    const std::uint32_t count = block_count(desc), kind = below(4);
    const auto last = kind == 1 ? u16() % (count + 1) : count;
    const auto mask = bytes(kind == 0 || kind == 1 ? 0 : kind == 2 ? (count + 7) / 8 : 2);
    std::vector<std::uint32_t> blocks;
    for (std::uint32_t block = count - last; block < count; ++block) {
      const std::size_t at = kind == 3 && !mask.empty() ? block / 8 % mask.size() : block / 8;
      const bool in =
          kind < 2 || (at < mask.size() && (mask[at] >> block % 8 & std::byte{1}) != std::byte{0});
      if (in) blocks.push_back(block);
    }
    return blocks;
  }

 private:
  static constexpr std::size_t kMaxBytes = 1 << 13;  ///< of a texture, without guard bands
  using Head = std::array<std::uint8_t, 6>;

  static TextureDesc probes_of(const Head& head) {
    const auto side = static_cast<std::uint8_t>(1 + head[5] % kMaxBlockSide);
    TextureDesc desc =
        probe_texture(preset(head[0]), {1U + head[1] % 12U, 1U + head[2] % 8U, 1U + head[3] % 8U},
                      side, head[4] & 1, static_cast<Tiling>((head[4] >> 1) % kTilingCount));
    while (desc.block.x > 1 && block_bytes(desc) * block_count(desc) > kMaxBytes) {
      --desc.block.x;
      --desc.block.y;
    }
    return desc;
  }
  /// Bytes of the record as components of eight bits, or as words where those were too many.
  static Record plain_record(std::uint8_t bytes) {
    Record record;
    record.bytes = bytes;
    const unsigned step = bytes > kMaxComponents ? 32 : 8;
    for (unsigned bit = 0; bit < bytes * 8U; bit += step) {
      const char name = static_cast<char>('a' + record.count);
      record.components[record.count++] = {
          std::string_view(&name, 1), static_cast<std::uint16_t>(bit),
          static_cast<std::uint8_t>(std::min(step, bytes * 8U - bit)), ComponentType::opaque};
    }
    return record;
  }
  static TextureDesc general(const Head& head) {
    constexpr std::array<std::uint8_t, 8> kSizes{1, 2, 3, 5, 12, 16, 33, 64};
    TextureDesc desc;
    const bool continuous = (head[4] & 1) == 0 && (head[3] & 16) != 0;
    if (continuous) desc.model = Model::continuous;
    // Continuous textures have the first presets, which are no compressed blocks.
    desc.record = (head[0] & 1) != 0 ? plain_record(kSizes[head[0] / 2U % kSizes.size()])
                                     : preset(head[0] / 2U - (continuous ? 96U : 0U));
    desc.grid = {1U + head[1] % 12U, 1U + head[2] % 8U, 1U + head[3] % 8U};
    desc.block = {static_cast<std::uint8_t>(1 + head[5] % 8),
                  static_cast<std::uint8_t>(1 + head[5] / 8 % 8),
                  static_cast<std::uint8_t>(1 + head[5] / 64)};
    desc.presence = static_cast<Presence>(head[4] / 16 % 3);
    desc.layout = static_cast<Tiling>((head[4] >> 1) % kTilingCount);
    while (desc.block.x > 1 && block_bytes(desc) * block_count(desc) > kMaxBytes) --desc.block.x;
    if ((head[4] & 1) != 0) {
      desc.space = Space::pool;
      desc.model = Model::none;
      desc.grid = {block_count(desc), 1, 1};
      if (head[2] >= 128) desc.layout.slots = {3, desc.grid.x / 6 + 1, 2};
      if ((head[3] & 32) != 0 && desc.presence != Presence::mask) {
        desc.model = Model::unordered;
      } else if ((head[3] & 16) != 0) {
        if ((head[0] & 1) == 0) {
          desc.record =
              (head[0] & 2) != 0 ? Format::E5B9G9R9_UFLOAT_PACK32 : Format::R16G16B16A16_SFLOAT;
        }
        desc.block = {2 * kVoxelDirections, 2, 2};
        while (desc.grid.x > 1 && block_bytes(desc) * block_count(desc) > kMaxBytes) {
          --desc.grid.x;
        }
        desc.layout.slots = {};
        desc.presence = Presence::brick;
        desc.model = Model::octree;
      }
    } else if (head[1] >= 128) {
      const auto cut = [](std::uint32_t blocks, std::uint8_t side) {
        return blocks * side - side / 2U;
      };
      desc.records = {cut(desc.grid.x, desc.block.x), cut(desc.grid.y, desc.block.y),
                      cut(desc.grid.z, desc.block.z)};
      return desc;
    }
    if ((head[4] & 1) == 0 && (head[3] & 32) != 0) {
      desc.record = colored_direction((head[0] & 1) != 0);
      desc.block = {6, 1, 1};
      desc.presence = Presence::all;
      desc.model = Model::hemispheres;
      while (desc.grid.x > 1 && block_bytes(desc) * block_count(desc) > kMaxBytes) --desc.grid.x;
    }
    desc.layout.pad_before = head[3] >> 6 & 1;
    desc.layout.pad_after = head[3] >> 7;
    return desc;
  }

  std::span<const std::byte> rest_;
};

/// The six bytes that give this description back; which has to be one of desc().
inline void put_desc(const TextureDesc& desc, std::vector<std::byte>& out) {
  const auto all = presets();
  const auto format = std::ranges::find(all, desc.record.format);
  const auto put = [&](std::size_t value) { out.push_back(static_cast<std::byte>(value)); };
  put(static_cast<std::size_t>(format - all.begin()));
  put(desc.grid.x - 1);
  put(desc.grid.y - 1);
  put(desc.grid.z - 1);
  put(static_cast<std::size_t>(desc.guard_band) | static_cast<std::size_t>(desc.layout.tiling)
                                                      << 1);
  put(desc.block.x - 1U);
}
/// The bytes that give these blocks back.
inline void put_blocks(const TextureDesc& desc, std::span<const std::uint32_t> blocks,
                       std::vector<std::byte>& out) {
  out.push_back(std::byte{2});
  const std::size_t mask = out.size();
  out.resize(mask + (block_count(desc) + 7) / 8);
  for (const auto block : blocks) out[mask + block / 8] |= std::byte{1} << block % 8;
}
inline void put_part(std::span<const std::byte> bytes, unsigned flags,
                     std::vector<std::byte>& out) {
  const std::size_t head = bytes.size() | static_cast<std::size_t>(flags) << 14;
  out.push_back(static_cast<std::byte>(head));
  out.push_back(static_cast<std::byte>(head >> 8));
  out.insert(out.end(), bytes.begin(), bytes.end());
}

/// Copies the records of some blocks out of those of all, and back.
inline void gather(const TextureDesc& desc, std::span<const std::uint32_t> blocks,
                   std::span<const std::byte> all, std::span<std::byte> out) {
  const std::size_t size = block_bytes(desc);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    std::memcpy(&out[i * size], &all[blocks[i] * size], size);
  }
}
inline void scatter(const TextureDesc& desc, std::span<const std::uint32_t> blocks,
                    std::span<const std::byte> texels, std::span<std::byte> all) {
  const std::size_t size = block_bytes(desc);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    std::memcpy(&all[blocks[i] * size], &texels[i * size], size);
  }
}

/// Puts the right checksum at the end of a packet or record, so that mutations get past it.
inline void reseal(std::span<std::byte> bytes) {
  if (bytes.size() < 4) return;
  const std::uint32_t sum = checksum(bytes.first(bytes.size() - 4));
  std::memcpy(bytes.data() + bytes.size() - 4, &sum, sizeof sum);
}

/// Whether a message is a Subscribe. Its mask is read, of as many blocks as it says, by whoever
/// receives it, a client too, which has no use for it.
inline bool is_subscribe(std::span<const std::byte> message) {
  constexpr std::byte kType{5};
  return !message.empty() && message[0] == kType;
}

/// Everything a session holds, tightly packed; zero what belongs to no record.
template <typename Session>
std::vector<std::byte> contents(const Session& session) {
  const TextureDesc& desc = session.desc();
  const auto size = static_cast<std::size_t>(texture_bytes(desc));
  std::vector<std::byte> records(size), again(size);
  soil(records, 0);
  soil(again, 1);
  check(session.read(TextureView{records}) == Status::ok, "read() fills a tight view");
  check(session.read(TextureView{again}) == Status::ok, "read() fills a tight view");
  const bool whole = desc.layout.pad_before + desc.layout.pad_after == 0 &&
                     desc.records == Grid{} && desc.layout.slots == Grid{};
  if (whole) check(records == again, "read() writes every record");
  for (std::size_t i = 0; i < size; ++i) {
    if (records[i] != again[i]) records[i] = std::byte{0};
  }
  return records;
}

}  // namespace gicodec::fuzz
