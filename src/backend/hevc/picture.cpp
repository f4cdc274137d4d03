#include "backend/hevc/picture.h"

#include "texture/presence.h"
#include "transform/byte_planes.h"
#include "transform/yuv444p16.h"
#include "transform/yuv444p8.h"

#include <algorithm>
#include <cstring>

namespace gicodec::hevc {
namespace {

/// Rows of a tile: a block's slices lie below each other.
std::uint32_t tile_height(const TextureDesc& desc) noexcept {
  return std::uint32_t{desc.block.y} * desc.block.z;
}

// Width of a packed picture in texels, narrow so that small updates stay small.
constexpr std::uint32_t kPackedWidth = 256;
constexpr int kDifferenceOffset = 1024, kChromaOffset = 512;
constexpr int kMaxCode = 1023;

constexpr std::uint32_t side(std::uint64_t samples, std::uint32_t least) noexcept {
  return static_cast<std::uint32_t>(std::max<std::uint64_t>((samples + 7) / 8 * 8, least));
}

std::uint32_t packed_columns(const TextureDesc& desc) noexcept {
  const std::uint32_t columns = std::max(1U, kPackedWidth / desc.block.x);
  return std::min(columns, block_count(desc));
}

// Samples per plane of a row of texels.
std::uint64_t row_samples(const TextureDesc& desc, HevcPacking packing, std::uint64_t texels) {
  const bool cycle = packing == HevcPacking::paper && !is_a2rgb10(desc.record.format);
  return cycle ? yuv444p8_width(texels * desc.record.bytes) : texels;
}

std::size_t tile_of(const FrameShape& shape, std::size_t position, std::uint32_t probe) noexcept {
  if (shape.layout == HevcLayout::packed) return position;
  const std::uint32_t tile = probe % shape.row_tiles;
  const std::uint32_t rows_per_plane = (shape.row_tiles + shape.columns - 1) / shape.columns;
  const std::uint32_t row = probe / shape.row_tiles * rows_per_plane + tile / shape.columns;
  return std::size_t{row} * shape.columns + tile % shape.columns;
}

// Visits the rows of all blocks: visit(offset in blocks, offset in raster, bytes).
template <typename Visit>
void for_each_row(const TextureDesc& desc, const FrameShape& shape,
                  std::span<const std::uint32_t> places, Visit&& visit) noexcept {
  const std::size_t texel = desc.record.bytes;
  const std::size_t row = desc.block.x * texel;
  const std::size_t pitch = shape.width * texel;
  std::size_t from = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::size_t tile = tile_of(shape, i, places[i]);
    std::size_t to = tile / shape.columns * tile_height(desc) * pitch + tile % shape.columns * row;
    for (unsigned y = 0; y < tile_height(desc); ++y, from += row, to += pitch) visit(from, to, row);
  }
}

template <typename Sample, typename Byte>
auto samples_of(std::span<Byte> bytes) noexcept {
  return std::span(reinterpret_cast<Sample*>(bytes.data()), bytes.size() / sizeof(Sample));
}

std::uint16_t code_of(int value) noexcept {
  return static_cast<std::uint16_t>(std::clamp(value, 0, kMaxCode));
}

// R, G, B → G, R−G, B−G in 12 bit; a reversible colour transform.
void decorrelate(const Planes<std::uint16_t>& planes) noexcept {
  for (std::size_t i = 0; i < planes.y.size(); ++i) {
    const int r = planes.y[i], g = planes.u[i], b = planes.v[i];
    planes.y[i] = static_cast<std::uint16_t>(g);
    planes.u[i] = static_cast<std::uint16_t>(r - g + kDifferenceOffset);
    planes.v[i] = static_cast<std::uint16_t>(b - g + kDifferenceOffset);
  }
}
void correlate(const Planes<std::uint16_t>& planes) noexcept {
  for (std::size_t i = 0; i < planes.y.size(); ++i) {
    const int g = planes.y[i];
    planes.y[i] = code_of(g + planes.u[i] - kDifferenceOffset);
    planes.u[i] = code_of(g);
    planes.v[i] = code_of(g + planes.v[i] - kDifferenceOffset);
  }
}

// R, G, B ↔ luma (R + 2G + B) / 4 and chroma (R − B) / 2, (2G − R − B) / 4, each rounded to 10
// bits.
void to_luma(const Planes<std::uint16_t>& planes) noexcept {
  for (std::size_t i = 0; i < planes.y.size(); ++i) {
    const int r = planes.y[i], g = planes.u[i], b = planes.v[i];
    planes.y[i] = code_of((r + 2 * g + b + 2) >> 2);
    planes.u[i] = code_of(((r - b + 1) >> 1) + kChromaOffset);
    planes.v[i] = code_of(((2 * g - r - b + 2) >> 2) + kChromaOffset);
  }
}
void from_luma(const Planes<std::uint16_t>& planes) noexcept {
  for (std::size_t i = 0; i < planes.y.size(); ++i) {
    const int y = planes.y[i], co = planes.u[i] - kChromaOffset, cg = planes.v[i] - kChromaOffset;
    planes.y[i] = code_of(y - cg + co);
    planes.u[i] = code_of(y + cg);
    planes.v[i] = code_of(y - cg - co);
  }
}

Planes<std::uint16_t> colour_planes(const FrameShape& shape, Picture& picture) noexcept {
  const std::size_t count = std::size_t{shape.width} * shape.height;
  const auto plane = [&](std::size_t i) {
    return samples_of<std::uint16_t>(picture.plane(i)).first(count);
  };
  return {plane(0), plane(1), plane(2)};
}

void colour_to_picture(Isa isa, Format format, const FrameShape& shape,
                       std::span<const std::byte> raster, Picture& picture) {
  const auto planes = colour_planes(shape, picture);
  to_yuv444p16(isa, format, SampleAlignment::low, raster, planes);
  if (shape.packing == HevcPacking::planes) decorrelate(planes);
  if (shape.packing == HevcPacking::luma) to_luma(planes);
}

void picture_to_colour(Isa isa, Format format, const FrameShape& shape, Picture& picture,
                       std::span<std::byte> raster) {
  const auto planes = colour_planes(shape, picture);
  if (shape.packing == HevcPacking::planes) correlate(planes);
  if (shape.packing == HevcPacking::luma) from_luma(planes);
  // Codes have no more than 10 bits here: those of the paper's planes by their bit depth.
  static_cast<void>(
      from_yuv444p16(isa, format, SampleAlignment::low, {planes.y, planes.u, planes.v}, raster));
}

}  // namespace

