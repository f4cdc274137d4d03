#include "ray_scene.h"

#include "dump/error.h"

#include <embree3/rtcore.h>

#include <limits>

namespace gicodec::ddgi {
namespace {

constexpr float kMaxAlbedo = 0.9F;  // energy must leave the multi-bounce iteration
constexpr float kOffset = 1e-3F;    // metres that secondary rays start off a surface

/// A mesh with what the shading of a hit needs.
struct Geometry {
  Mesh mesh;
  std::uint32_t object = 0, number = 0;  ///< by the scene's numbers
  bool turned = false;                   ///< its triangles' second and third corner are exchanged
  float uv_per_metre = 0;
};

struct DeviceDeleter {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneDeleter {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<RTCDeviceTy, DeviceDeleter>;
using EmbreeScene = std::unique_ptr<RTCSceneTy, SceneDeleter>;

/// Square root of the ratio of texture area to surface area.
float uv_density(const Mesh& mesh) {
  double surface = 0, texture = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto& p = mesh.positions;
    surface += length(cross(p[b] - p[a], p[c] - p[a]));
    const Vec2 o = mesh.uvs[a], u = mesh.uvs[b], v = mesh.uvs[c];
    texture += std::abs((u.x - o.x) * (v.y - o.y) - (u.y - o.y) * (v.x - o.x));
  }
  return surface > 0 ? static_cast<float>(std::sqrt(texture / surface)) : 0;
}

Mesh transformed(const Mesh& mesh, const Affine& m) {
  Mesh out = mesh;
  for (Vec3& p : out.positions) p = m.point(p);
  for (Vec3& n : out.normals) n = normalize(m.normal(n));
  if (m.determinant() < 0) {
    for (auto& t : out.triangles) std::swap(t[1], t[2]);
  }
  return out;
}

/// Where a ray crosses a triangle's plane. Embree says which triangle is hit; its distance rests
/// on approximate reciprocals, which differ from processor to processor.
struct Crossing {
  float distance, u, v;
  Vec3 normal;
};

Crossing cross_plane(Vec3 origin, Vec3 direction, const std::array<Vec3, 3>& p) {
  struct D3 {
    double x, y, z;
  };
  const auto minus = [](Vec3 a, Vec3 b) {
    return D3{double{a.x} - b.x, double{a.y} - b.y, double{a.z} - b.z};
  };
  const auto across = [](D3 a, D3 b) {
    return D3{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  };
  const auto inner = [](D3 a, D3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; };
  const D3 e1 = minus(p[1], p[0]), e2 = minus(p[2], p[0]), d = minus(direction, {});
  const D3 n = across(e1, e2), to = minus(origin, p[0]);
  const double nn = inner(n, n), t = -inner(to, n) / inner(d, n);
  const D3 q{to.x + t * d.x, to.y + t * d.y, to.z + t * d.z};
  const double u = inner(across(q, e2), n) / nn, v = inner(across(e1, q), n) / nn,
               l = std::sqrt(nn);
  return {static_cast<float>(t),
          static_cast<float>(u),
          static_cast<float>(v),
          {static_cast<float>(n.x / l), static_cast<float>(n.y / l), static_cast<float>(n.z / l)}};
}

/// Numbers beyond which Embree ends the program, NaN among them; scenes end long before.
bool is_near(Vec3 v) {
  constexpr float kFar = 1e15F;
  return std::abs(v.x) < kFar && std::abs(v.y) < kFar && std::abs(v.z) < kFar;
}
bool can_cast(Vec3 origin, Vec3 direction) { return is_near(origin) && is_near(direction); }
bool can_place(const Affine& m) {
  return is_near(m.x) && is_near(m.y) && is_near(m.z) && is_near(m.t);
}

RTCRayHit make_ray(Vec3 o, Vec3 d, float far) {
  RTCRayHit query{};
  query.ray.org_x = o.x, query.ray.org_y = o.y, query.ray.org_z = o.z;
  query.ray.dir_x = d.x, query.ray.dir_y = d.y, query.ray.dir_z = d.z;
  query.ray.tfar = far;
  query.ray.mask = ~0U;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return query;
}

}  // namespace

struct RayScene::State {
  /// One BVH and its place in the world: all that never moves, or one dynamic object.
  struct Part {
    EmbreeScene scene;
    std::vector<Geometry> geometries;  ///< by Embree's geometry number
    RTCGeometry instance = nullptr;    ///< owned by `world`
    std::uint32_t object = 0;          ///< of a dynamic part
    Affine transform;
  };

