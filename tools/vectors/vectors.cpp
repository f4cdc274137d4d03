#include "vectors.h"

#include "dump/dump.h"
#include "dump/error.h"

#include <gicodec/irradiance_vectors.h>

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace gicodec::vectors {
namespace {

using kinds::Setting;

constexpr std::array kSettings{
    Setting{"vertices", "16", "along each side of the box, 2 to 256; or three numbers NXxNYxNZ"},
    Setting{"box", "scene", "from the first vertex to the last: X,Y,Z,X,Y,Z in metres, or scene"},
    Setting{"form", "quantised", "of records: quantised, floats"},
    Setting{"rays", "256", "per vertex, 6 to 65536"},
    kinds::rays_turned("0"),
    kinds::kRaysAnew,
    kinds::kWarmup};
constexpr std::array kDrawing{
    Setting{"interpolation", "trilinear", "between vertices: trilinear, tricubic"},
    Setting{"fill", "smooth",
            "of vertices that have not arrived: none, push-pull, smooth (filtered at each level)"}};
constexpr std::array<std::string_view, 2> kInterpolations{"trilinear", "tricubic"};
constexpr std::array<std::string_view, 3> kFills{"none", "push-pull", "smooth"};
constexpr std::array<std::string_view, 2> kForms{"quantised", "floats"};

constexpr std::uint32_t kMaxVertices = 256;

Grid grid_of(const std::string& text) {
  const bool cube = text.find('x') == std::string::npos;
  const auto grid = tools::grid_from_string(cube ? fmt::format("{0}x{0}x{0}", text) : text, 2);
  if (!grid || std::max({grid->x, grid->y, grid->z}) > kMaxVertices) {
    tools::fail(tools::Exit::usage,
                "--set vertices: expected 2 to {} or three such numbers as in 32x16x32, not \"{}\"",
                kMaxVertices, text);
  }
  return *grid;
}

ddgi::Box box_of(const std::string& text, const ddgi::Scene& scene) {
  if (text == "scene") return scene.volume;
  const auto c = kinds::numbers_from_string(text, 6);
  if (c.empty() || !(c[0] < c[3] && c[1] < c[4] && c[2] < c[5])) {
    tools::fail(tools::Exit::usage,
                "--set box: expected \"scene\" or X,Y,Z,X,Y,Z with each of the last three above "
                "that of the first three, not \"{}\"",
                text);
  }
  return {{c[0], c[1], c[2]}, {c[3], c[4], c[5]}};
}

kinds::Feed trace(kinds::TraceRequest request) {
  const VectorOptions options = options_of(request.settings, request.scene, request.seed);
  const auto tracer = std::make_shared<kinds::Tracer<VectorServer>>(std::move(request), options);
  kinds::Feed feed = kinds::live_feed(
      "vectors",
      tools::take(irradiance_vector_volume(options.grid, options.floats), "irradiance vectors"),
      [tracer](const kinds::FeedRequest& wanted, kinds::FeedFrame& frame) {
        tracer->server.update(wanted.time);
        frame.volumes[0].textures = {tracer->server.texels()};
      });
  const VolumeGeometry& geometry = feed.volumes[0].geometry = tracer->server.field().geometry;
  feed.remarks.push_back(fmt::format(
      "{}x{}x{} vertices, {:.2f} x {:.2f} x {:.2f} m apart", geometry.grid.x, geometry.grid.y,
      geometry.grid.z, geometry.spacing[0], geometry.spacing[1], geometry.spacing[2]));
  return feed;
}

std::unique_ptr<kinds::VolumeLight> light(const ddgi::RayScene& /*scene*/, const VolumeDesc& desc,
                                          const kinds::Settings& drawing) {
  VectorLightOptions options;
  options.interpolation =
      static_cast<Interpolation>(drawing.choice("interpolation", kInterpolations));
  options.fill = static_cast<Fill>(drawing.choice("fill", kFills));
  return std::make_unique<VectorLight>(desc, options);
}

/// A vertex as it is looked up, and the levels and the copy that filling takes.
std::uint64_t light_memory(const VolumeDesc& desc, std::uint64_t /*textures*/) {
  constexpr std::uint64_t kVertex = 3 * sizeof(Vertex) + 32;
  return kVertex * block_count(desc.groups.front().textures.front().desc);
}

}  // namespace

constinit const kinds::TracedKind kTracedVectors{"irradiance_vectors",
                                                 "six irradiance vectors at each vertex of a grid",
                                                 kSettings,
                                                 kDrawing,
                                                 trace,
                                                 light,
                                                 light_memory};

VectorOptions options_of(const kinds::Settings& settings, const ddgi::Scene& scene,
                         std::uint32_t seed) {
  VectorOptions options;
  options.grid = grid_of(settings.text("vertices"));
  options.box = box_of(settings.text("box"), scene);
  options.floats = settings.choice("form", kForms) == 1;
  options.gather = kinds::gather_options(settings, 6, 65536, seed);
  return options;
}

}  // namespace gicodec::vectors
