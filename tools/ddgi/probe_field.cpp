#include "probe_field.h"

namespace gicodec::ddgi {
namespace {

constexpr float kBias = 0.3F;        // of three quarters of the least spacing
constexpr float kMinWeight = 1e-6F;  // keeps a normalised answer where all probes are hidden
constexpr float kCrush = 0.2F;       // weights below fade faster: contributions that leak

/// Texels of a block with its guard band.
constexpr std::size_t texels_of(std::uint32_t core) {
  return (std::size_t{core} + 2) * (std::size_t{core} + 2);
}

}  // namespace

ProbeField::ProbeField(const VolumeShape& shape) : shape_(shape), active_(shape.probes()) {}

void ProbeField::set_color(const ProbeTextures& textures) {
  color_core_ = textures.color_desc.block.x;
  linear_ = textures.encoding == Encoding::linear;
  color_.resize(shape_.probes() * texels_of(color_core_));
  for (std::uint32_t probe = 0; probe < shape_.probes(); ++probe) set_color(textures, probe);
}

void ProbeField::set_color(const ProbeTextures& textures, std::uint32_t probe) {
  const TextureDesc& desc = textures.color_desc;
  const ColorTexels format(desc.record.format, textures.encoding);
  const float scale = 1.0F / format.unit();
  thread_local std::vector<std::byte> block;
  block.resize(bytes_of_block(desc));
  read_block(desc, textures.color, probe, block);
  auto* out = &color_[probe * texels_of(color_core_)];
  for (std::size_t i = 0; i < block.size(); i += desc.record.bytes) {
    const Vec3 c = format.load(&block[i]) * scale;
    *out++ = {c.x, c.y, c.z, 0};
  }
}

void ProbeField::set_visibility(const ProbeTextures& textures) {
  const TextureDesc& desc = textures.visibility_desc;
  visibility_core_ = desc.block.x;
  moments_.resize(shape_.probes() * texels_of(visibility_core_));
  std::vector<std::byte> block(bytes_of_block(desc));
  Vec2* out = moments_.data();
  for (std::uint32_t probe = 0; probe < shape_.probes(); ++probe) {
    read_block(desc, textures.visibility, probe, block);
    for (std::size_t i = 0; i < block.size(); i += desc.record.bytes)
      *out++ = load_moments(desc.record.format, &block[i]);
    active_[probe] =
        std::any_of(block.begin(), block.end(), [](std::byte byte) { return byte != std::byte{}; });
  }
}

Vec2 ProbeField::moments(std::uint32_t probe, Vec3 direction) const {
  const Fetch f = bilinear_fetch(direction, visibility_core_);
  const std::size_t side = visibility_core_ + 2;
  const Vec2* t = &moments_[probe * side * side + f.y * side + f.x];
  const auto bilinear = [&](float a, float b, float c, float d) {
    return mix(mix(a, b, f.fx), mix(c, d, f.fx), f.fy);
  };
  const Vec2 a = t[0], b = t[1], c = t[side], d = t[side + 1];
  return {bilinear(a.x, b.x, c.x, d.x), bilinear(a.y, b.y, c.y, d.y)};
}

bool ProbeField::holds(Vec3 p) const {
  const Vec3 lo = shape_.origin, hi = shape_.position(shape_.probes() - 1);
  return p.x >= lo.x && p.y >= lo.y && p.z >= lo.z && p.x <= hi.x && p.y <= hi.y && p.z <= hi.z;
}

Cage ProbeField::cage(Vec3 position, Vec3 normal, Vec3 to_viewer) const {
  const Vec3 spacing = shape_.spacing;
  const float least = std::min({spacing.x, spacing.y, spacing.z});
  const Vec3 biased = position + (normal * 0.2F + to_viewer * 0.8F) * (0.75F * least * kBias);

  const Vec3 at = (biased - shape_.origin);
  const auto split = [](float distance, float step, std::uint32_t n, float& fraction) {
    const float g = step > 0 ? distance / step : 0;
    const float cell = std::clamp(std::floor(g), 0.0F, static_cast<float>(n - 1));
    fraction = saturate(g - cell);
    return static_cast<std::uint32_t>(cell);
  };
  const Grid grid = shape_.grid;
  Vec3 alpha;
  const std::uint32_t x = split(at.x, spacing.x, grid.x, alpha.x);
  const std::uint32_t y = split(at.y, spacing.y, grid.y, alpha.y);
  const std::uint32_t z = split(at.z, spacing.z, grid.z, alpha.z);
  Cage cage;
  cage.base = x + grid.x * (y + grid.y * z);
  cage.step = {x + 1 < grid.x ? 1U : 0U, y + 1 < grid.y ? grid.x : 0U,
               z + 1 < grid.z ? grid.x * grid.y : 0U};
  const Vec3 first = shape_.position(cage.base);

  float sum = 0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const auto axis = [&](unsigned bit, float a) { return corner & bit ? a : 1 - a; };
    const float trilinear = axis(1, alpha.x) * axis(2, alpha.y) * axis(4, alpha.z);
    const std::uint32_t probe = cage.probe(corner);
    if (trilinear <= 0 || !active_[probe]) continue;
    const Vec3 block_position = first + Vec3{corner & 1 ? spacing.x : 0, corner & 2 ? spacing.y : 0,
                                             corner & 4 ? spacing.z : 0};

    const float wrap = (dot(normalize(block_position - position), normal) + 1) * 0.5F;
    float weight = wrap * wrap + 0.2F;

    const Vec3 from_probe = biased - block_position;
    const float distance = length(from_probe);
    if (distance > 0) {
      const Vec2 m = moments(probe, from_probe);
      if (distance > m.x) {
        const float variance = std::abs(m.x * m.x - m.y);
        const float beyond = distance - m.x;
        const float chebyshev = variance / (variance + beyond * beyond);
        weight *= chebyshev * chebyshev * chebyshev;
      }
    }
    weight = std::max(kMinWeight, weight);
    if (weight < kCrush) weight *= weight * weight / (kCrush * kCrush);
    cage.weight[corner] = weight * trilinear;
    sum += cage.weight[corner];
  }
  if (sum > 0) {
    for (float& weight : cage.weight) weight /= sum;
  }
  return cage;
}

Vec3 ProbeField::irradiance(const Cage& cage, const Fetch& fetch) const {
  const float wx = fetch.fx, wy = fetch.fy;
  const std::array<float, 4> w{(1 - wx) * (1 - wy), wx * (1 - wy), (1 - wx) * wy, wx * wy};
  const std::size_t side = color_core_ + 2, at = fetch.y * side + fetch.x;
  std::array<float, 4> sum{};
  for (unsigned corner = 0; corner < 8; ++corner) {
    if (cage.weight[corner] <= 0) continue;
    const auto* t = &color_[cage.probe(corner) * side * side + at];
    for (std::size_t c = 0; c < 4; ++c) {
      const float e = t[0][c] * w[0] + t[1][c] * w[1] + t[side][c] * w[2] + t[side + 1][c] * w[3];
      // Half of the gamma: mixing is done between linear and perceived light.
      const float root = std::sqrt(e);
      sum[c] += cage.weight[corner] * (linear_ ? root : e * e * root);
    }
  }
  return {sum[0] * sum[0], sum[1] * sum[1], sum[2] * sum[2]};
}

}  // namespace gicodec::ddgi
