#include "texture/presence.h"

#include <gicodec/voxels.h>

#include "texture/texel.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace gicodec {

BlockPresence::BlockPresence(const TextureDesc& desc, std::span<const std::byte> bytes) noexcept
    : kind_(desc.presence), records_(record_count(desc.block)), bytes_(bytes) {
  if (kind_ == Presence::count) count_ = load<std::uint16_t>(bytes.data());
  if (kind_ == Presence::brick) {
    per_bit_ = kVoxelDirections;
    bytes_ = bytes.subspan(kBrickPlaceBytes);
  }
}

bool BlockPresence::is_sound() const noexcept {
  if (kind_ == Presence::count) return count_ <= records_;
  const std::uint32_t bits = records_ / per_bit_;
  if (kind_ == Presence::all || bits % 8 == 0) return true;
  return std::to_integer<unsigned>(bytes_.back()) >> bits % 8 == 0;
}

bool BlockPresence::exists(std::uint32_t record) const noexcept {
  if (kind_ == Presence::all) return true;
  if (kind_ == Presence::count) return record < count_;
  const std::uint32_t bit = record / per_bit_;
  return (std::to_integer<unsigned>(bytes_[bit / 8]) >> bit % 8 & 1) != 0;
}

std::uint32_t BlockPresence::count() const noexcept {
  if (kind_ == Presence::all) return records_;
  if (kind_ == Presence::count) return std::min(count_, records_);
  std::uint32_t sum = 0;
  for (const std::byte byte : bytes_) {
    sum += static_cast<std::uint32_t>(std::popcount(std::to_integer<std::uint8_t>(byte)));
  }
  return sum * per_bit_;
}

bool is_sound(const TextureDesc& desc, std::span<const std::byte> presence) noexcept {
  const std::size_t size = presence_bytes(desc);
  for (std::size_t at = 0; at < presence.size(); at += size) {
    if (!BlockPresence(desc, presence.subspan(at, size)).is_sound()) return false;
  }
  return true;
}

bool is_clear(const TextureDesc& desc, std::span<const std::byte> presence,
              std::span<const std::byte> block) noexcept {
  const BlockPresence present(desc, presence);
  const std::size_t size = desc.record.bytes;
  for (std::uint32_t r = 0; r < record_count(desc.block); ++r) {
    const auto record = block.subspan(r * size, size);
    if (!present.exists(r) &&
        std::any_of(record.begin(), record.end(), [](std::byte b) { return b != std::byte{0}; })) {
      return false;
    }
  }
  return true;
}

void clear_absent(const TextureDesc& desc, std::span<const std::byte> presence,
                  std::span<std::byte> block) noexcept {
  const BlockPresence present(desc, presence);
  const std::size_t size = desc.record.bytes;
  for (std::uint32_t r = 0; r < record_count(desc.block); ++r) {
    if (!present.exists(r)) std::memset(block.data() + r * size, 0, size);
  }
}

std::size_t scatter_present(const TextureDesc& desc, std::span<const std::byte> presence,
                            std::span<const std::byte> in, std::span<std::byte> block) noexcept {
  const BlockPresence present(desc, presence);
  const std::size_t size = desc.record.bytes;
  std::size_t taken = 0;
  for (std::uint32_t r = 0; r < record_count(desc.block); ++r) {
    if (present.exists(r)) {
      std::memcpy(block.data() + r * size, in.data() + taken, size);
      taken += size;
    } else {
      std::memset(block.data() + r * size, 0, size);
    }
  }
  return taken;
}

}  // namespace gicodec
