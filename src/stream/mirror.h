// The mirror: what a decoder holds of a texture. Records of all blocks, which blocks were received,
// and irregular guard bands.
#pragma once

#include <gicodec/backend.h>
#include <gicodec/isa.h>
#include <gicodec/texture.h>

#include "base/memory.h"
#include "texture/stale_bands.h"
#include "texture/view.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace gicodec {

class Mirror {
 public:
  explicit Mirror(const TextureDesc& desc, Isa isa = best_isa(), const Threads& threads = {});

  [[nodiscard]] const TextureDesc& desc() const noexcept { return desc_; }
  [[nodiscard]] std::span<const std::byte> records() const noexcept { return records_; }
  [[nodiscard]] std::span<const std::uint8_t> received() const noexcept { return received_; }
  [[nodiscard]] BlockTable blocks() const noexcept { return {records_.data(), block_bytes_}; }
  [[nodiscard]] MirrorView view() const noexcept {
    return {blocks(), received_.data(), {presence_.data(), presence_bytes_}};
  }
  /// The band of a block if it is irregular, else empty.
  [[nodiscard]] std::span<const std::byte> stale_band(std::uint32_t block) const noexcept {
    const bool stale = !stale_.empty() && stale_[block] != 0;
    return stale ? std::span(bands_).subspan(block * band_bytes_, band_bytes_)
                 : std::span<const std::byte>();
  }

  /// Allocates memory for irregular bands, if any. Throws bad_alloc; then nothing has changed.
  void make_room(const StaleBands& stale);
  /// Replaces some blocks. `records`: theirs, which are lost: those of all blocks are not copied
  /// but exchanged. `presence`: theirs, unless it is Presence::all. `stale`: their irregular bands.
  /// In a keyframe every other block becomes zero and not received. Then writes blocks that may
  /// have changed to `view`, unless it is null. Cannot fail after make_room().
  void commit(bool keyframe, std::span<const std::uint32_t> blocks, Vector<std::byte>& records,
              std::span<const std::byte> presence, const StaleBands& stale,
              const CheckedView<std::byte>* view = nullptr) noexcept;

  /// Writes block blocks[i] to the place of block places[i] in a texture `to` with blocks of the
  /// same record and shape. Both lists have the same length. Cannot fail.
  void write(std::span<const std::uint32_t> blocks, const TextureDesc& to,
             const CheckedView<std::byte>& view,
             std::span<const std::uint32_t> places) const noexcept;
  void write_all(const CheckedView<std::byte>& view) const noexcept;

 private:
  void write_run(std::uint32_t first, const TextureDesc& to, const CheckedView<std::byte>& view,
                 std::span<const std::uint32_t> places) const noexcept;

  TextureDesc desc_;
  Isa isa_;
  Threads threads_;
  std::size_t block_bytes_, band_bytes_;
  std::size_t presence_bytes_;  ///< kept per block, for bricks only
  Vector<std::byte> records_, presence_;
  Vector<std::uint8_t> received_;
  Vector<std::byte> bands_;     ///< of all blocks; empty until one is irregular
  Vector<std::uint8_t> stale_;  ///< per block, whether its band is in use; likewise
};

}  // namespace gicodec
