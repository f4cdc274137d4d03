// The texels of a chunk as rows that reach over its blocks (docs/native/continuous.md, "Raster").
#pragma once

#include "base/memory.h"
#include "native/raster/block_box.h"
#include "native/raster/channels.h"

#include <gicodec/backend.h>
#include <gicodec/texture.h>

#include <cstddef>
#include <cstdint>
#include <span>

namespace gicodec::native {

struct Update;

/// Values of all texels that the blocks of a box may have, unless the box is one block.
inline constexpr std::size_t kMaxRasterValues = std::size_t{1} << 20;
/// Whether a box may be a raster.
[[nodiscard]] bool fits_raster(const TextureDesc& desc, const Grid& box) noexcept;
/// The same of row chunks, whose strips have 32 rows with kRowMargin words beside each.
/// 64³ texels of four channels are one.
inline constexpr std::size_t kRowMargin = 72, kMaxRowValues = std::size_t{9} << 18;
[[nodiscard]] bool fits_rows(const TextureDesc& desc, const Grid& box) noexcept;

/// Blocks that a box may have to be one, at least 1.
[[nodiscard]] std::uint32_t blocks_of_raster(const TextureDesc& desc) noexcept;
/// Whether at least a quarter of the least box around the listed blocks is listed: rows code all of
/// it.
[[nodiscard]] bool fills_rows(const Update& u, std::span<const std::uint32_t> positions);
/// What a thread takes at most for a texture's rasters and what is kept of their texels.
[[nodiscard]] std::uint64_t raster_memory(const TextureDesc& desc) noexcept;

/// The texels of the least box of blocks around those that are listed, numbered from 1 on by
/// x, then y, then z. Texel 0 stands for one that does not exist; its ordinals are 0. Memory of one
/// thread, kept for its capacity.
class Raster {
 public:
  /// Before the first texel: what is known of the blocks around, and of the past.
  void lay_out(const Update& u, std::span<const std::uint32_t> positions);
  /// Reads the records of a listed block.
  void load(const Update& u, std::uint32_t position, std::span<const std::byte> records);
  /// Writes those that exist. `texel` may no longer be used.
  void store(const Update& u, std::uint32_t position, std::span<std::byte> records) const;

  [[nodiscard]] const Channels& channels() const { return channels_; }
  [[nodiscard]] const Grid& size() const { return size_; }
  [[nodiscard]] std::size_t texels() const { return coded_.size() - 1; }
  [[nodiscard]] std::size_t coded_texels() const { return coded_texels_; }
  /// Whether the texel is one of the chunk; else it is known to both sides.
  [[nodiscard]] bool coded(std::size_t texel) const { return coded_[texel] != 0; }
  [[nodiscard]] bool has_past() const { return !past_.empty(); }

  /// The ordinals of a texel, by channel: now, and in the mirror.
  [[nodiscard]] std::uint32_t* now(std::size_t texel) {
    return now_.data() + texel * channels_.count;
  }
  [[nodiscard]] const std::uint32_t* now(std::size_t texel) const {
    return now_.data() + texel * channels_.count;
  }
  [[nodiscard]] std::uint32_t* past(std::size_t texel) {
    return past_.data() + texel * channels_.count;
  }
  [[nodiscard]] const std::uint32_t* past(std::size_t texel) const {
    return past_.data() + texel * channels_.count;
  }

 private:
  /// Calls body(record of the block, texel) for every record of a block.
  template <typename Body>
  void for_each_record(const Update& u, std::uint32_t block, const Body& body) const;
  void read(const Update& u, std::uint32_t block, std::span<const std::byte> records,
            const std::uint8_t* wanted);

  Channels channels_;
  BlockBox box_;
  Grid size_;  ///< in texels
  std::size_t coded_texels_ = 0;
  Vector<std::uint8_t> coded_;  ///< by texel
  Vector<std::uint32_t> now_, past_;
};

}  // namespace gicodec::native
