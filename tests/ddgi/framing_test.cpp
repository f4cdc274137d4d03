// Volume and camera of scenes that bring none: flat, solid, closed and dark.
#include "ddgi/framing.h"
#include "ddgi/client_renderer.h"
#include "rooms.h"

#include <gtest/gtest.h>

namespace gicodec::ddgi {
namespace {

Scene with_sun(Scene s) {
  s.lights.push_back(
      {.type = LightType::sun, .colour = {3, 3, 3}, .direction = normalize({-0.4F, -1, -0.3F})});
  return s;
}

/// A box that is seen from outside.
Scene solid() {
  Scene s;
  MeshBuilder box(s.add_material({.name = "clay", .colour = {0.6F, 0.6F, 0.6F}}));
  box.box({-1, -1, -1}, {1, 1, 1});
  s.add_object({.name = "box", .meshes = {s.add_mesh(box.take())}});
  return with_sun(std::move(s));
}

/// A square of 8 m, of no thickness along an axis, lit from above.
Scene plane(unsigned axis) {
  Scene s;
  Mesh mesh;
  mesh.material =
      s.add_material({.name = "paper", .colour = {0.6F, 0.6F, 0.6F}, .two_sided = true});
  const auto turn = [axis](Vec3 v) {
    return axis == 0 ? Vec3{v.y, v.x, v.z} : axis == 1 ? v : Vec3{v.x, v.z, v.y};
  };
  mesh.positions = {turn({-4, 0, -4}), turn({4, 0, -4}), turn({4, 0, 4}), turn({-4, 0, 4})};
  mesh.normals.assign(4, turn({0, 1, 0}));
  mesh.uvs.resize(4);
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
  if (axis != 1) mesh.triangles = {{0, 1, 2}, {0, 2, 3}};  // exchanging axes mirrors
  s.add_object({.name = "plane", .meshes = {s.add_mesh(std::move(mesh))}});
  return with_sun(std::move(s));
}

float brightest(const RayScene& rays, const Camera& camera) {
  ThreadPool pool(1);
  const Picture picture = render(rays, nullptr, camera, {32, 18, 1, RenderMode::direct}, pool);
  float most = 0;
  for (const Vec3 p : picture.pixels) most = std::max({most, p.x, p.y, p.z});
  return most;
}

TEST(Framing, FlatScenesGetAThickVolume) {
  for (const unsigned axis : {0U, 1U, 2U}) {
    Scene scene = plane(axis);
    const RayScene rays(scene);
    const Box box = find_volume(rays);
    const VolumeShape shape = spread({8, 8, 8}, box);
    const Vec3 step = shape.spacing;
    EXPECT_GT(std::min({step.x, step.y, step.z}), 0.1F) << axis;
    ThreadPool pool(1);
    EXPECT_EQ(classify_probes(rays, shape, 0.25F, pool).size(), 512U) << axis;
    const auto view = find_view(rays);
    ASSERT_TRUE(view) << axis;
    EXPECT_TRUE(view->lit) << axis;
    EXPECT_GT(brightest(rays, view->camera), 0.1F) << axis;
  }
}

TEST(Framing, ASolidIsSeenFromOutside) {
  const Scene scene = solid();
  const RayScene rays(scene);
  const Box volume = find_volume(rays);
  ThreadPool pool(1);
  EXPECT_FALSE(classify_probes(rays, spread({4, 4, 4}, volume), 0.25F, pool).empty());
  EXPECT_TRUE(
      classify_probes(rays, spread({4, 4, 4}, inner_box(scene.bounds())), 0.25F, pool).empty());
  const auto view = find_view(rays);
  ASSERT_TRUE(view);
  EXPECT_TRUE(view->lit);
  EXPECT_GT(length(view->camera.eye), 1.8F);
  EXPECT_GT(brightest(rays, view->camera), 0.1F);
}

TEST(Framing, ARoomIsSeenFromInside) {
  Scene scene = test::busy_room();
  const RayScene rays(scene);
  const Box box = inner_box(scene.bounds()), volume = find_volume(rays);
  EXPECT_EQ(volume.lo, box.lo);
  EXPECT_EQ(volume.hi, box.hi);
  const auto view = find_view(rays);
  ASSERT_TRUE(view);
  EXPECT_TRUE(view->lit);
  EXPECT_EQ(max(min(view->camera.eye, box.hi), box.lo), view->camera.eye);
  EXPECT_GT(brightest(rays, view->camera), 0.01F);
}

TEST(Framing, NoLightIsNoticed) {
  // The sun does not reach into a closed room, and a view of its outside shows surfaces from
  // behind.
  Scene scene = with_sun(test::room({2, 2, 2}, 0.5F, 0));
  const RayScene rays(scene);
  const auto view = find_view(rays);
  ASSERT_TRUE(view);
  EXPECT_FALSE(view->lit);
}

}  // namespace
}  // namespace gicodec::ddgi
