// What the fuzz targets share: taking values from the input, exactly sized buffers, failing loudly.
#pragma once

#include <gicodec/gicodec.h>

#include "base/checksum.h"

#include <algorithm>
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

  /// Six bytes: a texture of any format, border and tiling; many probes or large blocks, not both.
  TextureDesc desc() {
    TextureDesc desc;
    desc.format = formats()[below(static_cast<std::uint32_t>(formats().size()))].format;
    desc.grid = {1 + below(12), 1 + below(8), 1 + below(8)};
    const auto shape = byte();
    desc.border = shape & 1;
    desc.tiling = static_cast<Tiling>((shape >> 1) % kTilingCount);
    desc.core = static_cast<std::uint16_t>(1 + below(kMaxCore));
    while (desc.core > 1 && core_bytes(desc) * probe_count(desc) > kMaxTexels) --desc.core;
    return desc;
  }
  /// Probes of a texture, ascending: all, the last ones, a mask, or a mask that repeats.
  std::vector<std::uint32_t> probes(const TextureDesc& desc) {
    const std::uint32_t count = probe_count(desc), kind = below(4);
    const auto last = kind == 1 ? u16() % (count + 1) : count;
    const auto mask = bytes(kind == 0 || kind == 1 ? 0 : kind == 2 ? (count + 7) / 8 : 2);
    std::vector<std::uint32_t> probes;
    for (std::uint32_t probe = count - last; probe < count; ++probe) {
      const std::size_t at = kind == 3 && !mask.empty() ? probe / 8 % mask.size() : probe / 8;
      const bool in =
          kind < 2 || (at < mask.size() && (mask[at] >> probe % 8 & std::byte{1}) != std::byte{0});
      if (in) probes.push_back(probe);
    }
    return probes;
  }

 private:
  static constexpr std::size_t kMaxTexels = 1 << 13;  ///< bytes of a texture, without guard bands
  std::span<const std::byte> rest_;
};

/// The six bytes that give this description back; its fields must be in the range of desc().
inline void put_desc(const TextureDesc& desc, std::vector<std::byte>& out) {
  const auto* info = find_format(desc.format);
  const auto put = [&](std::size_t value) { out.push_back(static_cast<std::byte>(value)); };
  put(static_cast<std::size_t>(info - formats().data()));
  put(desc.grid.x - 1);
  put(desc.grid.y - 1);
  put(desc.grid.z - 1);
  put(static_cast<std::size_t>(desc.border) | static_cast<std::size_t>(desc.tiling) << 1);
  put(static_cast<std::size_t>(desc.core - 1));
}
/// The bytes that give these probes back.
inline void put_probes(const TextureDesc& desc, std::span<const std::uint32_t> probes,
                       std::vector<std::byte>& out) {
  out.push_back(std::byte{2});
  const std::size_t mask = out.size();
  out.resize(mask + (probe_count(desc) + 7) / 8);
  for (const auto probe : probes) out[mask + probe / 8] |= std::byte{1} << probe % 8;
}
inline void put_part(std::span<const std::byte> bytes, unsigned flags,
                     std::vector<std::byte>& out) {
  const std::size_t head = bytes.size() | static_cast<std::size_t>(flags) << 14;
  out.push_back(static_cast<std::byte>(head));
  out.push_back(static_cast<std::byte>(head >> 8));
  out.insert(out.end(), bytes.begin(), bytes.end());
}

/// Copies the core texels of some probes out of those of all, and back.
inline void gather(const TextureDesc& desc, std::span<const std::uint32_t> probes,
                   std::span<const std::byte> all, std::span<std::byte> out) {
  const std::size_t size = core_bytes(desc);
  for (std::size_t i = 0; i < probes.size(); ++i) {
    std::memcpy(&out[i * size], &all[probes[i] * size], size);
  }
}
inline void scatter(const TextureDesc& desc, std::span<const std::uint32_t> probes,
                    std::span<const std::byte> texels, std::span<std::byte> all) {
  const std::size_t size = core_bytes(desc);
  for (std::size_t i = 0; i < probes.size(); ++i) {
    std::memcpy(&all[probes[i] * size], &texels[i * size], size);
  }
}

/// Puts the right checksum at the end of a packet or record, so that mutations get past it.
inline void reseal(std::span<std::byte> bytes) {
  if (bytes.size() < 4) return;
  const std::uint32_t sum = checksum(bytes.first(bytes.size() - 4));
  std::memcpy(bytes.data() + bytes.size() - 4, &sum, sizeof sum);
}

/// Whether a message is a Subscribe. Its mask is read, of as many probes as it says, by whoever
/// receives it, a client too, which has no use for it.
inline bool is_subscribe(std::span<const std::byte> message) {
  constexpr std::byte kType{5};
  return !message.empty() && message[0] == kType;
}

/// Everything a session holds, tightly packed.
template <typename Session>
std::vector<std::byte> contents(const Session& session) {
  const auto size = static_cast<std::size_t>(texture_bytes(session.desc()));
  std::vector<std::byte> texels(size), again(size);
  soil(texels, 0);
  soil(again, 1);
  check(session.read(TextureView{texels}) == Status::ok, "read() fills a tight view");
  check(session.read(TextureView{again}) == Status::ok, "read() fills a tight view");
  check(texels == again, "read() writes every texel");
  return texels;
}

}  // namespace gicodec::fuzz
