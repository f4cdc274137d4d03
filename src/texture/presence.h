// Which records of a block exist, as counts and masks say (FORMAT.md, "Records, blocks, textures").
#pragma once

#include <gicodec/texture.h>

#include <cstddef>
#include <span>
#include <vector>

namespace gicodec {

/// Bytes per block that decoders keep of it: of bricks, so that those around others are known.
[[nodiscard]] constexpr std::size_t kept_presence(const TextureDesc& desc) noexcept {
  return desc.presence == Presence::brick ? presence_bytes(desc) : 0;
}

/// Presence of one block, presence_bytes(desc) of it.
class BlockPresence {
 public:
  BlockPresence(const TextureDesc& desc, std::span<const std::byte> bytes) noexcept;

  /// False if it speaks of records that a block does not have.
  [[nodiscard]] bool is_sound() const noexcept;
  [[nodiscard]] bool exists(std::uint32_t record) const noexcept;
  /// Number of records that exist.
  [[nodiscard]] std::uint32_t count() const noexcept;

 private:
  Presence kind_;
  std::uint32_t records_, count_ = 0;
  std::uint32_t per_bit_ = 1;  ///< records that a bit of the mask speaks of
  std::span<const std::byte> bytes_;
};

/// True if that of every block, one after the other, is sound.
[[nodiscard]] bool is_sound(const TextureDesc& desc, std::span<const std::byte> presence) noexcept;

/// True if what does not exist is zero.
[[nodiscard]] bool is_clear(const TextureDesc& desc, std::span<const std::byte> presence,
                            std::span<const std::byte> block) noexcept;
/// Zeros what does not exist.
void clear_absent(const TextureDesc& desc, std::span<const std::byte> presence,
                  std::span<std::byte> block) noexcept;
/// Appends the records of a block that exist.
template <typename Bytes>
void gather_present(const TextureDesc& desc, std::span<const std::byte> presence,
                    std::span<const std::byte> block, Bytes& out) {
  const BlockPresence present(desc, presence);
  const std::size_t size = desc.record.bytes;
  for (std::uint32_t r = 0; r < record_count(desc.block); ++r) {
    if (!present.exists(r)) continue;
    const auto record = block.subspan(r * size, size);
    out.insert(out.end(), record.begin(), record.end());
  }
}
/// The reverse: zeros elsewhere. Returns the bytes taken from the front of `in`, which are there.
std::size_t scatter_present(const TextureDesc& desc, std::span<const std::byte> presence,
                            std::span<const std::byte> in, std::span<std::byte> block) noexcept;

}  // namespace gicodec
