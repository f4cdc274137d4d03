// AO points as a source of frames, and their settings.
#include "ao.h"
#include "point_light.h"
#include "point_server.h"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <memory>

namespace gicodec::ao {
namespace {

using kinds::Setting;

constexpr std::array<Setting, 8> kSettings{{
    {"points", "512", "generated per square metre, of which half stay, 2..65536"},
    {"max-points", "1000000", "that stay in all, 1..16000000; else there are fewer per metre"},
    {"outside", "0",
     "1: also on what stands still outside of the scene's volume and a metre around it"},
    {"rays", "64", "of a point, 1..4096"},
    {"rays-anew", "0", "1: others in each update, which makes noise"},
    {"distance", "0.6", "metres up to which surfaces occlude, 0.001..1000"},
    {"threshold", "4", "changes of AO up to this are not sent, in 1/255, 0..255"},
    {"view-margin", "180",
     "degrees around what the scene's camera sees from where the viewer is; points outside are "
     "passed over, 180: none"},
}};

ServerOptions options_of(const kinds::TraceRequest& request) {
  const kinds::Settings& set = request.settings;
  ServerOptions options;
  options.generation.points = set.number("points", 2, 65536);
  options.generation.max_points = set.whole("max-points", 1, 16000000);
  options.generation.outside = set.whole("outside", 0, 1) == 1;
  options.generation.seed = request.seed;
  options.rays = set.whole("rays", 1, 4096);
  options.rays_anew = set.whole("rays-anew", 0, 1) == 1;
  options.distance = static_cast<float>(set.number("distance", 0.001, 1000));
  options.threshold = set.whole("threshold", 0, 255);
  return options;
}

/// What one source keeps from frame to frame.
struct Tracer {
  explicit Tracer(kinds::TraceRequest request)
      : scene(std::move(request.scene)),
        pool(request.threads, std::move(request.cancelled)),
        rays(scene) {}

  ddgi::Scene scene;
  ddgi::ThreadPool pool;
  ddgi::RayScene rays;
  std::optional<PointServer> server;
  float margin = 180;
};

kinds::SourceFrame next(Tracer& tracer, const kinds::SourceRequest& request) {
  const auto start = std::chrono::steady_clock::now();
  tracer.rays.set_state(tracer.scene.state_at(request.time));
  std::optional<ExtendedView> view;
  if (request.viewer && tracer.margin < 180) {
    view.emplace();
    view->camera = tracer.scene.camera_at(request.time);
    const ddgi::Vec3 eye{(*request.viewer)[0], (*request.viewer)[1], (*request.viewer)[2]};
    view->camera.target += eye - view->camera.eye;
    view->camera.eye = eye;
    view->margin = tracer.margin;
  }
  tracer.server->update(tracer.rays, view);
  kinds::SourceFrame frame;
  frame.time = request.time;
  frame.volumes.emplace_back().textures = tracer.server->textures();
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  frame.seconds = took.count();
  return frame;
}

kinds::Source trace(kinds::TraceRequest request) {
  const ServerOptions options = options_of(request);
  const auto margin = static_cast<float>(request.settings.number("view-margin", 0, 180));
  const auto tracer = std::make_shared<Tracer>(std::move(request));
  tracer->margin = margin;
  tracer->server.emplace(tracer->scene, options, tracer->pool);
  const PointServer& server = *tracer->server;
  kinds::Source source;
  kinds::SourceVolume& volume = source.volumes.emplace_back();
  volume.name = tracer->scene.name;
  volume.desc = server.volume();
  volume.geometry.grid = volume.desc.sets.front().textures.front().desc.grid;
  source.remarks = server.generated().remarks;
  const PointMemory::Statistics& held = server.memory().statistics();
  source.remarks.push_back(fmt::format("{} points in {} cells of {} instances", held.points,
                                       held.cells, server.memory().grids().size()));
  if (held.overflow() > 0) {
    source.remarks.push_back(
        fmt::format("{} points found no room: {} in a cell, {} in a bucket, {} in the pool",
                    held.overflow(), held.full_cells, held.full_buckets, held.full_pool));
  }
  source.next = [tracer](const kinds::SourceRequest& at) { return next(*tracer, at); };
  return source;
}

}  // namespace

const kinds::TracedKind kTracedAoPoints{"ao_points",
                                        "points of ambient occlusion on surfaces (Neff et al.)",
                                        kSettings, trace, make_point_light};

}  // namespace gicodec::ao
