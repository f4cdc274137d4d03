// Engines' textures: what the tracer puts where.
#include "ddgi/engine_textures.h"
#include "dump/error.h"
#include "rooms.h"

#include <gtest/gtest.h>

#include <cstring>

namespace gicodec::ddgi {
namespace {

using test::busy_room;
using test::room;
using test::Traced;

/// A layout's textures of a scene, and what they were filled from.
struct Filled {
  const EngineLayout& layout;
  Traced traced;
  EngineTextures engine;

  static Scene placed(Scene scene, const EngineLayout& layout) {
    scene.grid = probes_of(layout, scene.grid);
    return scene;
  }
  Filled(const EngineLayout& layout_in, Scene scene, std::uint32_t rays = 64)
      : layout(layout_in),
        traced(placed(std::move(scene), layout_in), {.rays = rays, .forms = forms_of(layout_in)}),
        engine(layout_in, traced.scene.grid) {
    update(0);
  }
  void update(double time) {
    traced.volume.update(time);
    engine.fill(traced.volume.textures(), traced.volume.active_probes());
  }
  [[nodiscard]] const EngineTexture& texture(std::string_view name) const {
    for (const EngineTexture& one : engine.textures()) {
      if (one.name == name) return one;
    }
    throw std::runtime_error("no such texture");
  }
};

const EngineLayout& layout_of(std::string_view name) { return *find_engine_layout(name); }

const std::byte* at(const EngineTexture& texture, std::uint64_t x, std::uint64_t y,
                    std::uint64_t z) {
  const Extent size = extent(texture.desc);
  return &texture.texels[((z * size.height + y) * size.width + x) * texture.desc.record.bytes];
}

std::array<float, 4> halves(const std::byte* texel) {
  std::array<std::uint16_t, 4> bits{};
  std::memcpy(bits.data(), texel, sizeof bits);
  return {from_half(bits[0]), from_half(bits[1]), from_half(bits[2]), from_half(bits[3])};
}

TEST(EngineTextures, ProbesStandWhereTheLayoutSays) {
  for (const EngineLayout& layout : engine_layouts()) {
    if (forms_of(layout).light) continue;
    const Filled filled(layout, busy_room());
    const ProbeTextures& traced = filled.traced.volume.textures();
    const auto same = [&](const TextureDesc& from, const std::vector<std::byte>& texels,
                          const EngineTexture& to) {
      EXPECT_EQ(from.record, to.desc.record) << layout.name;
      std::vector<std::byte> a(bytes_of_block(from)), b(a.size());
      for (std::uint32_t probe = 0; probe < filled.traced.volume.shape().probes(); ++probe) {
        read_block(from, texels, probe, a);
        read_block(to.desc, to.texels, probe, b);
        EXPECT_EQ(a, b) << layout.name << ", " << to.name << ", probe " << probe;
      }
    };
    same(traced.color_desc, traced.color, filled.engine.textures()[0]);
    same(traced.visibility_desc, traced.visibility, filled.engine.textures()[1]);
    EXPECT_TRUE(any_light(traced)) << layout.name;
  }
}

TEST(EngineTextures, InactiveProbesSaySo) {
  const auto inactive = [](const Filled& filled) {
    std::vector<std::uint32_t> probes;
    const auto active = filled.traced.volume.active_probes();
    for (std::uint32_t probe = 0; probe < filled.traced.volume.shape().probes(); ++probe) {
      if (std::find(active.begin(), active.end(), probe) == active.end()) probes.push_back(probe);
    }
    EXPECT_FALSE(probes.empty());
    return probes;
  };
  const Filled rtxgi(layout_of("rtxgi"), busy_room());
  const EngineTexture& data = rtxgi.texture("ProbeData");
  std::vector<std::uint32_t> found;
  for (std::uint32_t probe = 0; probe < 60; ++probe) {
    const BlockOrigin place = block_origin(data.desc, probe);
    if (halves(at(data, place.x, place.y, place.slice))[3] == 1) found.push_back(probe);
  }
  EXPECT_EQ(found, inactive(rtxgi));

  const Filled flax(layout_of("flax"), busy_room());
  found.clear();
  for (std::uint32_t probe = 0; probe < 60; ++probe) {
    const BlockOrigin place = block_origin(flax.texture("ProbesData").desc, probe);
    const auto state =
        static_cast<std::int8_t>(at(flax.texture("ProbesData"), place.x, place.y, place.slice)[3]);
    if (state == -127) found.push_back(probe);
    EXPECT_TRUE(state == -127 || state == 127);
  }
  EXPECT_EQ(found, inactive(flax));
}

/// Light that is the same from everywhere has a constant part and nothing else.
TEST(EngineTextures, EvenLightIsConstant) {
  const Scene even = room({4, 3, 5}, 0, 0.25F);
  const Filled unity(layout_of("unity-apv"), even, 2048);
  for (const char* name : {"L1G_L1Ry", "L1B_L1Rz", "L2_0", "L2_1", "L2_2"}) {
    for (const std::byte code : unity.texture(name).texels)
      EXPECT_NEAR(std::to_integer<int>(code), 128, 2) << name;
  }
  for (std::uint64_t x = 0; x < extent(unity.texture("L0_L1Rx").desc).width; ++x) {
    const auto light = halves(at(unity.texture("L0_L1Rx"), x, 1, 2));
    EXPECT_NEAR(light[0], 0.25F, 0.002F);
    EXPECT_NEAR(light[2], 0.25F, 0.002F);
    EXPECT_NEAR(light[3], 0.5F, 0.01F);
    // A closed room sees no sky; every probe and neighbour is active.
    EXPECT_EQ(halves(at(unity.texture("SkyOcclusionL0L1"), x, 1, 2))[0], 0);
    EXPECT_EQ(*at(unity.texture("Validity"), x, 1, 2), std::byte{0xFF});
  }

  const Filled unreal(layout_of("unreal-vlm"), even, 2048);
  for (std::uint64_t x = 0; x < extent(unreal.texture("AmbientVector").desc).width; ++x) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, at(unreal.texture("AmbientVector"), x, 2, 3), sizeof bits);
    EXPECT_NEAR(from_ufloat(bits & 2047U, 11), 0.25F, 0.01F);
    EXPECT_NEAR(from_ufloat(bits >> 22, 10), 0.25F, 0.01F);
  }

