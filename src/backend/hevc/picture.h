// Texels ↔ planes of an HEVC picture. A frame is a raster of tiles, one block each; the packing
// defines how the raster's texels become samples.
#pragma once

#include <gicodec/hevc.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gicodec::hevc {

/// The format that the sequence parameter set must have.
struct PictureFormat {
  std::uint32_t width = 0, height = 0;  ///< multiples of 8, at least kMinWidth × kMinHeight
  std::uint8_t bit_depth = 8;           ///< 8, 10 or 12; above 8 a sample takes two bytes
  bool monochrome = false;              ///< 4:0:0 instead of 4:4:4

  [[nodiscard]] constexpr std::size_t planes() const noexcept { return monochrome ? 1 : 3; }
  [[nodiscard]] constexpr std::size_t sample_bytes() const noexcept {
    return bit_depth > 8 ? 2 : 1;
  }
  [[nodiscard]] constexpr std::size_t row_bytes() const noexcept { return width * sample_bytes(); }
  [[nodiscard]] constexpr std::size_t plane_bytes() const noexcept { return row_bytes() * height; }
  friend constexpr bool operator==(const PictureFormat&, const PictureFormat&) = default;
};

// x265 needs at least one coding tree unit. In pictures one unit wide, x265 3.5 uses other
// references than a decoder.
inline constexpr std::uint32_t kMinCodingTree = 16, kMaxCodingTree = 32;
inline constexpr std::uint32_t kMinWidth = 2 * kMinCodingTree, kMinHeight = kMinCodingTree;
inline constexpr std::uint32_t kMaxAtlasWidth = 8192;
inline constexpr std::uint32_t kMaxHeight = 16384;
inline constexpr std::uint64_t kMaxSamples = std::uint64_t{1} << 26;  ///< of one plane

struct Picture {
  PictureFormat format;
  std::vector<std::byte> samples;  ///< plane after plane, rows tightly packed

  void reset(const PictureFormat& new_format) {
    format = new_format;
    samples.assign(format.planes() * format.plane_bytes(), std::byte{0});
  }
  [[nodiscard]] std::span<std::byte> plane(std::size_t index) noexcept {
    return std::span(samples).subspan(index * format.plane_bytes(), format.plane_bytes());
  }
  [[nodiscard]] std::span<const std::byte> plane(std::size_t index) const noexcept {
    return std::span(samples).subspan(index * format.plane_bytes(), format.plane_bytes());
  }
};

/// All that must be the same in a picture and those that refer to it.
struct FrameShape {
  HevcPacking packing{};
  HevcLayout layout{};
  std::uint8_t size_class = 0;          ///< packed: log2 of the tile rows; atlas: 0
  std::uint32_t columns = 0, rows = 0;  ///< tiles
  std::uint32_t row_tiles = 0;          ///< atlas: tiles of a plane or row, wrapped at `columns`
  std::uint32_t width = 0, height = 0;  ///< raster in texels; columns beyond the tiles are zero
  PictureFormat picture;
  friend constexpr bool operator==(const FrameShape&, const FrameShape&) = default;
};

/// Precondition: validate(desc) is ok. limit_exceeded if the picture would be too large; corrupt
/// for a size class larger than all blocks need.
[[nodiscard]] Result<FrameShape> frame_shape(const TextureDesc& desc, HevcPacking packing,
                                             HevcLayout layout, std::uint8_t size_class) noexcept;
/// The smallest size class that holds that many blocks.
[[nodiscard]] std::uint8_t size_class_of(const TextureDesc& desc, std::size_t blocks) noexcept;
[[nodiscard]] std::size_t raster_bytes(const TextureDesc& desc, const FrameShape& shape) noexcept;

/// Copies blocks, one after another in `blocks`, into the tiles of `places`, and back.
void blocks_to_raster(const TextureDesc& desc, const FrameShape& shape,
                      std::span<const std::uint32_t> places, std::span<const std::byte> blocks,
                      std::span<std::byte> raster) noexcept;
void raster_to_blocks(const TextureDesc& desc, const FrameShape& shape,
                      std::span<const std::uint32_t> places, std::span<const std::byte> raster,
                      std::span<std::byte> blocks) noexcept;

/// Records of some blocks that do not exist: like the ones before, so that they cost little; and
/// the other way round, zero.
void fill_absent(const TextureDesc& desc, std::span<const std::byte> presence,
                 std::span<std::byte> blocks) noexcept;
void clear_all_absent(const TextureDesc& desc, std::span<const std::byte> presence,
                      std::span<std::byte> blocks) noexcept;

/// The alpha bits of the 10-bit formats do not get into the picture and come back as zero. Samples
/// that no raster leads to (lossy or damaged ones) are clamped. picture_to_raster works in place
/// and leaves the picture unspecified.
void raster_to_picture(Isa isa, const TextureDesc& desc, const FrameShape& shape,
                       std::span<const std::byte> raster, Picture& picture);
void picture_to_raster(Isa isa, const TextureDesc& desc, const FrameShape& shape, Picture& picture,
                       std::span<std::byte> raster);

}  // namespace gicodec::hevc
