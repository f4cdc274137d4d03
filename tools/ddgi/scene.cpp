#include "scene.h"

namespace gicodec::ddgi {

Vec3 Sky::radiance(Vec3 d) const {
  const float up = d.y >= 0 ? std::sqrt(d.y) : 0;
  Vec3 c = d.y >= 0 ? lerp(horizon, zenith, up) : lerp(horizon, ground, smoothstep(0, 0.1F, -d.y));
  const float toward = std::max(0.0F, dot(d, sun_direction));
  const float t2 = toward * toward, t8 = t2 * t2 * t2 * t2, t32 = t8 * t8 * t8 * t8;
  if (d.y >= 0) c += glow * (t8 * 0.35F + t32 * 0.65F);
  return c;
}

std::uint32_t Scene::add_image(Image image) {
  images.push_back(std::move(image));
  return static_cast<std::uint32_t>(images.size() - 1);
}

std::uint32_t Scene::add_material(Material material) {
  materials.push_back(std::move(material));
  return static_cast<std::uint32_t>(materials.size() - 1);
}

std::uint32_t Scene::add_mesh(Mesh mesh) {
  meshes.push_back(std::move(mesh));
  return static_cast<std::uint32_t>(meshes.size() - 1);
}

std::uint32_t Scene::add_object(Object object) {
  objects.push_back(std::move(object));
  return static_cast<std::uint32_t>(objects.size() - 1);
}

FrameState Scene::state_at(double time) const {
  FrameState state;
  for (const Object& object : objects) state.transforms.push_back(object.transform);
  for (const Material& material : materials) state.emission.push_back(material.emission);
  state.lights = lights;
  state.sky = sky;
  if (animate) animate(time, state);
  return state;
}

Camera Scene::camera_at(double time) const {
  if (camera_path) return camera_path(time);
  if (!cameras.empty()) return cameras.front();
  const Box box = volume;
  return {.eye = box.center() + Vec3{0, 0.1F * box.size().y, 0.45F * box.size().z},
          .target = box.center()};
}

std::size_t Scene::triangle_count() const {
  std::size_t count = 0;
  for (const Object& object : objects) {
    for (const std::uint32_t mesh : object.meshes) count += meshes[mesh].triangles.size();
  }
  return count;
}

Box Scene::bounds() const {
  Box box;
  for (const Object& object : objects) {
    for (const std::uint32_t mesh : object.meshes) {
      for (const Vec3 p : meshes[mesh].positions) box.add(object.transform.point(p));
    }
  }
  return box;
}

}  // namespace gicodec::ddgi