  const Filled bevy(layout_of("bevy"), even, 2048);
  const EngineTexture& cubes = bevy.texture("voxels");
  EXPECT_EQ(extent(cubes.desc), (Extent{4, 6, 15}));
  for (std::size_t i = 0; i < cubes.texels.size(); i += 4) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &cubes.texels[i], sizeof bits);
    EXPECT_NEAR(from_shared_exponent(bits).y, 0.25F, 0.002F) << i;
  }

  const Filled godot(layout_of("godot"), even, 2048);
  const EngineTexture& map = godot.texture("lightmap");
  EXPECT_EQ(extent(map.desc), (Extent{4, 5, 12}));
  EXPECT_NEAR(halves(at(map, 1, 2, 4))[1], 0.25F, 0.002F);
  for (const std::uint64_t slice : {5U, 6U, 7U}) {
    EXPECT_NEAR(halves(at(map, 1, 2, slice))[1], 0.5F, 0.01F);
    EXPECT_EQ(halves(at(map, 1, 2, slice))[3], 1);
  }
}

/// A dark room with a wall of light at +x.
Scene lit_from_x() {
  Scene scene = room({4, 3, 5}, 0, 0);
  const std::uint32_t lamp = scene.add_material({.name = "lamp", .emission = {1, 1, 1}});
  MeshBuilder wall(lamp);
  wall.box({3.8F, -2.9F, -4.9F}, {3.9F, 2.9F, 4.9F});
  scene.objects[0].meshes.push_back(scene.add_mesh(wall.take()));
  scene.volume = {{-3, -2, -4}, {3, 2, 4}};
  return scene;
}

/// Light from one side is brightest on faces towards it.
TEST(EngineTextures, CubesFaceTheLight) {
  const Scene scene = lit_from_x();
  const Filled bevy(layout_of("bevy"), scene, 512);
  const EngineTexture& cubes = bevy.texture("voxels");
  const Grid n = scene.grid;
  const auto green = [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, at(cubes, x, y, z), sizeof bits);
    return from_shared_exponent(bits).y;
  };
  EXPECT_GT(green(2, 1, 2), 0.3F);     // +x
  EXPECT_EQ(green(2, 1 + n.y, 2), 0);  // -x
  EXPECT_LT(green(2, 1 + n.y, 2 + n.z), green(2, 1, 2));
  EXPECT_LT(green(2, 1, 2 + 2 * n.z), green(2, 1, 2));
}

