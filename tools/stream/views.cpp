#include "views.h"

#include "clock.h"
#include "common/program.h"

#include <gicodec/probes.h>

#include <algorithm>
#include <cmath>

namespace gicodec::streaming {
namespace {

using ddgi::vec;
using ddgi::Vec3;

/// Looks a little beyond the picture's edges, since cameras turn between updates.
constexpr float kWider = 1.2F;

struct Frame {
  Vec3 forward, right, up;
};

/// Safe for any numbers: comparisons with NaN choose the branch that does not use them.
Frame frame_of(const Viewpoint& view) {
  Vec3 forward = ddgi::direction_between(vec(view.eye), vec(view.target));
  if (!(length(forward) > 0)) forward = {0, 0, -1};
  Vec3 right = cross(forward, ddgi::direction_between({}, vec(view.up)));
  if (!(length(right) >= 1e-6F))
    right = cross(forward, std::abs(forward.y) < 0.9F ? Vec3{0, 1, 0} : Vec3{0, 0, 1});
  right = normalize(right);
  return {forward, right, cross(right, forward)};
}

bool near(const VolumeGeometry& g, const Position& point) {
  const std::array<std::uint32_t, 3> sides{g.grid.x, g.grid.y, g.grid.z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double cell = (double{point[axis]} - g.origin[axis]) / g.spacing[axis] - g.scroll[axis];
    if (!(cell >= -1 && cell <= sides[axis])) return false;
  }
  return true;
}

/// The cages around the point and around the points up to `margin` cells away in all directions.
void add_with_margin(const VolumeGeometry& g, const Position& point, int margin, BlockMask& mask) {
  std::vector<Position> around;
  // Every second one: a cage is two probes wide.
  for (int z = -margin; z <= margin; z += 2) {
    for (int y = -margin; y <= margin; y += 2) {
      for (int x = -margin; x <= margin; x += 2) {
        around.push_back({point[0] + static_cast<float>(x) * g.spacing[0],
                          point[1] + static_cast<float>(y) * g.spacing[1],
                          point[2] + static_cast<float>(z) * g.spacing[2]});
      }
    }
  }
  add_shading_probes(g, around, mask);
}

/// The bricks that the picture needs.
BlockMask cut(const ViewedVolume& volume, const Viewpoint& view, std::span<const Position> points) {
  constexpr float kRows = 720;
  const float tangent = std::tan(std::clamp(view.fov_y, 1.0F, 150.0F) * (ddgi::kPi / 360));
  std::vector<Vec3> seen;
  seen.reserve(points.size());
  for (const Position& point : points) seen.push_back(vec(point));
  BlockMask mask =
      voxels::cut(*volume.bricks, voxels::BrickShape{volume.brick_side}, volume.geometry,
                  {.eye = vec(view.eye), .pixel = 2 * tangent / kRows}, seen);
  const BlockMask& changed = volume.changed.slots();
  for (std::size_t slot = 0; slot < changed.size(); ++slot) mask[slot] |= changed[slot];
  return mask;
}

}  // namespace

Views::Views(ddgi::Scene scene, std::uint32_t samples, std::uint32_t margin)
    : scene_(std::move(scene)),
      rays_(scene_),
      samples_(samples),
      margin_(static_cast<int>(margin)) {}

std::vector<Position> Views::hits(const Viewpoint& view) const {
  const auto [forward, right, up] = frame_of(view);
  const float aspect = std::clamp(view.aspect, 0.1F, 10.0F);
  const float tangent = kWider * std::tan(std::clamp(view.fov_y, 1.0F, 150.0F) * (ddgi::kPi / 360));
  const auto rows = static_cast<std::uint32_t>(
      std::max(1.0F, std::round(std::sqrt(static_cast<float>(samples_) / aspect))));
  const std::uint32_t columns = std::max(1U, samples_ / rows);
  std::vector<Position> points;
  for (std::uint32_t y = 0; y < rows && !tools::interrupted(); ++y) {
    for (std::uint32_t x = 0; x < columns; ++x) {
      const float sx = 2 * (static_cast<float>(x) + 0.5F) / static_cast<float>(columns) - 1;
      const float sy = 1 - 2 * (static_cast<float>(y) + 0.5F) / static_cast<float>(rows);
      const Vec3 direction =
          normalize(forward + right * (sx * tangent * aspect) + up * (sy * tangent));
      const auto hit = rays_.intersect(vec(view.eye), direction, 0);
      if (hit) points.push_back({hit->position.x, hit->position.y, hit->position.z});
    }
  }
  return points;
}

ViewResult Views::look(const ViewRequest& request) {
  const double start = now();
  rays_.set_state(scene_.state_at(request.time));
  ViewResult result;
  for (const auto& [connection, view] : request.viewers) {
    const auto points = hits(view);
    ViewResult::Seen seen{connection, {}};
    for (std::size_t v = 0; v < request.volumes.size(); ++v) {
      const VolumeGeometry& g = request.volumes[v].geometry;
      if (request.volumes[v].bricks != nullptr) {
        seen.volumes.push_back(cut(request.volumes[v], view, points));
        continue;
      }
      BlockMask mask(std::size_t{g.grid.x} * g.grid.y * g.grid.z);
      for (const Position& point : points) {
        // Points outside of a further volume are shaded by the first volume.
        if (v == 0 || near(g, point)) add_with_margin(g, point, margin_, mask);
      }
      seen.volumes.push_back(std::move(mask));
    }
    result.seen.push_back(std::move(seen));
  }
  result.seconds = now() - start;
  return result;
}

}  // namespace gicodec::streaming
