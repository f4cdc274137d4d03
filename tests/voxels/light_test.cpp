// The client's light: what the server has, of what arrived.
#include "dump/error.h"
#include "octrees.h"

#include <gicodec/photons.h>

#include <gtest/gtest.h>

namespace gicodec::voxels {
namespace {

VoxelOptions few(const ddgi::Scene& scene, VoxelForm form) {
  VoxelOptions options;
  options.size = 1;
  options.form = form;
  options.gather.rays = 4;
  options.gather.warmup = 1;
  options.box = scene.bounds();
  return options;
}

TEST(VoxelLight, IsTheServersField) {
  const ddgi::Scene scene = ddgi::test::busy_room();
  for (const VoxelForm form : test::kForms) {
    VoxelServer server(scene, few(scene, form), 2, {});
    server.update(1);
    const test::Held held(server.pool(), form, server.geometry());
    VoxelLight light(held.desc, 3);
    held.show(light);
    ddgi::Random random(3);
    std::size_t lit = 0;
    for (int i = 0; i < 300; ++i) {
      ddgi::Surface surface;
      surface.position = test::random_point(random, -9, 9);
      surface.normal = test::random_direction(random);
      surface.distance = 100;
      const Vec3 value = light.irradiance({surface, {}, 0, 0});
      EXPECT_EQ(value, server.field().irradiance(surface.position, surface.normal, 0));
      lit += value == Vec3{} ? 0 : 1;
    }
    EXPECT_GT(lit, 200U);
  }
}

TEST(VoxelLight, LooksUpVoxelsAsWideAsPixels) {
  const auto form = VoxelForm::halves;
  const BrickPool pool = test::pooled(test::random_octree(20, 0.2F, 5, 4, form), {4}, form);
  const test::Held held(pool, form, test::geometry(pool.slots()));
  VoxelLight light(held.desc, 4), fine(held.desc, 0);
  held.show(light);
  held.show(fine);
  const ddgi::Scene scene = ddgi::test::busy_room();
  const ddgi::RayScene rays(scene);
  ddgi::ThreadPool threads(1);
  ddgi::PictureView view{{}, 320, 180};
  view.camera.fov_y = 90;
  light.prepare(rays, view, threads);
  fine.prepare(rays, view, threads);
  ddgi::Surface surface;
  surface.position = {1, 4, 3}, surface.normal = {0, 1, 0}, surface.distance = 27;
  const Vec3 value = light.irradiance({surface, {}, 0, 0});
  EXPECT_EQ(value,
            light.field().irradiance(surface.position, surface.normal, 27 * (2.0F / 180) * 4));
  const Vec3 finest = fine.irradiance({surface, {}, 0, 0});
  EXPECT_EQ(finest, light.field().irradiance(surface.position, surface.normal, 0));
  EXPECT_NE(value, finest);
}

TEST(VoxelLight, KnowsOnlyWhatArrived) {
  const auto form = VoxelForm::shared_exponent;
  const BrickPool pool = test::pooled(test::random_octree(20, 0.2F, 6, 8, form), {8}, form);
  test::Held held(pool, form, test::geometry(pool.slots()));
  held.received.resize(pool.slots());
  VoxelLight light(held.desc, 0);
  ddgi::Surface surface;
  surface.position = {1, 4, 3}, surface.normal = {0, 1, 0};
  held.show(light);
  EXPECT_EQ(light.irradiance({surface, {}, 0, 0}), Vec3{});
  for (std::uint32_t slot = 0; slot < pool.slots(); ++slot) {
    held.received[slot] = 1;
    held.show(light);
    EXPECT_EQ(light.field().index().entries().size(),
              std::min<std::size_t>(slot + 1, pool.slots() - 5));
    EXPECT_NE(light.irradiance({surface, {}, 0, 0}), Vec3{});
  }
}

TEST(VoxelLight, RefusesOtherVolumes) {
  const auto refused = [](const auto& make) {
    try {
      make();
    } catch (const tools::Error& error) {
      return error.code() == tools::Exit::bad_input;
    }
    return false;
  };
  EXPECT_TRUE(refused([] { VoxelLight(VolumeDesc{}, 4); }));
  VolumeDesc photons = *voxel_volume(9);
  photons.kind = kKindPhotons;
  EXPECT_TRUE(refused([&] { VoxelLight(photons, 4); }));
  const BrickPool pool(9, {4}, VoxelForm::halves);
  VoxelLight light(*voxel_volume(10, 4, VoxelForm::halves), 4);
  const test::Held other(pool, VoxelForm::halves, test::geometry(9));
  EXPECT_TRUE(refused([&] { other.show(light); }));
}

}  // namespace
}  // namespace gicodec::voxels
