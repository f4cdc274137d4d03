// What native_fast.gic and native_strong.gic hold: fields that are smooth in space and time with
// noise and still parts, on grids large enough for full groups, several chunks and adapted tables.
#pragma once

#include "golden/golden.h"

namespace gicodec::golden {

inline constexpr std::uint32_t kNativeFrames = 3;  ///< a keyframe, part of the probes, all of them

/// Each of a volume of its own, since grids differ.
inline std::vector<test::ProbeTexture> native_textures() {
  return {
      {"colour", probe_texture(Format::A2B10G10R10_UNORM_PACK32, {10, 12, 11}, 8)},
      {"visibility", probe_texture(Format::R16G16_SFLOAT, {6, 5, 7}, 12, 1, Tiling::slices_xz_y)},
      {"packed",
       probe_texture(Format::B10G11R11_UFLOAT_PACK32, {5, 4, 6}, 6, 0, Tiling::atlas_xz_y)},
      {"shared", probe_texture(Format::E5B9G9R9_UFLOAT_PACK32, {4, 5, 4}, 7)},
      {"bytes", probe_texture(Format::R8G8B8A8_UNORM, {6, 3, 5}, 8)},
      {"single", probe_texture(Format::R32_SFLOAT, {4, 4, 3}, 5, 0)}};
}

inline std::uint32_t mix(std::uint32_t a, std::uint32_t b) {
  std::uint32_t h = a * 2654435761U ^ (b + 0x9E3779B9U) * 2246822519U;
  h ^= h >> 15;
  h *= 3266489917U;
  return h ^ h >> 13;
}
/// A triangle wave of that period between 0 and period / 2.
inline std::uint32_t wave(std::uint32_t at, std::uint32_t period) {
  const std::uint32_t t = at % period;
  return t < period / 2 ? t : period - t;
}

/// A component's value: 0 to about 1,000 at 10 bits, scaled to the component's bits.
inline std::uint32_t native_component(std::uint32_t frame, const Grid& at, std::uint32_t i,
                                      std::uint32_t j, std::uint32_t c, std::uint32_t bits) {
  const std::uint32_t place = at.x * 41 + at.y * 67 + at.z * 53;
  const std::uint32_t age = (frame + at.x) / 2;  // half of the probes change in a frame
  std::uint32_t v =
      wave(i * 37 + place, 400) + wave(j * 29 + place / 2, 500) + wave(place, 700) / 2;
  v += c * 13 + age * 5;
  if (at.z % 3 == 0) v += mix(place * 64 + i * 8 + j, age * 4 + c) % 5;
  if (i + j > 9 && at.y % 2 != 0) v = 900 + c * 20;  // a flat part
  return bits <= 10 ? v >> (10 - bits) : v << (bits - 10);
}

/// Of a record whose other bits are zero there.
inline void set_component(std::span<std::byte> record, const Component& component,
                          std::uint32_t value) {
  for (std::uint32_t b = 0; b < component.bits; ++b) {
    const std::uint32_t bit = component.offset + b;
    record[bit / 8] |= static_cast<std::byte>((value >> b & 1) << bit % 8);
  }
}

inline void paint_native(test::Texture& texture, std::uint32_t frame) {
  const auto& desc = texture.desc();
  for (std::uint32_t probe = 0; probe < block_count(desc); ++probe) {
    const Grid at = {probe % desc.grid.x, probe / desc.grid.x % desc.grid.y,
                     probe / desc.grid.x / desc.grid.y};
    for (std::uint32_t j = 0; j < desc.block.y; ++j) {
      for (std::uint32_t i = 0; i < desc.block.x; ++i) {
        const auto texel = texture.record(probe, i + desc.guard_band, j + desc.guard_band);
        std::fill(texel.begin(), texel.end(), std::byte{0});
        for (std::uint32_t c = 0; c < desc.record.count; ++c) {
          const Component& component = desc.record.components[c];
          const std::uint32_t value = native_component(frame, at, i, j, c, component.bits);
          set_component(texel, component, value);
        }
      }
    }
    texture.fill_band(probe);
  }
}

/// The probes of frame 1; the others are coded by what changed.
inline std::vector<std::uint32_t> native_selection(const TextureDesc& desc) {
  std::vector<std::uint32_t> probes;
  for (std::uint32_t probe = 0; probe < block_count(desc); ++probe) {
    if (mix(probe, 7) % 5 < 2) probes.push_back(probe);
  }
  return probes;
}

}  // namespace gicodec::golden
