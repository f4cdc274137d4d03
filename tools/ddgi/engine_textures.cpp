#include "engine_textures.h"

#include "dump/dump.h"
#include "dump/error.h"

#include <gicodec/probes.h>

#include <algorithm>
#include <array>

namespace gicodec::ddgi {
namespace {

using Channels = std::array<float, 4>;

/// A probe as textures see it.
struct ProbeSample {
  const ProbeLight& light;
  std::uint32_t valid;  ///< bit i: the neighbour at (i & 1, i >> 1 & 1, i >> 2) is active
};

std::array<float, 9> factors_of(const ProbeLight& light, std::size_t colour) {
  std::array<float, 9> factors{};
  for (std::size_t k = 0; k < factors.size(); ++k) {
    const Vec3 f = light.sh[k];
    factors[k] = colour == 0 ? f.x : colour == 1 ? f.y : f.z;
  }
  return factors;
}

/// A factor against the constant one, between 0 and 1; 1/2 where there is no light.
float ratio(float factor, float constant, float scale) {
  return constant > 0 ? factor / (2 * scale * constant) + 0.5F : 0.5F;
}

constexpr float kScale1 = 2, kScale2 = 3.5777088F;  // ProbeBrickPool's decoder: 4 / √5 · 2

/// L0_L1Rx, L1G_L1Ry, L1B_L1Rz, L2_0 … L2_3, Validity, SkyOcclusionL0L1.
Channels unity(std::string_view name, const ProbeSample& sample) {
  const auto r = factors_of(sample.light, 0), g = factors_of(sample.light, 1),
             b = factors_of(sample.light, 2);
  const auto first = [](const std::array<float, 9>& f, std::size_t k) {
    return ratio(f[k], f[0], kScale1);
  };
  const auto second = [](const std::array<float, 9>& f, std::size_t k) {
    return ratio(f[k], f[0], kScale2);
  };
  const auto band = [&](const std::array<float, 9>& f) {
    return Channels{second(f, 4), second(f, 5), second(f, 6), second(f, 7)};
  };
  if (name == "L0_L1Rx") return {r[0], g[0], b[0], first(r, 1)};
  if (name == "L1G_L1Ry") return {first(g, 1), first(g, 2), first(g, 3), first(r, 2)};
  if (name == "L1B_L1Rz") return {first(b, 1), first(b, 2), first(b, 3), first(r, 3)};
  if (name == "L2_0") return band(r);
  if (name == "L2_1") return band(g);
  if (name == "L2_2") return band(b);
  if (name == "L2_3") return {second(r, 8), second(g, 8), second(b, 8), 1};
  if (name == "Validity") return {static_cast<float>(sample.valid) / 255.0F, 0, 0, 0};
  const auto& sky = sample.light.sky;
  return {sky[0], sky[1], sky[2], sky[3]};
}

/// AmbientVector, SHCoefficients0 … 5 (two for each colour), SkyBentNormal,
/// DirectionalLightShadowing.
Channels unreal(std::string_view name, const ProbeSample& sample) {
  const ProbeLight& light = sample.light;
  if (name == "AmbientVector") return {light.sh[0].x, light.sh[0].y, light.sh[0].z, 0};
  if (name.starts_with("SHCoefficients")) {
    const auto texture = static_cast<std::size_t>(name.back() - '0');
    const auto f = factors_of(light, texture / 2);
    const std::size_t from = texture % 2 == 0 ? 1 : 5;
    Channels channels{};
    for (std::size_t i = 0; i < channels.size(); ++i)
      channels[i] = ratio(f[from + i], f[0], kScale1);
    return channels;
  }
  if (name == "SkyBentNormal") {
    const Vec3 bent = normalize({light.sky[1], light.sky[2], light.sky[3]});
    return {bent.x * 0.5F + 0.5F, bent.y * 0.5F + 0.5F, bent.z * 0.5F + 0.5F, light.sky[0]};
  }
  return {light.sun, 0, 0, 0};
}

/// Slices of a layer: the constant, then y, z and x against four times that.
Channels godot(std::size_t slice, const ProbeSample& sample) {
  constexpr std::array<std::size_t, 4> kFactors{0, 2, 3, 1};
  constexpr float kScale = 4;
  Channels channels{0, 0, 0, 1};
  for (std::size_t colour = 0; colour < 3; ++colour) {
    const auto f = factors_of(sample.light, colour);
    channels[colour] = slice == 0 ? f[0] : ratio(f[kFactors[slice]], f[0], kScale);
  }
  return channels;
}

/// three.js: harmonics of radiance that shaders sum up to irradiance, y before z before x. Its
/// numbers 4·part to 4·part + 3, of three colours each.
Channels three(std::size_t part, const ProbeSample& sample) {
  constexpr std::array<std::size_t, 9> kFactors{0, 2, 3, 1, 4, 5, 6, 7, 8};
  // The norm of each harmonic times its band's share of irradiance over π: 1, 2/3, 1/4.
  constexpr std::array<float, 9> kScale{0.282095F,        0.488603F / 1.5F, 0.488603F / 1.5F,
                                        0.488603F / 1.5F, 1.092548F / 4,    1.092548F / 4,
                                        0.315392F / 4,    1.092548F / 4,    0.546274F / 4};
  Channels channels{};
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const std::size_t number = 4 * part + i, harmonic = number / 3;
    if (harmonic == kFactors.size()) break;
    const auto f = factors_of(sample.light, number % 3);
    channels[i] = f[kFactors[harmonic]] / kScale[harmonic];
  }
  return channels;
}

Grid bricks_of(Grid probes, std::uint32_t cells) {
  const auto along = [cells](std::uint32_t n) { return std::max(1U, (n + cells - 2) / cells); };
  return {along(probes.x), along(probes.y), along(probes.z)};
}

/// Cells between the probes of a brick along an axis; 0 for layouts without bricks.
std::uint32_t cells_of(const EngineLayout& layout) {
  return layout.unit == GridUnit::brick ? 3 : layout.unit == GridUnit::cell ? 4 : 0;
}

std::byte* texel_at(EngineTexture& texture, std::uint64_t x, std::uint64_t y, std::uint64_t z) {
  const Extent size = extent(texture.desc);
  return &texture.texels[((z * size.height + y) * size.width + x) * texture.desc.record.bytes];
}

/// The samples of all probes.
class ProbeSamples {
 public:
  ProbeSamples(Grid probes, const std::vector<ProbeLight>& light,
               const std::vector<std::uint8_t>& active)
      : probes_(probes), light_(light), active_(active) {}

