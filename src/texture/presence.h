// Presence: which records of a block exist (FORMAT.md, "Records, blocks, textures").
#pragma once

#include <gicodec/texture.h>

#include <cstddef>
#include <span>
#include <vector>

namespace gicodec {

/// Bytes of presence per block that decoders keep: for bricks only, since native predicts from the
/// bricks around them.
[[nodiscard]] constexpr std::size_t kept_presence(const TextureDesc& desc) noexcept {
  return desc.presence == Presence::brick ? presence_bytes(desc) : 0;
}

/// Presence of one block, presence_bytes(desc) bytes.
class BlockPresence {
 public:
  BlockPresence(const TextureDesc& desc, std::span<const std::byte> bytes) noexcept;

  /// False if it counts or marks records that the block does not have.
  [[nodiscard]] bool is_sound() const noexcept;
  [[nodiscard]] bool exists(std::uint32_t record) const noexcept;
  /// Number of records that exist.
  [[nodiscard]] std::uint32_t count() const noexcept;

 private:
  Presence kind_;
  std::uint32_t records_, count_ = 0;
  std::uint32_t per_bit_ = 1;  ///< records per bit of the mask
  std::span<const std::byte> bytes_;
};

/// True if the presence of every block is sound. `presence`: block after block.
[[nodiscard]] bool is_sound(const TextureDesc& desc, std::span<const std::byte> presence) noexcept;

/// True if all missing records are zero.
[[nodiscard]] bool is_clear(const TextureDesc& desc, std::span<const std::byte> presence,
                            std::span<const std::byte> block) noexcept;
/// Zeros missing records.
void clear_absent(const TextureDesc& desc, std::span<const std::byte> presence,
                  std::span<std::byte> block) noexcept;
/// Appends the existing records of a block.
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
/// The inverse; missing records become zero. Returns the bytes read from the front of `in`.
/// Precondition: `in` has them.
std::size_t scatter_present(const TextureDesc& desc, std::span<const std::byte> presence,
                            std::span<const std::byte> in, std::span<std::byte> block) noexcept;

}  // namespace gicodec
