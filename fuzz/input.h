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

/// Bytes in a heap block of just their size, so that AddressSanitizer sees every step beyond.
class Exact {
 public:
  explicit Exact(std::size_t size) : data_(new std::byte[size]()), size_(size) {}
  explicit Exact(std::span<const std::byte> bytes) : Exact(bytes.size()) {
    std::ranges::copy(bytes, data_.get());
  }
  [[nodiscard]] std::span<std::byte> span() { return {data_.get(), size_}; }

 private:
  std::unique_ptr<std::byte[]> data_;
  std::size_t size_;
};

/// Values from the front of the input; zeros when it is used up.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size)
      : rest_(reinterpret_cast<const std::byte*>(data), size) {}

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

  /// Six bytes: a small texture of any format, border and tiling.
  TextureDesc desc() {
    TextureDesc desc;
    desc.format = formats()[below(static_cast<std::uint32_t>(formats().size()))].format;
    desc.grid = {1 + below(5), 1 + below(4), 1 + below(3)};
    const auto shape = byte();
    desc.border = shape & 1;
    desc.core = static_cast<std::uint16_t>(1 + (shape >> 1) % 17);
    desc.tiling = static_cast<Tiling>(below(kTilingCount));
    return desc;
  }

 private:
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
  put(static_cast<std::size_t>(desc.border) | static_cast<std::size_t>(desc.core - 1) << 1);
  put(static_cast<std::size_t>(desc.tiling));
}

/// Puts the right checksum at the end of a packet or record, so that mutations get past it.
inline void reseal(std::span<std::byte> bytes) {
  if (bytes.size() < 4) return;
  const std::uint32_t sum = checksum(bytes.first(bytes.size() - 4));
  std::memcpy(bytes.data() + bytes.size() - 4, &sum, sizeof sum);
}

/// Everything a session holds, tightly packed.
template <typename Session>
std::vector<std::byte> contents(const Session& session) {
  std::vector<std::byte> texels(texture_bytes(session.desc()));
  check(session.read(TextureView{texels}) == Status::ok, "read() fills a tight view");
  return texels;
}

}  // namespace gicodec::fuzz
