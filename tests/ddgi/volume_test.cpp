// The traced volume: same bits whatever the threads, frozen scenes, classification, guard bands.
#include "ddgi/client_renderer.h"
#include "ddgi/rays.h"
#include "ddgi/scenes.h"
#include "rooms.h"

#include "texture/guard_band.h"

#include <gicodec/gicodec.h>
#include <gtest/gtest.h>

#include <cstring>

namespace gicodec::ddgi {
namespace {

using test::busy_room;
using test::Traced;

TEST(Volume, SameBitsWhateverTheThreads) {
  for (const TraceMode mode : {TraceMode::converged, TraceMode::noisy}) {
    ProbeTextures first;
    for (const unsigned threads : {1U, 2U, 5U}) {
      Traced traced(busy_room(), {.mode = mode, .rays = 64}, threads);
      for (const double time : {0.0, 0.1, 0.3}) traced.volume.update(time);
      if (threads == 1) {
        first = traced.volume.textures();
      } else {
        EXPECT_TRUE(traced.volume.textures() == first) << threads;
      }
    }
  }
}

TEST(Volume, BuiltInSceneSameBitsWhateverTheThreads) {
  ProbeTextures first;
  for (const unsigned threads : {1U, 3U}) {
    Scene scene = make_tomb();
    scene.grid = {4, 3, 4};
    Traced traced(std::move(scene), {.rays = 48}, threads);
    traced.volume.update(2.5);
    if (threads == 1) {
      first = traced.volume.textures();
    } else {
      EXPECT_TRUE(traced.volume.textures() == first);
    }
  }
}

TEST(Volume, ConvergedDependsOnTheSceneAlone) {
  Traced traced(busy_room(), {.rays = 64});
  traced.volume.update(1);
  const ProbeTextures before = traced.volume.textures();
  traced.volume.update(1);
  EXPECT_TRUE(traced.volume.textures() == before) << "a frozen scene changed";
  traced.volume.update(2);
  EXPECT_FALSE(traced.volume.textures() == before) << "the ball's way left no trace";
  traced.volume.update(1);
  EXPECT_TRUE(traced.volume.textures() == before) << "the past left a trace";
}

TEST(Volume, NoisyChangesAndDependsOnTheSeed) {
  const auto run = [](std::uint32_t seed, int updates) {
    Traced traced(busy_room(), {.mode = TraceMode::noisy, .rays = 64, .seed = seed});
    for (int i = 0; i < updates; ++i) traced.volume.update(0);
    return traced.volume.textures();
  };
  EXPECT_TRUE(run(1, 2) == run(1, 2));
  EXPECT_FALSE(run(1, 2) == run(1, 3));
  EXPECT_FALSE(run(1, 2) == run(2, 2));
}

TEST(Volume, ProbesInsideWallsAreInactiveAndZero) {
  Scene scene = busy_room();
  scene.grid = {8, 4, 10};
  Traced traced(std::move(scene), {.rays = 32});
  traced.volume.update(0);
  const VolumeShape& shape = traced.volume.shape();
  std::vector<bool> active(shape.probes());
  for (const std::uint32_t probe : traced.volume.active_probes()) active[probe] = true;
  const ProbeTextures& textures = traced.volume.textures();
  std::size_t inside = 0;
  std::vector<std::byte> color(bytes_of_block(textures.color_desc)),
      visibility(bytes_of_block(textures.visibility_desc));
  for (std::uint32_t probe = 0; probe < shape.probes(); ++probe) {
    const Vec3 p = shape.position(probe);
    const bool in_block =
        p.x > -5.5F && p.x < -2 && p.z > -7.5F && p.z < -3 && std::abs(p.y) < 2.9F;
    inside += in_block;
    EXPECT_EQ(active[probe], !in_block) << probe;
    read_block(textures.color_desc, textures.color, probe, color);
    read_block(textures.visibility_desc, textures.visibility, probe, visibility);
    const auto is_zero = [](const std::vector<std::byte>& block) {
      return std::all_of(block.begin(), block.end(), [](std::byte b) { return b == std::byte{}; });
    };
    EXPECT_EQ(is_zero(color) && is_zero(visibility), in_block) << probe;
  }
  EXPECT_GT(inside, 4U);
}

TEST(Volume, ProbesOnAWallAreInactive) {
  Scene scene = test::room({6, 3, 8}, 0.5F, 0);
  scene.grid = {3, 2, 2};
  scene.volume = {{-6, -2, -7}, {5, 2, 7}};
  Traced traced(std::move(scene), {.rays = 32});
  const auto active = traced.volume.active_probes();
  EXPECT_EQ(std::vector(active.begin(), active.end()),
            (std::vector<std::uint32_t>{1, 2, 4, 5, 7, 8, 10, 11}));
}

/// Compares each block's guard band with what the library's rule gives for its records.
void check_guard_bands(const TextureDesc& desc, std::span<const std::byte> texture) {
  const std::uint32_t side = side_of(desc);
  const std::size_t bytes = desc.record.bytes;
  std::vector<std::byte> block(bytes_of_block(desc)), inner, band, expected(band_bytes(desc));
  for (std::uint32_t probe = 0; probe < block_count(desc); ++probe) {
    read_block(desc, texture, probe, block);
    inner.clear();
    band.clear();
    for (std::uint32_t i = 0; i < side * side; ++i) {
      const std::uint32_t x = i % side, y = i / side;
      const bool edge = x == 0 || y == 0 || x == side - 1 || y == side - 1;
      const auto texel = std::span(block).subspan(i * bytes, bytes);
      (edge ? band : inner).insert((edge ? band : inner).end(), texel.begin(), texel.end());
    }
    band_by_rule(desc, inner.data(), expected);
    EXPECT_EQ(band, expected) << "probe " << probe;
  }
}

TEST(Volume, GuardBandsFollowTheRule) {
  for (const TraceMode mode : {TraceMode::converged, TraceMode::noisy}) {
    for (const TextureForms& forms :
         {TextureForms{}, TextureForms{.color = Format::R16G16B16A16_SFLOAT,
                          .visibility = Format::R32G32_SFLOAT,
                          .color_core = 6,
                          .visibility_core = 14}}) {
      Traced traced(busy_room(), {.mode = mode, .rays = 64, .forms = forms});
      for (int i = 0; i < 3; ++i) traced.volume.update(i);
      const ProbeTextures& t = traced.volume.textures();
      check_guard_bands(t.color_desc, t.color);
      check_guard_bands(t.visibility_desc, t.visibility);
    }
  }
}

/// Distance to the walls of a box around the origin, in closed form.
float wall_distance(Vec3 half, Vec3 from, Vec3 d) {
  const auto exit = [](float o, float dir, float h) {
    return dir > 0 ? (h - o) / dir : dir < 0 ? (-h - o) / dir : 1e30F;
  };
  return std::min(
      {exit(from.x, d.x, half.x), exit(from.y, d.y, half.y), exit(from.z, d.z, half.z)});
}

// Mean distances against an integral of the closed form with the same lobe.
TEST(Volume, DistancesMatchTheBox) {
  constexpr Vec3 half{4, 3, 5};
  Scene scene = test::room(half, 0.5F, 0.1F);
  scene.grid = {2, 2, 2};
  Traced traced(std::move(scene), {.rays = 16384});
  traced.volume.update(0);
  const ProbeTextures& t = traced.volume.textures();
  const float cap = traced.volume.shape().distance_cap();
  const auto fine = fibonacci_directions(20000);
  std::vector<std::byte> block(bytes_of_block(t.visibility_desc));
  for (const std::uint32_t probe : traced.volume.active_probes()) {
    read_block(t.visibility_desc, t.visibility, probe, block);
    const Vec3 p = traced.volume.shape().position(probe);
    for (std::uint32_t i = 0; i < 256; i += 23) {
      const std::uint32_t x = i % 16, y = i / 16;
      const Vec3 n = texel_direction(x, y, 16);
      double mean = 0, squared = 0, weight = 0;
      for (const Vec3 d : fine) {
        const double w = std::pow(std::max(0.0F, dot(n, d)), 50.0F);
        const double distance = std::min(cap, wall_distance(half, p, d));
        mean += w * distance, squared += w * distance * distance, weight += w;
      }
      const Vec2 m = load_moments(Format::R16G16_SFLOAT, core_texel(t.visibility_desc, block, i));
      EXPECT_NEAR(m.x, mean / weight, 0.02 * mean / weight) << probe << " " << i;
      EXPECT_NEAR(m.y, squared / weight, 0.04 * squared / weight) << probe << " " << i;
    }
  }
}

// Decoded textures light the scene like the originals, pixel for pixel; lost light is noticed.
TEST(Client, SameTexelsSamePicture) {
  Traced traced(busy_room(), {.rays = 64});
  traced.volume.update(1);
  const ProbeTextures& original = traced.volume.textures();
  ProbeTextures decoded = original;
  const auto through = [](const TextureDesc& desc, std::span<const std::byte> from,
                          std::span<std::byte> to) {
    auto encoder = Encoder::create(desc, {.backend = "zstd"});
    auto decoder = Decoder::create(desc);
    ASSERT_TRUE(encoder && decoder);
    Packet packet;
    ASSERT_EQ(encoder->encode_to(ConstTextureView(from), Selection::changed(), packet), Status::ok);
    std::fill(to.begin(), to.end(), std::byte{});
    ASSERT_EQ(decoder->decode(packet, TextureView{to}), Status::ok);
  };
  through(original.color_desc, original.color, decoded.color);
  through(original.visibility_desc, original.visibility, decoded.visibility);
  const auto draw = [&](const ProbeTextures& textures) {
    ProbeField field(traced.volume.shape());
    field.set_visibility(textures);
    field.set_color(textures);
    struct FieldLight final : ClientLight {
      explicit FieldLight(const ProbeField& of) : field(of) {}
      [[nodiscard]] Vec3 irradiance(const SeenSurface& seen) const override {
        return field.irradiance(seen.surface.position, seen.surface.normal, seen.to_viewer);
      }
      const ProbeField& field;
    } light(field);
    return render(traced.rays, &light, {.eye = {0, 0, 6}, .target = {0, 0, 0}},
                  {.width = 64, .height = 48, .samples = 1}, traced.pool)
        .pixels;
  };
  const auto picture = draw(original);
  EXPECT_TRUE(draw(decoded) == picture);
  for (std::size_t i = 0; i < decoded.color.size(); i += 4) decoded.color[i] &= std::byte{0xFE};
  EXPECT_FALSE(draw(decoded) == picture);
}

// A room divided by a wall with a lamp on one side: the other side must stay dark.
TEST(Client, NoLightThroughWalls) {
  Scene scene = test::room({6, 3, 4}, 0.6F, 0);
  const std::uint32_t grey = scene.add_material({.name = "grey", .colour = {0.6F, 0.6F, 0.6F}});
  MeshBuilder wall(grey);
  wall.box({-0.3F, -3, -4}, {0.3F, 3, 4});
  scene.objects[0].meshes.push_back(scene.add_mesh(wall.take()));
  scene.lights.push_back({.type = LightType::point, .colour = {9, 9, 9}, .position = {3, 0, 0}});
  scene.grid = {8, 4, 6};
  Traced traced(std::move(scene), {.rays = 256});
  traced.volume.update(0);
  ProbeField field(traced.volume.shape());
  field.set_visibility(traced.volume.textures());
  field.set_color(traced.volume.textures());
  // Of all that is seen from a point.
  const auto light_around = [&](Vec3 eye) {
    float sum = 0;
    for (const Vec3 d : fibonacci_directions(200)) {
      const auto hit = traced.rays.intersect(eye, d, 0);
      if (hit) sum += field.irradiance(hit->position, hit->back ? -hit->normal : hit->normal, -d).x;
    }
    return sum;
  };
  const float lit = light_around({3, 0.5F, 0.5F}), dark = light_around({-3, 0.5F, 0.5F});
  EXPECT_GT(lit, 1);
  EXPECT_LT(dark, 0.002F * lit);
}

TEST(Scenes, AreOfThePapersSizes) {
  const std::array<Grid, 3> grids{{{16, 8, 16}, {16, 8, 32}, {32, 4, 64}}};
  for (std::size_t i = 0; i < 3; ++i) {
    const SceneInfo& info = built_in_scenes()[i];
    const Scene scene = info.make();
    EXPECT_EQ(scene.grid, grids[i]);
    EXPECT_EQ(info.grid, grids[i]);
    EXPECT_EQ(scene.triangle_count(), info.triangles);
    EXPECT_GT(info.triangles, 50000U);
    EXPECT_GT(scene.images.size(), 5U);
    for (const Mesh& mesh : scene.meshes) {
      ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
      const auto wrong = [](Vec3 n) { return !(std::abs(length(n) - 1) <= 1e-3F); };
      ASSERT_TRUE(std::none_of(mesh.normals.begin(), mesh.normals.end(), wrong))
          << scene.name << " " << scene.materials[mesh.material].name;
    }
  }
  EXPECT_FALSE(make_scene("atrium"));
}

}  // namespace
}  // namespace gicodec::ddgi
