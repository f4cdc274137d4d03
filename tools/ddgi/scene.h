// What is traced: meshes, materials, objects, and how they, the lights and the sky move in time.
#pragma once

#include "image.h"
#include "vec.h"

#include <gicodec/texture.h>

#include <array>
#include <functional>
#include <string>
#include <vector>

namespace gicodec::ddgi {

/// Units are metres; radiance and irradiance are in units in which a white surface in full sun has
/// a radiance of about 1. Y is up.

struct Material {
  std::string name;
  Vec3 colour{1, 1, 1};     ///< diffuse albedo, multiplied with the image
  std::int32_t image = -1;  ///< index in Scene::images
  Vec3 emission{};          ///< radiance; emitters are found by rays, see Light for the others
  bool two_sided = false;   ///< else rays that hit from behind see an inside
};

/// Front faces are counter-clockwise.
struct Mesh {
  std::vector<Vec3> positions, normals;
  std::vector<Vec2> uvs;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::uint32_t material = 0;
};

/// Some meshes that share a transform. Objects that never move are baked into one.
struct Object {
  std::string name;
  std::vector<std::uint32_t> meshes{};
  Affine transform{};
  bool dynamic = false;
};

enum class LightType : std::uint8_t { sun, point, spot, area };

/// Lights that are sampled with shadow rays, by the tracer and by the client. Emissive materials
/// and the sky are not among them: they reach a surface through the probes.
struct Light {
  LightType type = LightType::point;
  Vec3 colour{};  ///< sun: irradiance across the direction; point, spot: intensity; area: radiance
  Vec3 position{};                        ///< not for a sun; centre of an area light
  Vec3 direction{0, -1, 0};               ///< in which light travels; not for a point light
  float cos_inner = 1, cos_outer = 0.7F;  ///< spot: full inside, dark outside, smooth between
  Vec3 half_u{}, half_v{};                ///< area: half edges of the rectangle
};

/// Radiance of directions that hit nothing.
struct Sky {
  Vec3 zenith{}, horizon{}, ground{};
  Vec3 sun_direction{0, 1, 0};  ///< towards the sun
  Vec3 glow{};                  ///< added around the sun (no disc: that is a Light)

  [[nodiscard]] Vec3 radiance(Vec3 direction) const;
};

struct Camera {
  Vec3 eye{0, 2, 0}, target{0, 2, -1}, up{0, 1, 0};
  float fov_y = 60;    ///< degrees
  float exposure = 1;  ///< factor before tone mapping
};

/// The moving part of a scene at one time.
struct FrameState {
  std::vector<Affine> transforms;  ///< one per object
  std::vector<Vec3> emission;      ///< one per material
  std::vector<Light> lights;
  Sky sky;
};

struct Scene {
  std::string name;
  std::vector<std::string> files;  ///< that it was read from
  std::vector<Image> images;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Object> objects;
  std::vector<Light> lights;  ///< at rest
  Sky sky;                    ///< at rest

  Box volume;  ///< from the first to the last probe
  Grid grid;
  std::vector<Camera> cameras;  ///< fixed ones; used where there is no camera path
  /// Moves what moves; the state holds the scene at rest when called. May be empty.
  std::function<void(double time, FrameState& state)> animate;
  std::function<Camera(double time)> camera_path;  ///< may be empty

  std::uint32_t add_image(Image image);
  std::uint32_t add_material(Material material);
  /// Adds a mesh and returns its index.
  std::uint32_t add_mesh(Mesh mesh);
  std::uint32_t add_object(Object object);

  [[nodiscard]] FrameState state_at(double time) const;
  [[nodiscard]] Camera camera_at(double time) const;
  [[nodiscard]] std::size_t triangle_count() const;  ///< objects that share a mesh count each
  [[nodiscard]] Box bounds() const;                  ///< at rest
};

}  // namespace gicodec::ddgi