std::uint8_t size_class_of(const TextureDesc& desc, std::size_t blocks) noexcept {
  std::uint8_t size_class = 0;
  while ((std::size_t{packed_columns(desc)} << size_class) < blocks) ++size_class;
  return size_class;
}

Result<FrameShape> frame_shape(const TextureDesc& desc, HevcPacking packing, HevcLayout layout,
                               std::uint8_t size_class) noexcept {
  FrameShape shape;
  shape.packing = packing;
  shape.layout = layout;
  shape.size_class = size_class;
  const bool colour = is_a2rgb10(desc.record.format);
  // Where blocks continue each other, rows of them stand below one another.
  const std::uint64_t plane_tiles =
      desc.model == Model::continuous ? desc.grid.x : std::uint64_t{desc.grid.x} * desc.grid.y;
  std::uint64_t rows = 0;
  if (layout == HevcLayout::packed) {
    if (size_class > size_class_of(desc, block_count(desc))) return Status::corrupt;
    shape.columns = packed_columns(desc);
    rows = std::uint64_t{1} << size_class;
  } else {
    if (size_class != 0) return Status::corrupt;
    const std::uint64_t most = kMaxAtlasWidth / row_samples(desc, packing, desc.block.x);
    shape.columns = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(most, 1, plane_tiles));
    shape.row_tiles = static_cast<std::uint32_t>(plane_tiles);
    rows = block_count(desc) / plane_tiles * ((plane_tiles + shape.columns - 1) / shape.columns);
  }
  const std::uint64_t stacked = packing == HevcPacking::planes && !colour ? desc.record.bytes : 1;
  if (rows * tile_height(desc) * stacked > kMaxHeight) return Status::limit_exceeded;
  shape.rows = static_cast<std::uint32_t>(rows);
  shape.width = shape.columns * desc.block.x;
  shape.height = shape.rows * tile_height(desc);
  shape.picture.width = side(row_samples(desc, packing, shape.width), kMinWidth);
  shape.picture.height = side(shape.height * stacked, kMinHeight);
  shape.picture.bit_depth = !colour ? 8 : packing == HevcPacking::planes ? 12 : 10;
  shape.picture.monochrome = stacked > 1;
  if (std::uint64_t{shape.picture.width} * shape.picture.height > kMaxSamples) {
    return Status::limit_exceeded;
  }
  // A texel is a sample, so rows of the raster are rows of the picture.
  if (colour || shape.picture.monochrome) shape.width = shape.picture.width;
  return shape;
}

