#include "probe_server.h"

#include "ddgi/framing.h"
#include "dump/dump.h"
#include "dump/error.h"

#include <gicodec/probes.h>

#include <chrono>
#include <cmath>
#include <utility>

namespace gicodec::probes {
namespace {

using ddgi::DdgiVolume;
using ddgi::ProbeTextures;
using ddgi::Vec3;
using ddgi::VolumeShape;

/// A camera-locked volume stays where it is until the viewer is so many cells off its middle, so
/// that it does not go back and forth.
constexpr double kSlack = 0.75;

/// A texture as it is shown.
struct Shown {
  std::string name;
  TextureDesc desc;
  std::span<const std::byte> texels;
  std::optional<ddgi::Encoding> encoding = {};  ///< of colour
};

/// The tracer's own: color, vis, and spherical harmonics.
std::vector<Shown> own_textures(const ProbeTextures& t) {
  std::vector<Shown> all{{"color", t.color_desc, t.color, t.encoding},
                         {"vis", t.visibility_desc, t.visibility}};
  for (const ddgi::ShTexture& sh : t.sh) all.push_back({sh.name, sh.desc, sh.texels});
  return all;
}

std::vector<Shown> engine_textures(const ddgi::EngineTextures& engine, ddgi::Encoding encoding) {
  std::vector<Shown> all;
  for (const ddgi::EngineTexture& texture : engine.textures())
    all.push_back({texture.name, texture.desc, texture.texels});
  // The first of a layout of probes is their colour.
  if (engine.volume().kind == kKindProbes) all.front().encoding = encoding;
  return all;
}

/// What a dump of it says, but for scene and time.
tools::DumpInfo info_of(const Shown& texture, const VolumeShape& shape) {
  const auto text = [](Vec3 v) { return fmt::format("{} {} {}", v.x, v.y, v.z); };
  const Record& record = texture.desc.record;
  tools::DumpInfo info = tools::make_info(texture.desc);
  // Alpha of unorm is 0 everywhere.
  if (texture.encoding && record.components[0].type == ComponentType::unorm)
    info.channels.alpha = false;
  set_attribute(info.attributes, {tools::kOriginAttribute, "v3f", text(shape.origin)});
  set_attribute(info.attributes, {tools::kSpacingAttribute, "v3f", text(shape.spacing)});
  if (texture.encoding && *texture.encoding != ddgi::usual_encoding(record.format)) {
    set_attribute(info.attributes,
                  {tools::kEncodingAttribute, "string", std::string(to_string(*texture.encoding))});
  }
  return info;
}

VolumeDesc volume_of(const std::vector<Shown>& textures) {
  std::vector<NamedTexture> named;
  for (const Shown& texture : textures) named.push_back({texture.name, texture.desc, {}, {}});
  return tools::take(probe_volume(named), "probes");
}

BlockMask mask_of(std::span<const std::uint32_t> probes, std::size_t count) {
  BlockMask mask(count);
  for (const std::uint32_t probe : probes) mask[probe] = 1;
  return mask;
}

bool off_middle(const VolumeGeometry& g, const Position& eye) {
  const std::array<std::uint32_t, 3> sides{g.grid.x, g.grid.y, g.grid.z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double cell = (double{eye[axis]} - g.origin[axis]) / g.spacing[axis];
    if (std::abs(cell - g.scroll[axis] - (sides[axis] - 1) / 2.0) > kSlack) return true;
  }
  return false;
}

/// Layouts of bricks have whole ones.
ddgi::Scene fitted(ddgi::Scene scene, const EngineLayout* layout) {
  if (layout != nullptr) scene.grid = ddgi::probes_of(*layout, scene.grid);
  return scene;
}

}  // namespace

ProbeServer::ProbeServer(ddgi::Scene scene, const ProbeOptions& options, unsigned threads,
                         std::function<bool()> cancelled)
    : options_(options),
      scene_(fitted(std::move(scene), options.layout)),
      pool_(threads, std::move(cancelled)),
      rays_(scene_),
      world_(rays_, ddgi::spread(scene_.grid, scene_.volume), options.trace, pool_) {
  if (options.layout != nullptr) engine_.emplace(*options.layout, scene_.grid);
  if (!options.fine) return;
  const float s = options.fine->spacing;
  fine_geometry_ = VolumeGeometry{options.fine->grid, {0, 0, 0}, {s, s, s}, {0, 0, 0}};
}

std::vector<kinds::FeedVolume> ProbeServer::volumes() const {
  const VolumeShape& shape = world_.shape();
  const auto shown = engine_ ? engine_textures(*engine_, options_.trace.forms.encoding)
                             : own_textures(world_.textures());
  kinds::FeedVolume world;
  world.name = engine_ ? std::string(options_.layout->name) : "world";
  world.desc = engine_ ? engine_->volume() : volume_of(shown);
  world.geometry.grid = shown.front().desc.grid;
  if (world.geometry.grid == shape.grid) world.geometry = ddgi::geometry_of(shape);
  for (const Shown& texture : shown) world.files.push_back(info_of(texture, shape));
  if (engine_) {
    world.layout = options_.layout->name;
    world.bounds = ddgi::lit_box(*options_.layout, shape);
  }
  std::vector<kinds::FeedVolume> all{std::move(world)};
  if (!fine_geometry_) return all;
  const ProbeTextures fine(fine_geometry_->grid, options_.trace.forms);
  all.push_back({"fine", *fine_geometry_, volume_of(own_textures(fine))});
  return all;
}

std::vector<std::string> ProbeServer::remarks() const {
  const VolumeShape& shape = world_.shape();
  const auto active = world_.active_probes().size();
  std::vector<std::string> remarks{fmt::format(
      "{} probes, {} active ({:.1f} %), {} triangles", tools::to_string(shape.grid), active,
      100.0 * static_cast<double>(active) / shape.probes(), scene_.triangle_count())};
  if (engine_) {
    remarks.push_back(fmt::format(
        "gicodec encode takes what gicodec decode makes of it by --layout {} --grid {}",
        options_.layout->name, tools::to_string(ddgi::layout_grid(*options_.layout, shape.grid))));
  }
  if (active > 0) return remarks;
  const ddgi::Box box = ddgi::outer_box(scene_.bounds());
  remarks.push_back(
      fmt::format("all {} probes stand inside of solids, so all frames are black; "
                  "--bounds={:g},{:g},{:g},{:g},{:g},{:g} reaches around the scene",
                  shape.probes(), box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z));
  return remarks;
}

void ProbeServer::remark(const ddgi::UpdateStatistics& update, std::vector<std::string>& remarks) {
  if (!begun_ && !world_.active_probes().empty() && !any_light(world_.textures())) {
    remarks.emplace_back(
        "the first frame's colour is black: no light reaches a probe; --start chooses another "
        "time, --bounds another place");
  }
  const bool converges = options_.trace.mode == ddgi::TraceMode::converged;
  if (converges && !still_bouncing_ && update.bounces >= options_.trace.max_bounces) {
    still_bouncing_ = true;
    remarks.push_back(fmt::format("light still bounced after {} bounces", update.bounces));
  }
}

kinds::FeedFrame ProbeServer::next(const kinds::FeedRequest& request) {
  const auto start = std::chrono::steady_clock::now();
  kinds::FeedFrame frame;
  frame.time = request.time;
  if (!begun_ && options_.trace.mode == ddgi::TraceMode::noisy) {
    for (std::uint32_t i = 0; i < options_.warmup; ++i) world_.update(request.time);
  }
  const ddgi::UpdateStatistics update = world_.update(request.time);
  frame.rays = update.probe_rays + update.shadow_rays;
  remark(update, frame.remarks);
  begun_ = true;
  if (engine_) engine_->fill(world_.textures(), world_.active_probes());
  const auto shown = engine_ ? engine_textures(*engine_, options_.trace.forms.encoding)
                             : own_textures(world_.textures());
  kinds::FeedFrame::Volume& world = frame.volumes.emplace_back();
  // Blocks of layouts without probes are all there.
  if (!engine_ || engine_->volume().kind == kKindProbes)
    world.active = mask_of(world_.active_probes(), world_.shape().probes());
  for (const Shown& texture : shown)
    world.textures.emplace_back(texture.texels.begin(), texture.texels.end());
  if (fine_geometry_) {
    const Position eye = request.viewers.empty()
                             ? ddgi::position(scene_.camera_at(request.time).eye)
                             : request.viewers.front().eye;
    frame.volumes.push_back(trace_fine(eye, request.time));
  }
  frame.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return frame;
}

kinds::FeedFrame::Volume ProbeServer::trace_fine(const Position& eye, double time) {
  VolumeGeometry& g = *fine_geometry_;
  if (!fine_ || off_middle(g, eye)) {
    g.scroll = scroll_to(g, eye);
    ddgi::TraceOptions options = options_.trace;
    options.mode = ddgi::TraceMode::converged;  // What enters has no past to blend with.
    fine_ = std::make_unique<DdgiVolume>(rays_, ddgi::shape_of(g), options, pool_);
  }
  fine_->update(time);
  const auto places = blocks_by_cell(g);
  kinds::FeedFrame::Volume volume{g.scroll, BlockMask(places.size()), {}};
  for (const std::uint32_t probe : fine_->active_probes()) volume.active[places[probe]] = 1;
  for (const Shown& from : own_textures(fine_->textures())) {
    auto& to = volume.textures.emplace_back(from.texels.size());
    std::vector<std::byte> block(ddgi::bytes_of_block(from.desc));
    for (const std::uint32_t probe : fine_->active_probes()) {
      ddgi::read_block(from.desc, from.texels, probe, block);
      ddgi::write_block(from.desc, to, places[probe], block);
    }
  }
  return volume;
}

}  // namespace gicodec::probes