  [[nodiscard]] ProbeSample at(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    std::uint32_t valid = 0;
    for (std::uint32_t corner = 0; corner < 8; ++corner) {
      const std::uint32_t probe = index(std::min(x + (corner & 1), probes_.x - 1),
                                        std::min(y + (corner >> 1 & 1), probes_.y - 1),
                                        std::min(z + (corner >> 2), probes_.z - 1));
      valid |= active_[probe] != 0 ? 1U << corner : 0;
    }
    return {light_[index(x, y, z)], valid};
  }

 private:
  [[nodiscard]] std::uint32_t index(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return x + probes_.x * (y + probes_.y * z);
  }
  Grid probes_;
  const std::vector<ProbeLight>& light_;
  const std::vector<std::uint8_t>& active_;
};

/// Calls visit(x, y, z) for each place of a grid.
template <typename Visit>
void for_places(Grid grid, Visit&& visit) {
  for (std::uint32_t z = 0; z < grid.z; ++z) {
    for (std::uint32_t y = 0; y < grid.y; ++y) {
      for (std::uint32_t x = 0; x < grid.x; ++x) visit(x, y, z);
    }
  }
}

void fill_bricks(EngineTexture& texture, Grid bricks, std::uint32_t cells,
                 const ProbeSamples& samples,
                 Channels (*channels)(std::string_view, const ProbeSample&)) {
  const BlockShape side = texture.desc.block;
  for_places(bricks, [&](std::uint32_t bx, std::uint32_t by, std::uint32_t bz) {
    const BlockOrigin at = block_origin(texture.desc, bx + bricks.x * (by + bricks.y * bz));
    for_places({side.x, side.y, side.z}, [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
      const ProbeSample sample = samples.at(cells * bx + x, cells * by + y, cells * bz + z);
      store_texel(texture.desc.record, texel_at(texture, at.x + x, at.y + y, at.slice + z),
                  channels(texture.name, sample));
    });
  });
}

/// Each cell names the brick of its own number.
void fill_indirection(EngineTexture& texture, const TextureDesc& brick, Grid cells) {
  for_places(cells, [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    const BlockOrigin at = block_origin(brick, x + cells.x * (y + cells.y * z));
    const auto place = [](std::uint64_t texel, std::uint8_t side) {
      const std::uint64_t bricks = texel / side;
      return static_cast<float>(bricks);
    };
    store_texel(texture.desc.record, texel_at(texture, x, y, z),
                {place(at.x, brick.block.x), place(at.y, brick.block.y),
                 place(at.slice, brick.block.z), 1});
  });
}

void fill_cubes(EngineTexture& texture, Grid voxels, const ProbeSamples& samples) {
  for_places(voxels, [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    const auto& cube = samples.at(x, y, z).light.cube;
    for (std::uint32_t face = 0; face < cube.size(); ++face) {
      // Bevy's shaders take faces towards -x, -y and -z from y = Ry on.
      std::byte* texel =
          texel_at(texture, x, y + (1 - face % 2) * voxels.y, z + face / 2 * voxels.z);
      store_texel(texture.desc.record, texel, {cube[face].x, cube[face].y, cube[face].z, 0});
    }
  });
}

/// Sub-volumes with a copy of their first slice before it, and of their last one behind it.
void fill_harmonics(EngineTexture& texture, Grid probes, const ProbeSamples& samples) {
  const std::uint32_t slices = probes.z + 2;
  for_places({probes.x, probes.y, slices}, [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    const ProbeSample sample = samples.at(x, y, std::clamp(z, 1U, probes.z) - 1);
    for (std::uint32_t part = 0; part < 7; ++part) {
      store_texel(texture.desc.record, texel_at(texture, x, y, part * slices + z),
                  three(part, sample));
    }
  });
}

void fill_lightmap(EngineTexture& texture, Grid texels, const ProbeSamples& samples) {
  for_places(texels, [&](std::uint32_t x, std::uint32_t y, std::uint32_t layer) {
    const ProbeSample sample = samples.at(x, layer, y);
    for (std::uint32_t slice = 0; slice < 4; ++slice) {
      store_texel(texture.desc.record, texel_at(texture, x, y, 4 * layer + slice),
                  godot(slice, sample));
    }
  });
}

/// True if probes are octahedral blocks, which are traced as they are stored.
bool is_octahedral(const VolumeDesc& volume) { return volume.kind == kKindProbes; }

/// Nothing moves probes; engines differ in what says that one is inactive.
Channels probe_state(std::string_view layout, bool active) {
  if (layout == "flax") return {0, 0, 0, active ? 1.0F : -1.0F};
  if (layout == "g3d") return {0, 0, 0, active ? 1.0F / 127 : 0.0F};
  return {0, 0, 0, active ? 0.0F : 1.0F};
}

}  // namespace

