#include "source.h"

#include "clock.h"
#include "ddgi/dump_folder.h"
#include "ddgi/program.h"
#include "ddgi/scene_id.h"
#include "dump/error.h"

#include <gicodec/probes.h>

#include <cmath>
#include <memory>

namespace gicodec::streaming {
namespace {

using ddgi::DdgiVolume;
using ddgi::Vec3;

/// A camera-locked volume stays where it is until the viewer is so many cells off its middle, so
/// that it does not go back and forth.
constexpr double kSlack = 0.75;

Position position(Vec3 v) { return {v.x, v.y, v.z}; }

BlockMask mask_of(std::span<const std::uint32_t> probes, std::size_t count) {
  BlockMask mask(count);
  for (const std::uint32_t probe : probes) mask[probe] = 1;
  return mask;
}

/// Where the volume's first probe stands now.
ddgi::VolumeShape shape_of(const VolumeGeometry& g) {
  const auto at = [&](std::size_t axis) {
    return g.origin[axis] + static_cast<float>(g.scroll[axis]) * g.spacing[axis];
  };
  return {g.grid, {at(0), at(1), at(2)}, {g.spacing[0], g.spacing[1], g.spacing[2]}};
}

SourceVolume describe(std::string name, const VolumeGeometry& geometry) {
  const std::vector<NamedTexture> textures{{ddgi::kColorName, ddgi_irradiance(geometry.grid)},
                                           {ddgi::kVisibilityName, ddgi_visibility(geometry.grid)}};
  return {std::move(name), geometry, tools::take(probe_volume(textures), "probes")};
}

class Tracer {
 public:
  Tracer(const ddgi::SceneFlags& flags, const ddgi::TraceOptions& options,
         const std::optional<FineVolume>& fine, unsigned threads)
      : options_(options),
        scene_(ddgi::load_scene(flags)),
        pool_(threads, ddgi::interrupted),
        rays_(scene_),
        world_(rays_, ddgi::volume_of(flags, scene_), options, pool_) {
    if (!fine) return;
    const float s = fine->spacing;
    fine_geometry_ = VolumeGeometry{fine->grid, {0, 0, 0}, {s, s, s}, {0, 0, 0}};
  }

  [[nodiscard]] std::vector<SourceVolume> volumes() const {
    const ddgi::VolumeShape& shape = world_.shape();
    std::vector<SourceVolume> all{
        describe("world", {shape.grid, position(shape.origin), position(shape.spacing), {}})};
    if (fine_geometry_) all.push_back(describe("fine", *fine_geometry_));
    return all;
  }

  [[nodiscard]] const ddgi::Scene& scene() const { return scene_; }

  SourceFrame next(const SourceRequest& request) {
    const double start = now();
    SourceFrame frame;
    frame.time = request.time;
    world_.update(request.time);
    const ddgi::ProbeTextures& t = world_.textures();
    frame.volumes.push_back(
        {{}, mask_of(world_.active_probes(), world_.shape().probes()), {t.color, t.visibility}});
    if (fine_geometry_) {
      const Position eye = request.viewers.empty() ? position(scene_.camera_at(request.time).eye)
                                                   : request.viewers.front().eye;
      frame.volumes.push_back(trace_fine(eye, request.time));
    }
    frame.seconds = now() - start;
    return frame;
  }

 private:
  SourceFrame::Volume trace_fine(const Position& eye, double time) {
    VolumeGeometry& g = *fine_geometry_;
    if (!fine_ || off_middle(g, eye)) {
      g.scroll = scroll_to(g, eye);
      ddgi::TraceOptions options = options_;
      options.mode = ddgi::TraceMode::converged;  // What enters has no past to blend with.
      fine_ = std::make_unique<DdgiVolume>(rays_, shape_of(g), options, pool_);
    }
    fine_->update(time);
    const auto places = blocks_by_cell(g);
    const ddgi::ProbeTextures& from = fine_->textures();
    ddgi::ProbeTextures to(g.grid);
    std::vector<std::byte> color(ddgi::bytes_of_block(to.color_desc));
    std::vector<std::byte> visibility(ddgi::bytes_of_block(to.visibility_desc));
    BlockMask active(places.size());
    for (const std::uint32_t probe : fine_->active_probes()) {
      ddgi::read_block(from.color_desc, from.color, probe, color);
      ddgi::write_block(to.color_desc, to.color, places[probe], color);
      ddgi::read_block(from.visibility_desc, from.visibility, probe, visibility);
      ddgi::write_block(to.visibility_desc, to.visibility, places[probe], visibility);
      active[places[probe]] = 1;
    }
    return {g.scroll, std::move(active), {std::move(to.color), std::move(to.visibility)}};
  }

  static bool off_middle(const VolumeGeometry& g, const Position& eye) {
    const std::array<std::uint32_t, 3> sides{g.grid.x, g.grid.y, g.grid.z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double cell = (double{eye[axis]} - g.origin[axis]) / g.spacing[axis];
      if (std::abs(cell - g.scroll[axis] - (sides[axis] - 1) / 2.0) > kSlack) return true;
    }
    return false;
  }

  ddgi::TraceOptions options_;
  ddgi::Scene scene_;
  ddgi::ThreadPool pool_;
  ddgi::RayScene rays_;
  DdgiVolume world_;
  std::optional<VolumeGeometry> fine_geometry_;
  std::unique_ptr<DdgiVolume> fine_;
};

}  // namespace

Source trace_source(const ddgi::SceneFlags& scene, const ddgi::TraceOptions& options,
                    const std::optional<FineVolume>& fine, unsigned threads) {
  auto tracer = std::make_shared<Tracer>(scene, options, fine, threads);
  return {tracer->volumes(), ddgi::scene_id(ddgi::scene_label(scene), tracer->scene()), false,
          [tracer](const SourceRequest& request) { return tracer->next(request); }};
}

}  // namespace gicodec::streaming
