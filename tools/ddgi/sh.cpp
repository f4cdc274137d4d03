#include "sh.h"

#include "probe_rays.h"

#include <gicodec/probes.h>

#include <cstring>

namespace gicodec::ddgi {
namespace {

using Channels = std::array<float, 4>;

struct Row {
  const char* name;
  Format format;
};
constexpr Format kHalves = Format::R16G16B16A16_SFLOAT, kBytes = Format::R8G8B8A8_UNORM;
constexpr std::array kL2 = {Row{"sha_r", kHalves}, Row{"sha_g", kHalves}, Row{"sha_b", kHalves},
                            Row{"shb_r", kHalves}, Row{"shb_g", kHalves}, Row{"shb_b", kHalves},
                            Row{"shc", kHalves}};
constexpr std::array kRatios = {Row{"l0_l1rx", kHalves}, Row{"l1g_l1ry", kBytes},
                                Row{"l1b_l1rz", kBytes}};

std::span<const Row> rows_of(ShForm form) {
  switch (form) {
    case ShForm::none:
      return {};
    case ShForm::l1:
      return std::span(kL2).first(3);
    case ShForm::l2:
      return kL2;
    case ShForm::l1_over_l0:
      return kRatios;
  }
  return {};
}

std::array<float, 3> colours(Vec3 v) { return {v.x, v.y, v.z}; }

/// What the textures of a form hold of a probe.
std::vector<Channels> channels_of(ShForm form, const ShFactors& f) {
  std::array<std::array<float, 9>, 3> by_colour{};
  for (std::size_t k = 0; k < f.size(); ++k) {
    for (std::size_t c = 0; c < 3; ++c) by_colour[c][k] = colours(f[k])[c];
  }
  std::vector<Channels> out;
  if (form == ShForm::l1_over_l0) {
    std::array<std::array<float, 3>, 3> ratio{};
    for (std::size_t c = 0; c < 3; ++c) {
      const float scale = by_colour[c][0] > 0 ? 0.25F / by_colour[c][0] : 0;
      for (std::size_t k = 0; k < 3; ++k) ratio[c][k] = by_colour[c][k + 1] * scale + 0.5F;
    }
    return {{f[0].x, f[0].y, f[0].z, ratio[0][0]},
            {ratio[1][0], ratio[1][1], ratio[1][2], ratio[0][1]},
            {ratio[2][0], ratio[2][1], ratio[2][2], ratio[0][2]}};
  }
  const bool second = form == ShForm::l2;
  for (const auto& c : by_colour) out.push_back({c[1], c[2], c[3], second ? c[0] - c[6] : c[0]});
  if (!second) return out;
  for (const auto& c : by_colour) out.push_back({c[4], c[5], 3 * c[6], c[7]});
  out.push_back({f[8].x, f[8].y, f[8].z, 1});
  return out;
}

void store(const Record& record, std::byte* texel, const Channels& channels, float hysteresis) {
  if (record.format == kHalves) {
    std::array<std::uint16_t, 4> bits{};
    std::memcpy(bits.data(), texel, sizeof bits);
    for (std::size_t i = 0; i < bits.size(); ++i) {
      const float old = hysteresis > 0 ? from_half(bits[i]) : 0;
      bits[i] = to_half(mix(channels[i], old, hysteresis));
    }
    std::memcpy(texel, bits.data(), sizeof bits);
    return;
  }
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const float old = static_cast<float>(texel[i]) / 255.0F;
    const float value = saturate(mix(channels[i], old, hysteresis));
    texel[i] = static_cast<std::byte>(std::floor(value * 255.0F + 0.5F));
  }
}

}  // namespace

std::string_view to_string(ShForm form) noexcept {
  switch (form) {
    case ShForm::none:
      return "none";
    case ShForm::l1:
      return "l1";
    case ShForm::l2:
      return "l2";
    case ShForm::l1_over_l0:
      return "l1-over-l0";
  }
  return {};
}

std::vector<ShTexture> sh_textures(ShForm form, Grid grid) {
  std::vector<ShTexture> textures;
  for (const Row& row : rows_of(form)) {
    const TextureDesc desc = probe_texture(row.format, grid, 1, 0);
    textures.push_back({row.name, desc, std::vector<std::byte>(texture_bytes(desc))});
  }
  return textures;
}

ShFactors project_sh(std::span<const Vec3> directions, std::span<const ProbeRay> rays) {
  ShFactors sum{};
  float count = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (rays[i].end == RayEnd::back) continue;
    const Vec3 d = directions[i], c = rays[i].radiance;
    const std::array<float, 9> basis{1,
                                     d.x,
                                     d.y,
                                     d.z,
                                     d.x * d.y,
                                     d.y * d.z,
                                     3 * d.z * d.z - 1,
                                     d.z * d.x,
                                     d.x * d.x - d.y * d.y};
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += c * basis[k];
    ++count;
  }
  // What the cosine leaves of each band (1, 2/3, 1/4), times the square of each polynomial's norm.
  constexpr ShFactors::size_type kSize = 9;
  constexpr std::array<float, kSize> kScale{1, 2, 2, 2, 3.75F, 3.75F, 0.3125F, 3.75F, 0.9375F};
  for (std::size_t k = 0; k < sum.size(); ++k)
    sum[k] = count > 0 ? sum[k] * (kScale[k] / count) : Vec3{};
  return sum;
}

void store_sh(ShForm form, const ShFactors& factors, float hysteresis, std::uint32_t probe,
              std::vector<ShTexture>& textures) {
  if (form == ShForm::none) return;
  const std::vector<Channels> channels = channels_of(form, factors);
  for (std::size_t i = 0; i < textures.size(); ++i) {
    std::span<std::byte> all(textures[i].texels);
    const TextureDesc& desc = textures[i].desc;
    std::vector<std::byte> block(bytes_of_block(desc));
    read_block(desc, all, probe, block);
    store(desc.record, block.data(), channels[i], hysteresis);
    write_block(desc, all, probe, block);
  }
}

}  // namespace gicodec::ddgi
