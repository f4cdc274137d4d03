// The client's AO: equations 2 to 4, whatever it was sent.
#include "ao/pixel_light.h"
#include "ao/point_light.h"
#include "ao/point_server.h"
#include "ddgi/client_renderer.h"
#include "ddgi/noise.h"
#include "dump/error.h"
#include "rolling_room.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstring>

namespace gicodec::ao {
namespace {

using ddgi::Vec3;
using Textures = std::vector<std::vector<std::byte>>;

struct Held {
  Held(VolumeDesc volume, Textures contents)
      : desc(std::move(volume)), textures(std::move(contents)) {}

  void give(PointLight& light) const {
    light.update({desc, {}, kinds::held_of(desc, textures, received)}, 0);
  }

  VolumeDesc desc;
  Textures textures;
  std::vector<std::vector<std::uint8_t>> received;
};

struct Served {
  ddgi::Scene scene = test::rolling_room();
  ddgi::ThreadPool pool{2};
  ddgi::RayScene rays{scene};
  std::unique_ptr<PointServer> server;

  explicit Served(double points, double time) {
    ServerOptions options;
    options.generation.points = points;
    options.rays = 32;
    server = std::make_unique<PointServer>(scene, options, pool);
    rays.set_state(scene.state_at(time));
    server->update(rays);
  }
  [[nodiscard]] Held held() const { return {server->volume(), server->textures()}; }

