// Irregular guard bands, which are coded.
#pragma once

#include "base/memory.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace gicodec {

/// Bands of some blocks, ascending, side by side.
class StaleBands {
 public:
  /// Preconditions: `block` is above all added before; all bands have the same size.
  void add(std::uint32_t block, std::span<const std::byte> band) {
    blocks_.push_back(block);
    band_bytes_ = band.size();
    bytes_.insert(bytes_.end(), band.begin(), band.end());
  }
  /// Replaces all by bands of zeros for these blocks.
  void assign(std::span<const std::uint32_t> blocks, std::size_t band_bytes) {
    bytes_.assign(blocks.size() * band_bytes, std::byte{0});
    blocks_.assign(blocks.begin(), blocks.end());
    band_bytes_ = band_bytes;
  }
  void clear() noexcept {
    blocks_.clear();
    bytes_.clear();
  }

  [[nodiscard]] bool empty() const noexcept { return blocks_.empty(); }
  [[nodiscard]] std::size_t size() const noexcept { return blocks_.size(); }
  [[nodiscard]] std::span<const std::uint32_t> blocks() const noexcept { return blocks_; }
  [[nodiscard]] std::span<std::byte> bytes() noexcept { return bytes_; }
  [[nodiscard]] std::span<std::byte> band(std::size_t i) noexcept {
    return std::span(bytes_).subspan(i * band_bytes_, band_bytes_);
  }
  [[nodiscard]] std::span<const std::byte> band(std::size_t i) const noexcept {
    return std::span(bytes_).subspan(i * band_bytes_, band_bytes_);
  }
  /// The band of a block; empty if it has none.
  [[nodiscard]] std::span<const std::byte> find(std::uint32_t block) const noexcept {
    const auto it = std::lower_bound(blocks_.begin(), blocks_.end(), block);
    if (it == blocks_.end() || *it != block) return {};
    return band(static_cast<std::size_t>(it - blocks_.begin()));
  }
  friend bool operator==(const StaleBands&, const StaleBands&) = default;

 private:
  Vector<std::uint32_t> blocks_;
  Vector<std::byte> bytes_;
  std::size_t band_bytes_ = 0;
};

}  // namespace gicodec
