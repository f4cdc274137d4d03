#include "painter.h"

#include "clock.h"
#include "common/preview_picture.h"
#include "ddgi/picture.h"
#include "ddgi/probe_client_light.h"
#include "ddgi/program.h"
#include "dump/dump.h"
#include "dump/error.h"

#include <gicodec/probes.h>

namespace gicodec::streaming {
namespace {

using ddgi::ProbeField;
using tools::Exit;
using tools::fail;

/// The texture with its probes in the order in which they stand, unknown ones zero.
std::vector<std::byte> unwrapped(const ClientTexture& texture, const VolumeGeometry& g) {
  std::vector<std::byte> out(texture.texels.size());
  std::vector<std::byte> block(ddgi::bytes_of_block(texture.desc));
  const auto probes = blocks_by_cell(g);
  for (std::uint32_t place = 0; place < probes.size(); ++place) {
    if (texture.changed[probes[place]] == 0) continue;
    ddgi::read_block(texture.desc, texture.texels, probes[place], block);
    ddgi::write_block(texture.desc, out, place, block);
  }
  return out;
}

}  // namespace

ProbeField probe_field(const ClientVolume& volume) {
  const VolumeGeometry& g = volume.geometry;
  const auto origin = [&](std::size_t axis) {
    return g.origin[axis] + static_cast<float>(g.scroll[axis]) * g.spacing[axis];
  };
  ddgi::ProbeTextures textures;
  for (const ClientTexture& texture : volume.textures) {
    if (ddgi::is_color(texture.desc) && textures.color.empty()) {
      textures.color_desc = texture.desc;
      textures.encoding = ddgi::usual_encoding(texture.desc.record.format);
      textures.color = unwrapped(texture, g);
    } else if (ddgi::is_visibility(texture.desc) && textures.visibility.empty()) {
      textures.visibility_desc = texture.desc;
      textures.visibility = unwrapped(texture, g);
    }
  }
  if (textures.color.empty() || textures.visibility.empty()) {
    fail(
        Exit::bad_input,
        "volume {}: needs irradiance ({}) and visibility ({}), both with a guard band, to be drawn "
        "with a scene",
        volume.name, ddgi::names_of(ddgi::color_formats()),
        ddgi::names_of(ddgi::visibility_formats()));
  }
  ProbeField field(
      {g.grid, {origin(0), origin(1), origin(2)}, {g.spacing[0], g.spacing[1], g.spacing[2]}});
  field.set_visibility(textures);
  field.set_color(textures);
  return field;
}

Painter::Painter(const ddgi::Scene* scene, const ddgi::RenderOptions& options, unsigned threads,
                 PictureFolder pictures, kinds::DrawingFlags drawing)
    : scene_(scene),
      options_(options),
      pictures_(std::move(pictures)),
      drawing_(std::move(drawing)),
      pool_(threads, ddgi::interrupted) {
  if (scene_ != nullptr) rays_ = std::make_unique<ddgi::RayScene>(*scene_);
}

Painter::~Painter() = default;

double Painter::draw(const ClientFrame& frame, const ddgi::Camera& camera, std::uint32_t number) {
  if (scene_ != nullptr) return draw_scene(frame, camera, number);
  for (const ClientVolume& volume : frame.volumes) {
    for (const ClientTexture& texture : volume.textures) {
      const tools::Dump dump{{texture.desc, {}, {}, {}, {}}, texture.texels};
      const auto [path, existing] = pictures_.texture(volume.name, texture.name, number);
      tools::write_preview(path, dump, {}, existing);
    }
  }
  return 0;
}

double Painter::draw_scene(const ClientFrame& frame, const ddgi::Camera& camera,
                           std::uint32_t number) {
  const auto [path, existing] = pictures_.frame(number);  // Before the work.
  const double start = now();
  if (frame.volumes.empty()) fail(Exit::bad_input, "the server has no volume");
  rays_->set_state(scene_->state_at(frame.time));
  const ClientVolume& first = frame.volumes.front();
  const ddgi::Picture picture = first.desc.kind == kKindProbes
                                    ? draw_probes(frame, camera)
                                    : draw_volume(first, frame.time, camera);
  const double seconds = now() - start;
  ddgi::write_picture(path, picture, camera.exposure, existing);
  return seconds;
}

ddgi::Picture Painter::draw_probes(const ClientFrame& frame, const ddgi::Camera& camera) {
  if (!drawing_.set.empty()) fail(Exit::usage, "--set is for other light than probes");
  const ProbeField world = probe_field(frame.volumes[0]);
  std::optional<ProbeField> fine;
  if (frame.volumes.size() > 1) fine = probe_field(frame.volumes[1]);
  ddgi::ProbeClientLight light(world, fine ? &*fine : nullptr);
  return render(*rays_, &light, camera, options_, pool_);
}

ddgi::Picture Painter::draw_volume(const ClientVolume& volume, double time,
                                   const ddgi::Camera& camera) {
  if (!light_ || instance_ != volume.instance) {
    const Kind* const kind = find_kind(volume.desc.kind);
    const kinds::TracedKind* const row =
        kind == nullptr ? nullptr : kinds::find_traced_kind(kind->name);
    if (row == nullptr) {
      fail(Exit::bad_input,
           "volume {}: is of a kind that cannot be drawn with a scene; without --scene its "
           "textures are",
           volume.name);
    }
    light_ = kinds::make_light(*row, *rays_, volume.desc, drawing_);
    instance_ = volume.instance;
  }
  std::vector<kinds::HeldTexture> textures;
  std::vector<std::vector<std::uint8_t>> received;
  for (const ClientTexture& texture : volume.textures) {
    auto& mask = received.emplace_back();
    for (const std::uint64_t serial : texture.changed) mask.push_back(serial > 0 ? 1 : 0);
    textures.push_back({texture.name, texture.desc, texture.texels, mask});
  }
  light_->update({volume.desc, volume.geometry, textures}, time);
  return render(*rays_, light_.get(), camera, options_, pool_);
}

}  // namespace gicodec::streaming