std::size_t raster_bytes(const TextureDesc& desc, const FrameShape& shape) noexcept {
  return std::size_t{shape.width} * shape.height * desc.record.bytes;
}

void blocks_to_raster(const TextureDesc& desc, const FrameShape& shape,
                      std::span<const std::uint32_t> places, std::span<const std::byte> blocks,
                      std::span<std::byte> raster) noexcept {
  for_each_row(desc, shape, places, [&](std::size_t block, std::size_t place, std::size_t bytes) {
    std::memcpy(&raster[place], &blocks[block], bytes);
  });
}

void raster_to_blocks(const TextureDesc& desc, const FrameShape& shape,
                      std::span<const std::uint32_t> places, std::span<const std::byte> raster,
                      std::span<std::byte> blocks) noexcept {
  for_each_row(desc, shape, places, [&](std::size_t block, std::size_t place, std::size_t bytes) {
    std::memcpy(&blocks[block], &raster[place], bytes);
  });
}

namespace {

/// visit(block's records, its presence).
template <typename Visit>
void for_each_block(const TextureDesc& desc, std::span<const std::byte> presence,
                    std::span<std::byte> blocks, const Visit& visit) noexcept {
  const std::size_t bytes = block_bytes(desc), of_presence = presence_bytes(desc);
  if (of_presence == 0) return;
  for (std::size_t at = 0, from = 0; at < blocks.size(); at += bytes, from += of_presence) {
    visit(blocks.subspan(at, bytes), presence.subspan(from, of_presence));
  }
}

}  // namespace

void fill_absent(const TextureDesc& desc, std::span<const std::byte> presence,
                 std::span<std::byte> blocks) noexcept {
  const std::size_t bytes = desc.record.bytes;
  const std::byte* last = nullptr;
  for_each_block(desc, presence, blocks, [&](auto block, auto bits) {
    const BlockPresence present(desc, bits);
    for (std::uint32_t r = 0; r < record_count(desc.block); ++r) {
      std::byte* const record = &block[r * bytes];
      if (present.exists(r)) {
        last = record;
      } else if (last != nullptr) {
        std::memcpy(record, last, bytes);
      }
    }
  });
}

void clear_all_absent(const TextureDesc& desc, std::span<const std::byte> presence,
                      std::span<std::byte> blocks) noexcept {
  for_each_block(desc, presence, blocks,
                 [&](auto block, auto bits) { clear_absent(desc, bits, block); });
}

void raster_to_picture(Isa isa, const TextureDesc& desc, const FrameShape& shape,
                       std::span<const std::byte> raster, Picture& picture) {
  if (picture.format != shape.picture) picture.reset(shape.picture);
  if (is_a2rgb10(desc.record.format))
    return colour_to_picture(isa, desc.record.format, shape, raster, picture);
  if (shape.picture.monochrome) {
    return to_byte_planes(isa, desc.record, raster, {}, picture.plane(0).first(raster.size()));
  }
  const std::size_t row = shape.width * std::size_t{desc.record.bytes};
  const std::size_t samples = yuv444p8_width(row);
  for (std::size_t y = 0; y < shape.height; ++y) {
    const auto part = [&](std::size_t i) {
      return samples_of<std::uint8_t>(picture.plane(i)).subspan(y * shape.picture.width, samples);
    };
    to_yuv444p8(isa, raster.subspan(y * row, row), {part(0), part(1), part(2)});
  }
}

void picture_to_raster(Isa isa, const TextureDesc& desc, const FrameShape& shape, Picture& picture,
                       std::span<std::byte> raster) {
  if (is_a2rgb10(desc.record.format))
    return picture_to_colour(isa, desc.record.format, shape, picture, raster);
  if (shape.picture.monochrome) {
    return from_byte_planes(isa, desc.record, picture.plane(0).first(raster.size()), {}, raster);
  }
  const std::size_t row = shape.width * std::size_t{desc.record.bytes};
  const std::size_t samples = yuv444p8_width(row);
  for (std::size_t y = 0; y < shape.height; ++y) {
    const auto part = [&](std::size_t i) {
      return samples_of<std::uint8_t>(picture.plane(i)).subspan(y * shape.picture.width, samples);
    };
    // Padding may hold anything: the hash covers all texels.
    static_cast<void>(
        from_yuv444p8(isa, {part(0), part(1), part(2)}, raster.subspan(y * row, row)));
  }
}

}  // namespace gicodec::hevc
