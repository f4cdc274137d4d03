#include "record_picture.h"

#include "cli.h"
#include "dump/block_place.h"
#include "dump/sample.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace gicodec::tools {
namespace {

double share_of(const Component& component, std::uint32_t code) {
  if (component.type == ComponentType::sfloat) {
    const auto value = std::bit_cast<float>(to_sample(SampleType::float32, component, code));
    const double shown = std::abs(double{value});
    return std::isfinite(value) ? shown / (1 + shown) : 1;
  }
  const double most = std::exp2(component.bits) - 1;
  if (component.type == ComponentType::snorm) code ^= 1U << (component.bits - 1);
  return code / most;
}

}  // namespace

RecordPicture record_picture_size(const TextureDesc& desc) {
  RecordPicture picture;
  picture.channels = desc.record.count >= 3 ? 3 : 1;
  const std::uint64_t blocks = block_count(desc);
  const std::uint64_t height = std::uint64_t{desc.block.y} * desc.block.z;
  const double side = std::sqrt(static_cast<double>(blocks * desc.block.x * height));
  const auto columns = std::clamp<std::uint64_t>(
      static_cast<std::uint64_t>(std::ceil(side / desc.block.x)), 1, blocks);
  picture.width = columns * desc.block.x;
  picture.height = (blocks + columns - 1) / columns * height;
  return picture;
}

RecordPicture record_picture(const Dump& dump) {
  const TextureDesc& desc = dump.info.desc;
  RecordPicture picture = record_picture_size(desc);
  picture.pixels.resize(picture.width * picture.height * picture.channels);
  const std::uint64_t columns = picture.width / desc.block.x;
  const std::uint64_t height = std::uint64_t{desc.block.y} * desc.block.z;
  const Extent size = extent(desc);
  for (std::uint32_t block = 0; block < block_count(desc); ++block) {
    if (block % 4096 == 0) check_interrupt();
    const BlockPlace place = block_place(desc, size, block);
    const BlockShape inside = block_inside(desc, block);
    for (std::uint64_t i = 0; i < record_count(desc.block); ++i) {
      const std::uint64_t x = i % desc.block.x, y = i / desc.block.x % desc.block.y,
                          z = i / desc.block.x / desc.block.y;
      if (x >= inside.x || y >= inside.y || z >= inside.z) continue;
      const std::byte* const record =
          &dump.texels[place.row(static_cast<std::uint32_t>(y), static_cast<std::uint32_t>(z)) +
                       x * desc.record.bytes];
      const std::uint64_t px = block % columns * desc.block.x + x;
      const std::uint64_t py = block / columns * height + z * desc.block.y + y;
      for (std::uint32_t c = 0; c < picture.channels; ++c) {
        const Component& component = desc.record.components[c];
        picture.pixels[(py * picture.width + px) * picture.channels + c] =
            static_cast<std::uint8_t>(std::lround(
                255 * share_of(component, load_component(record, desc.record.bytes, component))));
      }
    }
  }
  return picture;
}

}  // namespace gicodec::tools
