// AO points as a feed of frames, and their settings.
#include "ao.h"
#include "point_light.h"
#include "point_server.h"

#include <fmt/core.h>

#include <array>
#include <memory>

namespace gicodec::ao {
namespace {

using kinds::Setting;

constexpr std::array<Setting, 8> kSettings{{
    {"points", "512", "generated per square metre, of which half stay, 2 to 65536"},
    {"max-points", "1000000", "that stay in all, 1 to 16000000; else there are fewer per metre"},
    {"outside", "0",
     "1: also on what stands still outside of the scene's volume and a metre around it"},
    {"rays", "64", "of a point, 1 to 4096"},
    kinds::kRaysAnew,
    {"distance", "0.6", "metres up to which surfaces occlude, 0.001 to 1000"},
    {"threshold", "4", "changes of AO up to this are not sent, in 1/255, 0 to 255"},
    {"view-margin", "180",
     "degrees around what the viewers see; points outside of all are passed over, 180: none"},
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

/// What one feed keeps from frame to frame.
struct Tracer {
  ddgi::Scene scene;
  ddgi::ThreadPool pool;
  ddgi::RayScene rays{scene};
  PointServer server;

  Tracer(kinds::TraceRequest request, const ServerOptions& options)
      : scene(std::move(request.scene)),
        pool(request.threads, std::move(request.cancelled)),
        server(scene, options, pool) {}
};

ExtendedView view_of(const Viewpoint& viewer, float margin) {
  return {{ddgi::vec(viewer.eye), ddgi::vec(viewer.target), ddgi::vec(viewer.up), viewer.fov_y},
          viewer.aspect,
          margin};
}

kinds::Feed trace(kinds::TraceRequest request) {
  const ServerOptions options = options_of(request);
  const auto margin = static_cast<float>(request.settings.number("view-margin", 0, 180));
  const auto tracer = std::make_shared<Tracer>(std::move(request), options);
  const PointServer& server = tracer->server;
  kinds::Feed feed =
      kinds::live_feed("points", server.volume(),
                       [tracer, margin](const kinds::FeedRequest& wanted, kinds::FeedFrame& frame) {
                         tracer->rays.set_state(tracer->scene.state_at(wanted.time));
                         std::vector<ExtendedView> views;
                         if (!wanted.all) {
                           for (const Viewpoint& viewer : wanted.viewers)
                             views.push_back(view_of(viewer, margin));
                         }
                         tracer->server.update(tracer->rays, views);
                         frame.volumes[0].textures = tracer->server.textures();
                       });
  feed.remarks = server.generated().remarks;
  const PointMemory::Statistics& held = server.memory().statistics();
  feed.remarks.push_back(fmt::format("{} points in {} cells of {} instances", held.points,
                                     held.cells, server.memory().grids().size()));
  if (held.overflow() > 0) {
    feed.remarks.push_back(
        fmt::format("{} points found no room: {} in a cell, {} in a bucket, {} in the pool",
                    held.overflow(), held.full_cells, held.full_buckets, held.full_pool));
  }
  return feed;
}

}  // namespace

const kinds::TracedKind kTracedAoPoints{
    "ao_points",
    "points of ambient occlusion on surfaces (Neff et al.)",
    kSettings,
    {},
    trace,
    [](const ddgi::RayScene& scene, const VolumeDesc& desc, const kinds::Settings&) {
      return make_point_light(scene, desc);
    },
    // Copies of cells and buckets, and instances.
    [](const VolumeDesc&, std::uint64_t textures) { return 3 * textures; }};

}  // namespace gicodec::ao