Grid layout_grid(const EngineLayout& layout, Grid probes) {
  if (const std::uint32_t cells = cells_of(layout)) return bricks_of(probes, cells);
  // A layer of a lightmap is a horizontal plane.
  return layout.unit == GridUnit::texel ? Grid{probes.x, probes.z, probes.y} : probes;
}

std::optional<std::array<double, 6>> lit_box(const EngineLayout& layout, const VolumeShape& shape) {
  if (layout.unit == GridUnit::texel || is_octahedral(*layout.make({1, 1, 1}))) return std::nullopt;
  // Probes and voxels stand in the middle of their cells, bricks end at probes.
  const double margin = cells_of(layout) == 0 ? 0.5 : 0.0;
  const std::array<std::uint32_t, 3> sides{shape.grid.x, shape.grid.y, shape.grid.z};
  const std::array<double, 3> origin{shape.origin.x, shape.origin.y, shape.origin.z};
  const std::array<double, 3> spacing{shape.spacing.x, shape.spacing.y, shape.spacing.z};
  std::array<double, 6> box{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box[axis] = origin[axis] - margin * spacing[axis];
    box[axis + 3] = origin[axis] + (sides[axis] - 1 + margin) * spacing[axis];
  }
  return box;
}

Grid probes_of(const EngineLayout& layout, Grid wanted) {
  const std::uint32_t cells = cells_of(layout);
  if (cells == 0) return wanted;
  const Grid bricks = bricks_of(wanted, cells);
  const Grid probes{cells * bricks.x + 1, cells * bricks.y + 1, cells * bricks.z + 1};
  if (std::uint64_t{probes.x} * probes.y * probes.z > kMaxProbes) {
    tools::fail(tools::Exit::usage,
                "--layout {}: whole bricks take {} probes, more than {}; --grid asks for fewer",
                layout.name, tools::to_string(probes), kMaxProbes);
  }
  return probes;
}