  /// Surfaces all around, also of the ball.
  [[nodiscard]] std::vector<ddgi::Surface> surfaces(std::size_t count) const {
    ddgi::Random random(7);
    std::vector<ddgi::Surface> out;
    while (out.size() < count) {
      const Vec3 d = normalize(Vec3{random.in(-1, 1), random.in(-1, 1), random.in(-1, 1)});
      const auto hit = rays.intersect({1, -1, 1}, d, 0);
      if (hit && !hit->back) out.push_back(*hit);
    }
    return out;
  }
};

/// Equations 2 to 4 as they stand in the paper, over all points of the surface's instance that are
/// in the 2×2×2 nearest cells, in the instance's space. All instances but the ball do not move.
double expected(const Served& served, const ddgi::Surface& surface) {
  const auto& memory = served.server->memory();
  double sum = 0, weights = 0;
  for (const AoGrid& grid : memory.grids()) {
    if (grid.object != surface.object || grid.mesh != surface.mesh) continue;
    const ddgi::Affine& m = served.rays.state().transforms[grid.object];
    const Vec3 x = surface.position - m.t;  // Nothing turns in this scene.
    const std::array<float, 3> at{x.x, x.y, x.z};
    for (const auto& bucket : memory.buckets().subspan(grid.first_bucket, grid.buckets)) {
      for (const std::uint64_t word : bucket) {
        const auto entry = unpack_ao_entry(word);
        if (!entry) continue;
        const std::array<std::uint32_t, 3> cell{entry->cell.x, entry->cell.y, entry->cell.z};
        bool near = true;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const float middle =
              grid.origin[axis] + (static_cast<float>(cell[axis]) + 0.5F) * grid.cell;
          near = near && std::abs(middle - at[axis]) < grid.cell;
        }
        if (!near) continue;
        for (const std::uint32_t bits : memory.cells()[entry->slot]) {
          const auto point = unpack_ao_point(bits);
          if (!point) continue;
          double d2 = 0, nd = 0, nn = 0;
          const std::array<float, 3> normal{surface.normal.x, surface.normal.y, surface.normal.z};
          for (std::size_t axis = 0; axis < 3; ++axis) {
            const double d = grid.origin[axis] +
                             (double{point->place[axis]} + cell[axis]) * grid.cell - at[axis];
            d2 += d * d;
            nd += point->normal[axis] * d;
            nn += double{point->normal[axis]} * normal[axis];
          }
          const double weight = std::max(0.0, (grid.radius - std::sqrt(d2)) / grid.radius);
          if (nn <= 0.1 || nd * nd / d2 >= 0.7) continue;
          sum += weight * point->visible / 255;
          weights += weight;
        }
      }
    }
  }
  return weights > 0 ? sum / weights : 1;
}

TEST(PointLight, IsWhatTheEquationsSay) {
  const Served served(60, 1.5);
  PointLight light;
  served.held().give(light);
  std::size_t ball = 0, dark = 0;
  for (const ddgi::Surface& surface : served.surfaces(400)) {
    const float visible = light.visible(surface);
    EXPECT_NEAR(visible, expected(served, surface), 1e-3);
    EXPECT_EQ(light.irradiance({surface, {}, 0, 0}), (Vec3{1, 1, 1} * (kAmbientLight * visible)));
    ball += surface.object == test::kBall;
    dark += visible < 0.9F;
  }
  EXPECT_GT(ball, 10U);
  EXPECT_GT(dark, 10U);
}

TEST(PointLight, IsPlacedByTheTransformThatCame) {
  Served served(60, 1.5);
  PointLight received, own(Placement::own);
  served.held().give(received);
  served.held().give(own);
  std::vector<ddgi::Surface> ball;
  for (const ddgi::Surface& surface : served.surfaces(400)) {
    if (surface.object == test::kBall) ball.push_back(surface);
  }
  ASSERT_FALSE(ball.empty());
  std::vector<float> before;
  for (const ddgi::Surface& surface : ball) before.push_back(received.visible(surface));
  // The ball went on by a metre, and only the scene that is drawn knows.
  served.rays.set_state(served.scene.state_at(2.5));
  own.prepare(served.rays, {}, served.pool);
  std::size_t gone = 0;
  for (std::size_t i = 0; i < ball.size(); ++i) {
    ddgi::Surface moved = ball[i];
    moved.position.x += 1;
    EXPECT_NEAR(own.visible(moved), before[i], 2e-3);
    EXPECT_EQ(received.visible(ball[i]), before[i]);
    gone += received.visible(moved) == 1;
  }
  EXPECT_GT(gone, 0U);
}

TEST(PointLight, ShowsWhatDidNotComeAsOpen) {
  const Served served(60, 1.5);
  Held held = served.held();
  for (const NamedTexture& texture :
       {held.desc.groups[0].textures[0], held.desc.groups[1].textures[0],
        held.desc.groups[2].textures[0], held.desc.groups[2].textures[1]}) {
    held.received.emplace_back(block_count(texture.desc), std::uint8_t{1});
  }
  const std::vector<ddgi::Surface> surfaces = served.surfaces(50);
  PointLight light;
  for (const ddgi::Surface& surface : surfaces) EXPECT_EQ(light.visible(surface), 1);
  held.give(light);
  bool dark = false;
  for (const ddgi::Surface& surface : surfaces) dark = dark || light.visible(surface) < 1;
  EXPECT_TRUE(dark);
  for (const std::size_t texture : {2, 3}) {
    Held less = held;
    std::ranges::fill(less.received[texture], std::uint8_t{0});
    less.give(light);
    for (const ddgi::Surface& surface : surfaces) EXPECT_EQ(light.visible(surface), 1);
  }
}

RC_GTEST_PROP(PointLight, TakesAnyBytes, ()) {
  const auto volume = *ao_point_volume(9, 4, 3);
  Textures textures;
  const auto raw = rc::gen::arbitrary<std::uint8_t>();
  for (const NamedTexture* texture : textures_of(volume)) {
    const auto size = static_cast<std::size_t>(texture_bytes(texture->desc));
    const auto bytes = *rc::gen::container<std::vector<std::uint8_t>>(size, raw);
    textures.emplace_back(size);
    std::memcpy(textures.back().data(), bytes.data(), size);
  }
  // Grids that are used: else hardly any bytes mean something.
  for (std::size_t i = 0; i < 3; ++i) {
    AoGrid grid;
    if (*rc::gen::arbitrary<bool>()) {
      grid = unpack_ao_grid(std::span(textures[2]).subspan(i * kAoGridBytes).first<kAoGridBytes>());
    } else {
      grid.cells = {2, 2, 2}, grid.cell = 1, grid.radius = 3;
      grid.buckets = *rc::gen::inRange<std::uint32_t>(0, 9);
    }
    grid.cells = {grid.cells.x & 0xFFFFU, grid.cells.y & 0xFFFFU, grid.cells.z & 0xFFFFU};
    grid.object = 0, grid.mesh = static_cast<std::uint32_t>(i / 2);
    pack_ao_grid(grid, std::span(textures[2]).subspan(i * kAoGridBytes).first<kAoGridBytes>());
    const AoTransform identity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    if (*rc::gen::arbitrary<bool>()) {
      std::memcpy(&textures[3][i * kAoTransformBytes], identity.data(), kAoTransformBytes);
    }
  }
  for (std::uint32_t entry = 0; entry < 16; ++entry) {
    const std::uint64_t bits = pack_ao_entry({{entry & 1, entry >> 1 & 1, 0}, *raw});
    std::memcpy(&textures[1][16 * entry], &bits, sizeof bits);
  }
  PointLight light;
  Held(volume, textures).give(light);
  for (int i = 0; i < 30; ++i) {
    ddgi::Surface surface;
    surface.mesh = static_cast<std::uint32_t>(i % 3);
    surface.position = {0.1F * static_cast<float>(i), 0.5F, 0.7F};
    surface.normal = normalize(Vec3{0.1F, 1, 0.05F * static_cast<float>(i)});
    const float visible = light.visible(surface);
    RC_ASSERT(visible >= 0 && visible <= 1);
    surface.position = {NAN, INFINITY, -1e38F};
    RC_ASSERT(light.visible(surface) == 1);
  }
}

TEST(PointLight, RefusesOtherVolumes) {
  const Served served(20, 0);
  PointLight light;
  Held held = served.held();
  held.desc.kind = kKindProbes;
  EXPECT_THROW(held.give(light), tools::Error);
  held = served.held();
  held.textures[1].pop_back();
  EXPECT_THROW(held.give(light), tools::Error);
  held = served.held();
  held.desc.groups[0].textures[0].desc.layout = Tiling::atlas_xy_z;
  EXPECT_THROW(held.give(light), tools::Error);
}

TEST(PointLight, ComesNearWhatRaysSay) {
  const Served served(200, 1.5);
  PointLight light;
  served.held().give(light);
  const TracedLight traced(served.rays, 256, 0.6F);
  double error = 0, darkness = 0;
  const auto surfaces = served.surfaces(500);
  for (const ddgi::Surface& surface : surfaces) {
    const float right = traced.irradiance({surface, {}, 0, 0}).x / kAmbientLight;
    error += std::abs(light.visible(surface) - right);
    darkness += 1 - right;
  }
  EXPECT_LT(error, 0.5 * darkness);
}

TEST(ScreenSpaceLight, DarkensCornersAndLeavesWallsOpen) {
  const ddgi::Scene scene = ddgi::test::room({4, 3, 4}, 0.6F, 0);
  const ddgi::RayScene rays(scene);
  ddgi::ThreadPool pool(2);
  ScreenSpaceLight light(32, 0.6F);
  const ddgi::PictureView view{{.eye = {0, 0, 3}, .target = {0, -1, -4}}, 96, 64};
  light.prepare(rays, view, pool);
  const ddgi::PictureRays picture(view);
  double open = 0, corner = 0;
  int opens = 0, corners = 0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 96; ++x) {
      const float px = static_cast<float>(x) + 0.5F, py = static_cast<float>(y) + 0.5F;
      const auto hit = rays.intersect(view.camera.eye, picture.direction(px, py), 0);
      ASSERT_TRUE(hit);
      const float visible = light.irradiance({*hit, {}, px, py}).x / kAmbientLight;
      const Vec3 p = hit->position;
      const bool back = p.z < -3.99F && std::abs(p.x) < 3;
      if (back && p.y < -2.8F) corner += visible, ++corners;
      if (back && p.y > -1.5F && p.y < 1.5F) open += visible, ++opens;
    }
  }
  ASSERT_GT(corners, 0);
  ASSERT_GT(opens, 0);
  EXPECT_GT(open / opens, 0.95);
  EXPECT_LT(corner / corners, 0.9);
}

}  // namespace
}  // namespace gicodec::ao