  const Scene& source;
  Device device;
  EmbreeScene world;
  std::vector<Part> parts;  ///< by instance number; the first is static and not moved
  FrameState state;

  explicit State(const Scene& scene) : source(scene) {}

  void check(const char* what) const {
    if (rtcGetDeviceError(device.get()) != RTC_ERROR_NONE) {
      tools::fail(tools::Exit::internal, "Embree failed to {}", what);
    }
  }

  void add_part(Part part) {
    part.scene.reset(rtcNewScene(device.get()));
    rtcSetSceneFlags(part.scene.get(), RTC_SCENE_FLAG_ROBUST);
    for (Geometry& geometry : part.geometries) {
      Mesh& mesh = geometry.mesh;
      geometry.uv_per_metre = uv_density(mesh);
      // Embree reads 16 bytes at each vertex.
      mesh.positions.reserve(mesh.positions.size() + 2);
      RTCGeometry g = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
      rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                 mesh.positions.data(), 0, sizeof(Vec3), mesh.positions.size());
      rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                 mesh.triangles.data(), 0, 12, mesh.triangles.size());
      rtcCommitGeometry(g);
      rtcAttachGeometry(part.scene.get(), g);
      rtcReleaseGeometry(g);
    }
    rtcCommitScene(part.scene.get());
    check("build a scene");

    part.instance = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(part.instance, part.scene.get());
    place(part);
    rtcAttachGeometry(world.get(), part.instance);
    rtcReleaseGeometry(part.instance);
    parts.push_back(std::move(part));
  }

  static void place(const Part& part) {
    rtcSetGeometryTransform(part.instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, &part.transform);
    rtcCommitGeometry(part.instance);
  }