/// Green of the face of voxel (2, 1, 2) of 4 × 3 × 5, towards the positive end of an axis or not.
float green_face(const EngineTexture& cubes, bool positive, std::uint64_t axis) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, at(cubes, 2, 1 + (positive ? 0 : 3), 2 + axis * 5), sizeof bits);
  return from_shared_exponent(bits).y;
}

/// What Godot's shaders make of it: L0 · (1 + 4 · (y, z, x of the normal) · (2 · texel − 1)).
TEST(EngineTextures, LightmapsAreShadedAsGodotDoes) {
  const Filled godot(layout_of("godot"), lit_from_x(), 2048);
  const Filled bevy(layout_of("bevy"), lit_from_x(), 2048);
  const EngineTexture& map = godot.texture("lightmap");
  const EngineTexture& cubes = bevy.texture("voxels");
  const auto texel = [&](std::uint64_t slice) { return halves(at(map, 2, 2, 4 + slice))[1]; };
  const auto shaded = [&](Vec3 n) {
    const float l1 = n.y * (2 * texel(1) - 1) + n.z * (2 * texel(2) - 1) + n.x * (2 * texel(3) - 1);
    return texel(0) * (1 + 4 * l1);
  };
  EXPECT_GT(shaded({1, 0, 0}), 0.3F);
  // Two bands of spherical harmonics are that near.
  EXPECT_NEAR(shaded({1, 0, 0}), green_face(cubes, true, 0), 0.15F);
  EXPECT_NEAR(shaded({-1, 0, 0}), green_face(cubes, false, 0), 0.15F);
  for (const auto& [n, positive, axis] : {std::tuple{Vec3{0, 1, 0}, true, 1U},
                                          {Vec3{0, -1, 0}, false, 1U},
                                          {Vec3{0, 0, 1}, true, 2U},
                                          {Vec3{0, 0, -1}, false, 2U}}) {
    EXPECT_NEAR(shaded(n), green_face(cubes, positive, axis), 0.15F) << positive << axis;
  }
}

/// What three.js's shaders sum up is irradiance; padding repeats the slices beside it.
TEST(EngineTextures, HarmonicsAreSummedUpAsThreeDoes) {
  const Filled three(layout_of("three-float32"), lit_from_x(), 2048);
  const Filled bevy(layout_of("bevy"), lit_from_x(), 2048);
  const EngineTexture& grid = three.texture("grid");
  const EngineTexture& cubes = bevy.texture("voxels");
  ASSERT_EQ(extent(grid.desc), (Extent{4, 3, 7 * 7}));
  const auto green = [&](std::uint64_t harmonic) {
    const std::uint64_t number = 3 * harmonic + 1;
    std::array<float, 4> texel{};
    std::memcpy(texel.data(), at(grid, 2, 1, number / 4 * 7 + 1 + 2), sizeof texel);
    return texel[number % 4];
  };
  const auto irradiance = [&](Vec3 n) {
    return 0.886227F * green(0) +
           2 * 0.511664F * (green(1) * n.y + green(2) * n.z + green(3) * n.x) +
           2 * 0.429043F * (green(4) * n.x * n.y + green(5) * n.y * n.z + green(7) * n.x * n.z) +
           green(6) * (0.743125F * n.z * n.z - 0.247708F) +
           0.429043F * green(8) * (n.x * n.x - n.y * n.y);
  };
  constexpr float kPi = 3.14159265F;
  EXPECT_GT(irradiance({1, 0, 0}), 0.3F * kPi);
  for (const auto& [n, positive, axis] : {std::tuple{Vec3{1, 0, 0}, true, 0U},
                                          {Vec3{-1, 0, 0}, false, 0U},
                                          {Vec3{0, 1, 0}, true, 1U},
                                          {Vec3{0, -1, 0}, false, 1U},
                                          {Vec3{0, 0, 1}, true, 2U},
                                          {Vec3{0, 0, -1}, false, 2U}}) {
    EXPECT_NEAR(irradiance(n) / kPi, green_face(cubes, positive, axis), 0.05F) << positive << axis;
  }
  const std::size_t slice = std::size_t{4} * 3 * 16;
  for (std::uint64_t part = 0; part < 7; ++part) {
    for (const auto& [padding, copied] : {std::pair{0U, 1U}, {6U, 5U}}) {
      EXPECT_EQ(
          std::memcmp(at(grid, 0, 0, 7 * part + padding), at(grid, 0, 0, 7 * part + copied), slice),
          0);
    }
  }
}

