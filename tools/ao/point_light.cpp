#include "point_light.h"

#include "dump/error.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace gicodec::ao {
namespace {

using ddgi::Affine;
using ddgi::Vec3;

constexpr float kNormals = 0.1F;    // T_n
constexpr float kDistances = 0.7F;  // T_d
constexpr std::uint32_t kMaxInstances = 1U << 20;

Affine affine_of(const AoTransform& m) {
  return {{m[0], m[4], m[8]}, {m[1], m[5], m[9]}, {m[2], m[6], m[10]}, {m[3], m[7], m[11]}};
}

/// Precondition: the determinant is finite and not 0.
Affine inverse(const Affine& m) {
  const float scale = 1 / m.determinant();
  const Vec3 a = cross(m.y, m.z) * scale, b = cross(m.z, m.x) * scale, c = cross(m.x, m.y) * scale;
  return {{a.x, b.x, c.x},
          {a.y, b.y, c.y},
          {a.z, b.z, c.z},
          {-dot(a, m.t), -dot(b, m.t), -dot(c, m.t)}};
}

bool makes_sense(const AoGrid& grid) {
  const bool finite = std::ranges::all_of(grid.origin, [](float v) { return std::isfinite(v); });
  return finite && grid.cell > 0 && grid.radius > 0 && std::isfinite(grid.cell) &&
         std::isfinite(grid.radius);
}

/// Such a volume as it is to stand in memory.
VolumeDesc usual(const VolumeDesc& volume) {
  const auto& groups = volume.groups;
  const bool points = volume.kind == kKindAoPoints && groups.size() == 3;
  if (!points) tools::fail(tools::Exit::bad_input, "AO points: the volume is of another kind");
  const std::uint32_t instances = groups[2].textures.front().desc.grid.x;
  if (instances > kMaxInstances)
    tools::fail(tools::Exit::bad_input, "AO points: {} instances cannot be drawn; up to {} can",
                instances, kMaxInstances);
  const auto blocks = [&](std::size_t group) {
    return block_count(groups[group].textures.front().desc);
  };
  return tools::take(ao_point_volume(blocks(0), blocks(1), blocks(2)), "AO points");
}

auto key(const AoGrid& grid) { return std::pair(grid.object, grid.mesh); }

}  // namespace

void PointLight::place(Instance& instance, const Affine& to_world) {
  const float determinant = to_world.determinant();
  instance.to_world = to_world;
  instance.usable = std::isfinite(1 / determinant);
  if (instance.usable) instance.to_local = inverse(to_world);
}

const PointLight::Instance* PointLight::find(std::uint32_t object, std::uint32_t mesh) const {
  const auto found =
      std::ranges::lower_bound(instances_, std::pair(object, mesh), {},
                               [](const Instance& instance) { return key(instance.grid); });
  const bool same = found != instances_.end() && key(found->grid) == std::pair(object, mesh);
  return same && found->usable ? &*found : nullptr;
}

void PointLight::update(const kinds::HeldVolume& volume, double /*time*/) {
  kinds::check_held(volume, usual(volume.desc));
  const auto textures = volume.textures;
  cells_.resize(textures[0].texels.size() / sizeof(std::uint32_t));
  std::memcpy(cells_.data(), textures[0].texels.data(), textures[0].texels.size());
  buckets_.assign(textures[1].texels.begin(), textures[1].texels.end());

  instances_.clear();
  const std::size_t count = textures[2].texels.size() / kAoGridBytes;
  for (std::size_t i = 0; i < count; ++i) {
    if (!textures[2].has(i) || !textures[3].has(i)) continue;
    Instance instance;
    instance.grid =
        unpack_ao_grid(textures[2].texels.subspan(i * kAoGridBytes).first<kAoGridBytes>());
    AoTransform transform;
    std::memcpy(transform.data(), textures[3].texels.data() + i * kAoTransformBytes,
                kAoTransformBytes);
    place(instance, affine_of(transform));
    if (makes_sense(instance.grid)) instances_.push_back(instance);
  }
  std::ranges::stable_sort(instances_, {}, [](const Instance& i) { return key(i.grid); });
}

void PointLight::prepare(const ddgi::RayScene& scene, const ddgi::PictureView& /*view*/,
                         ddgi::ThreadPool& /*pool*/) {
  if (placement_ == Placement::received) return;
  for (Instance& instance : instances_) {
    const std::uint32_t object = instance.grid.object;
    if (object < scene.scene().objects.size() && scene.scene().objects[object].dynamic) {
      place(instance, scene.state().transforms[object]);
    }
  }
}

float PointLight::visible(const ddgi::Surface& surface) const {
  const Instance* instance = find(surface.object, surface.mesh);
  if (instance == nullptr) return 1;
  const AoGrid& grid = instance->grid;
  const Vec3 x = instance->to_local.point(surface.position);
  // Normals go the other way by the transpose of what places them.
  const Affine& m = instance->to_world;
  const Vec3 normal = ddgi::normalize(
      {dot(m.x, surface.normal), dot(m.y, surface.normal), dot(m.z, surface.normal)});
  const Vec3 origin{grid.origin[0], grid.origin[1], grid.origin[2]};
  const Vec3 at = (x - origin) / grid.cell;
  const auto near = [](float c) { return c > -1 && c <= static_cast<float>(kMaxAoGridSide); };
  if (!near(at.x) || !near(at.y) || !near(at.z)) return 1;
  const auto low = [](float c) { return static_cast<std::int32_t>(std::floor(c - 0.5F)); };
  const auto cells = static_cast<std::uint32_t>(cells_.size() / kAoCellPoints);
  float sum = 0, weights = 0;
  for (std::int32_t i = 0; i < 8; ++i) {
    // Beyond the lower side a coordinate wraps around to one that no grid has.
    const Grid cell{static_cast<std::uint32_t>(low(at.x) + (i & 1)),
                    static_cast<std::uint32_t>(low(at.y) + (i >> 1 & 1)),
                    static_cast<std::uint32_t>(low(at.z) + (i >> 2))};
    const auto slot = find_ao_cell(grid, cell, buckets_, cells);
    if (!slot) continue;
    const Vec3 corner{static_cast<float>(cell.x), static_cast<float>(cell.y),
                      static_cast<float>(cell.z)};
    for (std::size_t place = 0; place < kAoCellPoints; ++place) {
      const auto point = unpack_ao_point(cells_[*slot * kAoCellPoints + place]);
      if (!point) continue;
      const Vec3 within{point->place[0], point->place[1], point->place[2]};
      const Vec3 n{point->normal[0], point->normal[1], point->normal[2]};
      const Vec3 d = (corner + within) * grid.cell + origin - x;
      const float distance = length(d);
      const float weight = std::max(0.0F, (grid.radius - distance) / grid.radius);
      if (!(weight > 0) || !(dot(n, normal) > kNormals)) continue;
      const float along = dot(n, d);
      if (along * along >= kDistances * distance * distance && distance > 0) continue;
      sum += weight * (static_cast<float>(point->visible) / 255);
      weights += weight;
    }
  }
  return weights > 0 ? sum / weights : 1;
}

Vec3 PointLight::irradiance(const ddgi::SeenSurface& seen) const {
  return Vec3{1, 1, 1} * (kAmbientLight * visible(seen.surface));
}

std::unique_ptr<kinds::VolumeLight> make_point_light(const ddgi::RayScene& /*scene*/,
                                                     const VolumeDesc& desc) {
  static_cast<void>(usual(desc));
  return std::make_unique<PointLight>();
}

}  // namespace gicodec::ao
