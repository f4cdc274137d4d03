#include "volume.h"

#include <gicodec/probes.h>

#include <Imath/half.h>

#include <array>

namespace gicodec::ddgi {
namespace {

constexpr float power5(float x) {
  const float x2 = x * x;
  return x2 * x2 * x;
}

/// Least linear value of each code. A table and multiplications instead of pow(): the same codes
/// with every C library.
const std::array<float, 1024>& thresholds() {
  static const auto table = [] {
    std::array<float, 1024> t{};
    for (std::size_t k = 1; k < t.size(); ++k) {
      t[k] = power5((static_cast<float>(k) - 0.5F) / 1023.0F);
    }
    return t;
  }();
  return table;
}

}  // namespace

Vec3 VolumeShape::position(std::uint32_t probe) const {
  const std::uint32_t y = probe / grid.x % grid.y, z = probe / grid.x / grid.y;
  const Vec3 cell{static_cast<float>(probe % grid.x), static_cast<float>(y), static_cast<float>(z)};
  return origin + cell * spacing;
}

VolumeShape spread(Grid grid, const Box& box) {
  const auto step = [](float size, std::uint32_t n) {
    return n > 1 ? size / static_cast<float>(n - 1) : size;
  };
  const Vec3 size = box.size();
  VolumeShape shape{
      grid, box.lo, {step(size.x, grid.x), step(size.y, grid.y), step(size.z, grid.z)}};
  // A single layer stands in the middle.
  if (grid.x == 1) shape.origin.x += size.x / 2;
  if (grid.y == 1) shape.origin.y += size.y / 2;
  if (grid.z == 1) shape.origin.z += size.z / 2;
  return shape;
}

ProbeTextures::ProbeTextures(Grid grid)
    : color_desc(ddgi_irradiance(grid)),
      visibility_desc(ddgi_visibility(grid)),
      color(texture_bytes(color_desc) / 4),
      visibility(texture_bytes(visibility_desc) / 4) {}

bool is_color(const TextureDesc& desc) {
  return (desc.record.format == Format::A2R10G10B10_UNORM_PACK32 ||
          desc.record.format == Format::A2B10G10R10_UNORM_PACK32) &&
         desc.block.x == kIrradianceCore && desc.guard_band == 1;
}

bool is_visibility(const TextureDesc& desc) {
  return desc.record.format == Format::R16G16_SFLOAT && desc.block.x == kVisibilityCore &&
         desc.guard_band == 1;
}

void read_block(const TextureDesc& desc, std::span<const std::uint32_t> texture,
                std::uint32_t probe, std::span<std::uint32_t> block) {
  const BlockOrigin at = block_origin(desc, probe);
  const std::size_t side = desc.block.x + std::size_t{2} * desc.guard_band,
                    width = extent(desc).width;
  const std::size_t top = (at.slice + at.block) * extent(desc).height + at.y;
  for (std::size_t y = 0; y < side; ++y) {
    const auto row = texture.subspan((top + y) * width + at.x, side);
    std::copy(row.begin(), row.end(), block.begin() + static_cast<std::ptrdiff_t>(y * side));
  }
}

void write_block(const TextureDesc& desc, std::span<std::uint32_t> texture, std::uint32_t probe,
                 std::span<const std::uint32_t> block) {
  const BlockOrigin at = block_origin(desc, probe);
  const std::size_t side = desc.block.x + std::size_t{2} * desc.guard_band,
                    width = extent(desc).width;
  const std::size_t top = (at.slice + at.block) * extent(desc).height + at.y;
  for (std::size_t y = 0; y < side; ++y) {
    const auto row = block.subspan(y * side, side);
    std::copy(row.begin(), row.end(),
              texture.begin() + static_cast<std::ptrdiff_t>((top + y) * width + at.x));
  }
}

void fill_guard_band(std::span<std::uint32_t> block, std::uint32_t side) {
  const std::uint32_t last = side - 1, inner = side - 2;
  const auto at = [&](std::uint32_t x, std::uint32_t y) -> std::uint32_t& {
    return block[y * side + x];
  };
  for (std::uint32_t i = 1; i <= inner; ++i) {
    at(i, 0) = at(last - i, 1);
    at(i, last) = at(last - i, inner);
    at(0, i) = at(1, last - i);
    at(last, i) = at(inner, last - i);
  }
  at(0, 0) = at(inner, inner);
  at(last, 0) = at(1, inner);
  at(0, last) = at(inner, 1);
  at(last, last) = at(1, 1);
}

std::uint32_t encode_gamma5(float linear, std::uint32_t guess) {
  const auto& t = thresholds();
  if (linear >= t[guess] && (guess == 1023 || linear < t[guess + 1])) return guess;
  const auto end = std::upper_bound(t.begin() + 1, t.end(), linear);
  return static_cast<std::uint32_t>(end - t.begin()) - 1;
}

float decode_gamma5(std::uint32_t code) { return power5(static_cast<float>(code) / 1023.0F); }

float fifth_root(float linear) {
  const std::uint32_t code = encode_gamma5(linear);
  if (code == 0) return 0;
  // Two steps of Newton's method from at most half a code away.
  double y = static_cast<double>(code) / 1023.0;
  for (int i = 0; i < 2; ++i) {
    const double y4 = y * y * y * y;
    y -= (y4 * y - static_cast<double>(std::min(linear, 1.0F))) / (5 * y4);
  }
  return saturate(static_cast<float>(y));
}

std::uint32_t pack_moments(float mean, float mean_squared) {
  return std::uint32_t{Imath::half(mean).bits()} | std::uint32_t{Imath::half(mean_squared).bits()}
                                                       << 16;
}

Vec2 unpack_moments(std::uint32_t texel) {
  Imath::half mean, squared;
  mean.setBits(static_cast<std::uint16_t>(texel & 0xFFFFU));
  squared.setBits(static_cast<std::uint16_t>(texel >> 16));
  return {mean, squared};
}

}  // namespace gicodec::ddgi
