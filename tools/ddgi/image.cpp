#include "image.h"

namespace gicodec::ddgi {
namespace {

float decode(float s) { return s <= 0.04045F ? s / 12.92F : std::pow((s + 0.055F) / 1.055F, 2.4F); }

const std::array<float, 256>& decode_table() {
  static const auto table = [] {
    std::array<float, 256> t{};
    for (std::size_t i = 0; i < 256; ++i) t[i] = decode(static_cast<float>(i) / 255.0F);
    return t;
  }();
  return table;
}

Vec3 linear(std::array<std::uint8_t, 3> texel) {
  const auto& table = decode_table();
  return {table[texel[0]], table[texel[1]], table[texel[2]]};
}

std::array<std::uint8_t, 3> encode(Vec3 c) {
  return {linear_to_srgb(c.x), linear_to_srgb(c.y), linear_to_srgb(c.z)};
}

/// Half as wide and high, each texel the mean of its four.
Image::Level halve(const Image::Level& from) {
  Image::Level to{std::max(1U, from.width / 2), std::max(1U, from.height / 2), {}};
  to.texels.reserve(std::size_t{to.width} * to.height);
  for (std::uint32_t y = 0; y < to.height; ++y) {
    for (std::uint32_t x = 0; x < to.width; ++x) {
      Vec3 sum;
      for (std::uint32_t i = 0; i < 4; ++i) {
        const std::uint32_t sx = std::min(2 * x + (i & 1), from.width - 1);
        const std::uint32_t sy = std::min(2 * y + (i >> 1), from.height - 1);
        sum += linear(from.texels[std::size_t{sy} * from.width + sx]);
      }
      to.texels.push_back(encode(sum * 0.25F));
    }
  }
  return to;
}

}  // namespace

std::uint8_t linear_to_srgb(float value) {
  const float v = saturate(value);
  const float s = v <= 0.0031308F ? v * 12.92F : 1.055F * std::pow(v, 1 / 2.4F) - 0.055F;
  return static_cast<std::uint8_t>(std::lround(s * 255.0F));
}

Image::Image(std::uint32_t width, std::uint32_t height,
             std::vector<std::array<std::uint8_t, 3>> texels) {
  levels_.push_back({width, height, std::move(texels)});
  while (levels_.back().width > 1 || levels_.back().height > 1) {
    levels_.push_back(halve(levels_.back()));
  }
}

Vec3 Image::sample(Vec2 uv, float footprint) const {
  const float texels = footprint * static_cast<float>(std::max(base().width, base().height));
  std::size_t index = 0;
  for (float t = texels; t > 1.5F && index + 1 < levels_.size(); t *= 0.5F) ++index;
  const Level& level = levels_[index];

  const auto w = static_cast<float>(level.width), h = static_cast<float>(level.height);
  const float x = (uv.x - std::floor(uv.x)) * w - 0.5F, y = (uv.y - std::floor(uv.y)) * h - 0.5F;
  const float bx = std::floor(x), by = std::floor(y);
  const auto wrap = [](float i, std::uint32_t n) {
    const auto k = static_cast<std::int64_t>(i) % n;
    return static_cast<std::size_t>(k < 0 ? k + n : k);
  };
  const std::size_t x0 = wrap(bx, level.width), x1 = wrap(bx + 1, level.width);
  const std::size_t y0 = wrap(by, level.height) * level.width;
  const std::size_t y1 = wrap(by + 1, level.height) * level.width;
  const auto& t = level.texels;
  return lerp(lerp(linear(t[y0 + x0]), linear(t[y0 + x1]), x - bx),
              lerp(linear(t[y1 + x0]), linear(t[y1 + x1]), x - bx), y - by);
}

Image make_image(std::uint32_t side, const std::function<Vec3(float, float)>& colour) {
  std::vector<std::array<std::uint8_t, 3>> texels;
  texels.reserve(std::size_t{side} * side);
  const float scale = 1.0F / static_cast<float>(side);
  for (std::uint32_t y = 0; y < side; ++y) {
    for (std::uint32_t x = 0; x < side; ++x) {
      texels.push_back(encode(
          colour((static_cast<float>(x) + 0.5F) * scale, (static_cast<float>(y) + 0.5F) * scale)));
    }
  }
  return Image(side, side, std::move(texels));
}

}  // namespace gicodec::ddgi
