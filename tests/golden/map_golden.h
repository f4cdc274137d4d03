// What maps_fast.gic and maps_strong.gic hold: light maps and 3D textures whose rows reach over
// blocks, and records that repeat from far away.
#pragma once

#include "golden/native_golden.h"

#include <gicodec/textures.h>

namespace gicodec::golden {

inline ContainerDescription maps_description() {
  const auto group_of = [](std::string name, Format format, Grid records) {
    TextureGroup group;
    group.textures = {{std::move(name), map_texture(format, records, {8, 8, 1}), {}, {}}};
    return group;
  };
  const TextureGroup groups[] = {
      group_of("halves", Format::R16G16B16A16_SFLOAT, {72, 37, 1}),
      group_of("packed", Format::B10G11R11_UFLOAT_PACK32, {72, 64, 1}),
      group_of("shared", Format::E5B9G9R9_UFLOAT_PACK32, {57, 72, 1}),
      group_of("floats", Format::R32_SFLOAT, {40, 37, 3}),
      group_of("precise", Format::R32G32_SFLOAT, {33, 40, 2}),
      group_of("repeated", Format::R8G8B8A8_UNORM, {40, 32, 1}),
  };
  ContainerDescription description;
  if (add_volume(description, "maps", *texture_volume(groups)) != Status::ok) return {};
  description.metadata = {{"golden", "maps"}};
  return description;
}

/// A component of the light at a place: charts that are smooth and noisy, and gutters between them.
inline std::uint32_t map_component(std::uint32_t frame, const Grid& at, std::uint32_t c,
                                   std::uint32_t bits) {
  std::uint32_t v = 300 + 2 * wave(at.x * 5 + at.z * 11, 160) + wave(at.y * 7, 240);
  v += c * 9 + frame * (at.y / 8 % 3) * 4;
  v += mix(at.z * 65536 + at.y * 256 + at.x, frame / 2 * 4 + c) % 24;
  if (at.x % 21 > 12 || at.y % 17 > 11) v = 40;
  // Halves and floats: exponents around one half.
  if (bits == 16) return 0x3000 + 3 * v;
  if (bits == 32) return 0x3E000000 + 4096 * v;
  return bits < 9 ? v >> 7 : v >> (11 - bits);
}

/// One of 23 rows of a block, of noise.
inline std::uint32_t repeated_byte(std::uint32_t frame, std::uint32_t block, const Grid& in_block,
                                   std::uint32_t byte) {
  const std::uint32_t row = mix(block * 8 + in_block.y, frame) % 23;
  return mix(row * 32 + in_block.x * 4 + byte, 5) & 255;
}

inline void paint_map(test::Texture& texture, std::uint32_t frame) {
  const TextureDesc& desc = texture.desc();
  const bool repeats = desc.record.format == Format::R8G8B8A8_UNORM;
  const bool precise = desc.record.format == Format::R32G32_SFLOAT;
  for (std::uint32_t block = 0; block < block_count(desc); ++block) {
    const BlockOrigin origin = block_origin(desc, block);
    const BlockShape inside = block_inside(desc, block);
    for (std::uint32_t y = 0; y < inside.y; ++y) {
      for (std::uint32_t x = 0; x < inside.x; ++x) {
        const Grid at{static_cast<std::uint32_t>(origin.x) + x,
                      static_cast<std::uint32_t>(origin.y) + y,
                      static_cast<std::uint32_t>(origin.slice)};
        const auto record = texture.record(block, x, y);
        std::fill(record.begin(), record.end(), std::byte{0});
        std::uint32_t c = 0;
        for (const Component& component : desc.record.used()) {
          std::uint32_t value = repeats ? repeated_byte(frame, block, {x, y, 0}, c)
                                        : map_component(frame, at, c, component.bits);
          // Bits that nothing predicts but the past and the slice before.
          if (precise) value += mix(at.y * 256 + at.x, frame / 2 * 2 + c) % 4096;
          set_component(record, component, value);
          ++c;
        }
      }
    }
  }
}

}  // namespace gicodec::golden