  [[nodiscard]] Surface surface(const RTCRayHit& query, Vec3 origin, Vec3 direction,
                                float spread) const {
    const Part& part = parts[query.hit.instID[0]];
    const Geometry& geometry = part.geometries[query.hit.geomID];
    const Mesh& mesh = geometry.mesh;
    const auto [a, b, c] = mesh.triangles[query.hit.primID];
    const bool still = part.instance == parts.front().instance;
    const auto vertex = [&](std::uint32_t i) {
      return still ? mesh.positions[i] : part.transform.point(mesh.positions[i]);
    };
    const Crossing at = cross_plane(origin, direction, {vertex(a), vertex(b), vertex(c)});
    const float u = at.u, v = at.v, w = 1 - u - v;
    const Vec3 normal = mesh.normals[a] * w + mesh.normals[b] * u + mesh.normals[c] * v;

    Surface s;
    s.distance = std::isfinite(at.distance) ? at.distance : query.ray.tfar;
    s.position = origin + direction * s.distance;
    const bool mirrored = !still && part.transform.determinant() < 0;
    s.geometric_normal = mirrored ? -at.normal : at.normal;
    s.normal = normalize(still ? normal : part.transform.normal(normal));
    const Material& material = source.materials[mesh.material];
    if (dot(s.geometric_normal, direction) > 0) {
      if (material.two_sided) {
        s.geometric_normal = -s.geometric_normal;
        s.normal = -s.normal;
      } else {
        s.back = true;
      }
    }
    s.albedo = material.colour;
    if (material.image >= 0) {
      const Vec2 ta = mesh.uvs[a], tb = mesh.uvs[b], tc = mesh.uvs[c];
      const Vec2 uv{ta.x * w + tb.x * u + tc.x * v, ta.y * w + tb.y * u + tc.y * v};
      s.albedo = s.albedo * source.images[static_cast<std::size_t>(material.image)].sample(
                                uv, spread * s.distance * geometry.uv_per_metre);
    }
    s.albedo = min(s.albedo, {kMaxAlbedo, kMaxAlbedo, kMaxAlbedo});
    s.emission = state.emission[mesh.material];
    s.object = geometry.object;
    s.mesh = geometry.number;
    s.triangle = query.hit.primID;
    s.u = geometry.turned ? v : u;
    s.v = geometry.turned ? u : v;
    return s;
  }
};

RayScene::RayScene(const Scene& scene) : state_(std::make_unique<State>(scene)) {
  State& s = *state_;
  // Wider instruction sets round differently; one thread keeps the build order fixed.
  s.device.reset(rtcNewDevice("threads=1,isa=sse4.2"));
  if (!s.device) tools::fail(tools::Exit::internal, "Embree cannot be started on this machine");
  s.world.reset(rtcNewScene(s.device.get()));
  rtcSetSceneFlags(s.world.get(), RTC_SCENE_FLAG_ROBUST);

  State::Part fixed;
  std::vector<State::Part> moving;
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
    const Object& object = scene.objects[i];
    State::Part part;
    part.object = i;
    part.transform = object.transform;
    for (const std::uint32_t mesh : object.meshes) {
      if (object.dynamic) {
        part.geometries.push_back({scene.meshes[mesh], i, mesh});
      } else {
        fixed.geometries.push_back({transformed(scene.meshes[mesh], object.transform), i, mesh,
                                    object.transform.determinant() < 0});
      }
    }
    if (object.dynamic) moving.push_back(std::move(part));
  }
  s.parts.reserve(1 + moving.size());
  s.add_part(std::move(fixed));
  for (State::Part& part : moving) s.add_part(std::move(part));
  set_state(scene.state_at(0));
}

RayScene::~RayScene() = default;

void RayScene::set_state(FrameState state) {
  State& s = *state_;
  s.state = std::move(state);
  for (std::size_t i = 1; i < s.parts.size(); ++i) {
    State::Part& part = s.parts[i];
    const Affine& transform = s.state.transforms[part.object];
    if (!can_place(transform)) continue;
    part.transform = transform;
    State::place(part);
  }
  rtcCommitScene(s.world.get());
  s.check("move the scene's objects");
}

const FrameState& RayScene::state() const noexcept { return state_->state; }
const Scene& RayScene::scene() const noexcept { return state_->source; }

std::optional<Surface> RayScene::intersect(Vec3 origin, Vec3 direction, float spread) const {
  if (!can_cast(origin, direction)) return std::nullopt;
  RTCRayHit query = make_ray(origin, direction, std::numeric_limits<float>::infinity());
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(state_->world.get(), &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return state_->surface(query, origin, direction, spread);
}

bool RayScene::behind_static_surface(Vec3 origin, Vec3 direction) const {
  if (!can_cast(origin, direction)) return false;
  RTCRayHit query = make_ray(origin, direction, std::numeric_limits<float>::infinity());
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(state_->parts.front().scene.get(), &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  const Vec3 normal{query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z};
  const Mesh& mesh = state_->parts.front().geometries[query.hit.geomID].mesh;
  return dot(normal, direction) > 0 && !state_->source.materials[mesh.material].two_sided;
}

bool RayScene::occluded(Vec3 origin, Vec3 direction, float distance) const {
  if (!can_cast(origin, direction)) return false;
  RTCRay ray = make_ray(origin, direction, distance).ray;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(state_->world.get(), &context, &ray);
  return ray.tfar < 0;
}

Vec3 leave(const Surface& surface, Vec3 normal) {
  const float side = dot(surface.geometric_normal, normal) < 0 ? -kOffset : kOffset;
  return surface.position + surface.geometric_normal * side;
}

}  // namespace gicodec::ddgi