TEST(EngineTextures, BricksShareTheirFaces) {
  for (const auto& [name, texture, last] :
       {std::tuple{"unity-apv", "L0_L1Rx", 3U}, {"unreal-vlm", "AmbientVector", 4U}}) {
    Scene scene = busy_room();
    scene.grid = {6, 3, 4};
    const Filled filled(layout_of(name), scene);
    const Grid probes = filled.traced.scene.grid;
    EXPECT_EQ(probes, (last == 3 ? Grid{7, 4, 4} : Grid{9, 5, 5}));
    const EngineTexture& bricks = filled.texture(texture);
    const std::uint64_t side = last + 1;
    for (std::uint64_t z = 0; z < side; ++z) {
      for (std::uint64_t y = 0; y < side; ++y) {
        EXPECT_EQ(
            std::memcmp(at(bricks, last, y, z), at(bricks, side, y, z), bricks.desc.record.bytes),
            0)
            << name << " " << y << " " << z;
      }
    }
  }
}

TEST(EngineTextures, CellsNameTheirBricks) {
  Scene scene = busy_room();
  scene.grid = {9, 5, 13};
  const Filled filled(layout_of("unreal-vlm"), scene, 8);
  const EngineTexture& cells = filled.texture("Indirection");
  ASSERT_EQ(extent(cells.desc), (Extent{2, 1, 3}));
  for (unsigned cell = 0; cell < 6; ++cell) {
    const std::byte* texel = at(cells, cell % 2, 0, cell / 2);
    EXPECT_EQ(std::to_integer<unsigned>(texel[0]), cell);
    EXPECT_EQ(std::to_integer<unsigned>(texel[1]), 0U);
    EXPECT_EQ(std::to_integer<unsigned>(texel[2]), 0U);
    EXPECT_EQ(std::to_integer<unsigned>(texel[3]), 1U);
  }
}

TEST(EngineTextures, TooManyProbesAreRefused) {
  const EngineLayout& layout = layout_of("unity-apv");
  EXPECT_EQ(probes_of(layout, {64, 64, 61}), (Grid{64, 64, 61}));
  EXPECT_EQ(probes_of(layout, {63, 62, 60}), (Grid{64, 64, 61}));
  EXPECT_THROW((void)probes_of(layout, {63, 64, 65}), tools::Error);
}

TEST(EngineTextures, TexelsAreTheNearest) {
  const auto stored = [](Format format, std::array<float, 4> values) {
    std::array<std::byte, 16> texel{};
    store_texel(format, texel.data(), values);
    return texel;
  };
  EXPECT_EQ(stored(Format::B8G8R8A8_UNORM, {1, 0.5F, 0, 2})[0], std::byte{0});
  EXPECT_EQ(stored(Format::B8G8R8A8_UNORM, {1, 0.5F, 0, 2})[1], std::byte{128});
  EXPECT_EQ(stored(Format::B8G8R8A8_UNORM, {1, 0.5F, 0, 2})[2], std::byte{255});
  EXPECT_EQ(stored(Format::B8G8R8A8_UNORM, {1, 0.5F, 0, 2})[3], std::byte{255});
  EXPECT_EQ(stored(Format::R8G8B8A8_SNORM, {-1, 1, 0, -9})[0], std::byte{0x81});
  EXPECT_EQ(stored(Format::R8G8B8A8_SNORM, {-1, 1, 0, -9})[1], std::byte{0x7F});
  EXPECT_EQ(stored(Format::R8G8B8A8_SNORM, {-1, 1, 0, -9})[3], std::byte{0x81});
  EXPECT_EQ(stored(Format::R8G8B8A8_UINT, {1, 7, 300, 0})[1], std::byte{7});
  EXPECT_EQ(stored(Format::R8G8B8A8_UINT, {1, 7, 300, 0})[2], std::byte{255});
  EXPECT_EQ(halves(stored(Format::R16G16B16A16_SFLOAT, {1, -2, 0, 0.5F}).data()),
            (std::array<float, 4>{1, -2, 0, 0.5F}));
}

}  // namespace
}  // namespace gicodec::ddgi