TextureForms forms_of(const EngineLayout& layout) {
  TextureForms forms;
  const auto volume = layout.make({1, 1, 1});
  forms.light = !is_octahedral(*volume);
  if (forms.light) return forms;
  const auto& textures = volume->groups.front().textures;
  forms.color = textures[0].desc.record.format;
  forms.color_core = textures[0].desc.block.x;
  forms.visibility = textures[1].desc.record.format;
  forms.visibility_core = textures[1].desc.block.x;
  forms.encoding = layout.name == "flax" ? Encoding::linear : Encoding::gamma5;
  return forms;
}

EngineTextures::EngineTextures(const EngineLayout& layout, Grid probes)
    : layout_(layout),
      probes_(probes),
      volume_(tools::take(layout.make(layout_grid(layout, probes)),
                          "--layout " + std::string(layout.name))) {
  for (const NamedTexture* one : textures_of(volume_)) {
    textures_.push_back({one->name, one->desc, std::vector<std::byte>(texture_bytes(one->desc))});
  }
}

void EngineTextures::fill_probes(const ProbeTextures& traced,
                                 const std::vector<std::uint8_t>& active) {
  const auto copy = [&](const TextureDesc& from, std::span<const std::byte> texels,
                        EngineTexture& to) {
    std::vector<std::byte> block(bytes_of_block(from));
    for (std::uint32_t probe = 0; probe < active.size(); ++probe) {
      read_block(from, texels, probe, block);
      write_block(to.desc, to.texels, probe, block);
    }
  };
  copy(traced.color_desc, traced.color, textures_[0]);
  copy(traced.visibility_desc, traced.visibility, textures_[1]);
  if (textures_.size() < 3) return;
  EngineTexture& data = textures_[2];
  for (std::uint32_t probe = 0; probe < active.size(); ++probe) {
    const BlockOrigin at = block_origin(data.desc, probe);
    store_texel(data.desc.record, texel_at(data, at.x, at.y, at.slice),
                probe_state(layout_.name, active[probe] != 0));
  }
}

void EngineTextures::fill(const ProbeTextures& traced, std::span<const std::uint32_t> active) {
  std::vector<std::uint8_t> is_active(std::size_t{probes_.x} * probes_.y * probes_.z);
  for (const std::uint32_t probe : active) is_active[probe] = 1;
  if (is_octahedral(volume_)) {
    fill_probes(traced, is_active);
    return;
  }
  const ProbeSamples samples(probes_, traced.light, is_active);
  const Grid grid = layout_grid(layout_, probes_);
  for (EngineTexture& texture : textures_) {
    switch (layout_.unit) {
      case GridUnit::probe:
        fill_harmonics(texture, grid, samples);
        break;
      case GridUnit::brick:
        fill_bricks(texture, grid, cells_of(layout_), samples, unity);
        break;
      case GridUnit::cell:
        if (texture.desc.space == Space::pool) {
          fill_bricks(texture, grid, cells_of(layout_), samples, unreal);
        } else {
          fill_indirection(texture, textures_.front().desc, grid);
        }
        break;
      case GridUnit::voxel:
        fill_cubes(texture, grid, samples);
        break;
      case GridUnit::texel:
        fill_lightmap(texture, grid, samples);
        break;
    }
  }
}

}  // namespace gicodec::ddgi
