#include "map_texels.h"

#include <algorithm>
#include <cstring>

namespace gicodec::maps {
namespace {

constexpr std::uint32_t kBaseBlockTexels = kMapBaseBlock * kMapBaseBlock;
constexpr float kMax = 65504;  // of a half

constexpr std::uint32_t kTileBits = kMapTile * kMapTile;

/// Of a texel among those of all tiles.
std::size_t bit_of(std::uint32_t width, std::uint32_t place) {
  const std::uint32_t x = place % width, y = place / width;
  const std::size_t tile = x / kMapTile + std::size_t{(width - 1) / kMapTile + 1} * (y / kMapTile);
  return kTileBits * tile + x % kMapTile + std::size_t{kMapTile} * (y % kMapTile);
}

float sane(float v) { return v > 0 ? std::min(v, kMax) : 0; }  // no NaN either

}  // namespace

TexelCode::TexelCode(Format format)
    : texels_(format, ddgi::usual_encoding(format)), bytes_(Record(format).bytes) {}

std::size_t TexelCode::clips(std::span<const Vec3> values) const {
  if (texels_.linear()) return 0;
  return static_cast<std::size_t>(std::ranges::count_if(values, [](Vec3 value) {
    return std::max({value.x, value.y, value.z}) > 1;
  }));
}

Vec3 TexelCode::load(const std::byte* texel) const {
  const Vec3 code = texels_.load(texel);
  if (texels_.linear()) return {sane(code.x), sane(code.y), sane(code.z)};
  const auto channel = [](float c) { return ddgi::decode_gamma5(static_cast<std::uint32_t>(c)); };
  return {channel(code.x), channel(code.y), channel(code.z)};
}

std::vector<std::byte> coverage_of(const Parameterisation& map, std::span<const MapTexel> texels) {
  const std::uint32_t across = (map.width() - 1) / kMapTile + 1;
  const std::uint32_t down = (map.height() - 1) / kMapTile + 1;
  std::vector<std::byte> masks(std::size_t{kTileBits / 8} * across * down);
  for (const MapTexel& texel : texels) {
    const std::size_t bit = bit_of(map.width(), texel.place);
    masks[bit / 8] |= std::byte(1U << bit % 8);
  }
  return masks;
}

std::vector<std::uint8_t> existence_of(const Parameterisation& map,
                                       std::span<const std::byte> coverage) {
  std::vector<std::uint8_t> exists(std::size_t{map.width()} * map.height());
  for (const MapTexel& texel : map.texels()) {
    const std::size_t bit = bit_of(map.width(), texel.place);
    exists[texel.place] = (coverage[bit / 8] >> bit % 8 & std::byte{1}) != std::byte{0} ? 1 : 0;
  }
  return exists;
}

std::vector<std::byte> texels_of(const Parameterisation& map, std::span<const MapTexel> texels,
                                 const TexelCode& code, std::span<const Vec3> values) {
  std::vector<std::byte> out(code.bytes() * map.width() * map.height());
  for (const MapTexel& texel : texels) {
    code.store(&out[code.bytes() * texel.place], values[texel.place]);
  }
  return out;
}

std::vector<std::byte> coefficients_of(const TexelCode& code, std::span<const Vec3> bases) {
  std::vector<std::byte> out((bases.size() + kBaseBlockTexels - 1) / kBaseBlockTexels *
                             kBaseBlockTexels * code.bytes());
  for (std::size_t i = 0; i < bases.size(); ++i) code.store(&out[code.bytes() * i], bases[i]);
  return out;
}

std::vector<std::byte> blends_of(const Parameterisation& map, std::span<const MapTexel> texels,
                                 std::span<const Blend> blends) {
  std::vector<std::byte> out(sizeof(Blend) * map.width() * map.height());
  for (std::size_t i = 0; i < blends.size(); ++i) {
    std::memcpy(&out[sizeof(Blend) * texels[i].place], &blends[i], sizeof(Blend));
  }
  return out;
}

std::vector<std::byte> hash_of(const Parameterisation& map) {
  std::vector<std::byte> out(sizeof(std::uint64_t));
  const std::uint64_t hash = map.hash();
  std::memcpy(out.data(), &hash, sizeof hash);
  return out;
}

}  // namespace gicodec::maps
