#include "probe_volume_light.h"

#include "dump/error.h"
#include "dump/text.h"

#include <algorithm>

namespace gicodec::probes {
namespace {

using ddgi::ProbeField;
using tools::Exit;
using tools::fail;

/// The texture with its probes in the order in which they stand, unknown ones zero.
std::vector<std::byte> unwrapped(const kinds::HeldTexture& texture, const VolumeGeometry& g) {
  std::vector<std::byte> out(texture.texels.size());
  std::vector<std::byte> block(ddgi::bytes_of_block(texture.desc));
  const auto probes = blocks_by_cell(g);
  for (std::uint32_t place = 0; place < probes.size(); ++place) {
    if (!texture.has(probes[place])) continue;
    ddgi::read_block(texture.desc, texture.texels, probes[place], block);
    ddgi::write_block(texture.desc, out, place, block);
  }
  return out;
}

ddgi::Encoding encoding_of(const kinds::HeldTexture& texture) {
  if (texture.encoding.empty()) return ddgi::usual_encoding(texture.desc.record.format);
  const auto encoding = ddgi::encoding_from_string(texture.encoding);
  if (!encoding) {
    fail(Exit::bad_input, "texture {}: its encoding is \"{}\", neither gamma5 nor linear",
         texture.name, tools::utf8_text(std::string(texture.encoding)));
  }
  return *encoding;
}

ProbeField field_of(const kinds::HeldVolume& volume) {
  const VolumeGeometry& g = volume.geometry;
  ddgi::ProbeTextures textures;
  for (const kinds::HeldTexture& texture : volume.textures) {
    if (ddgi::is_color(texture.desc) && textures.color.empty()) {
      textures.color_desc = texture.desc;
      textures.encoding = encoding_of(texture);
      textures.color = unwrapped(texture, g);
    } else if (ddgi::is_visibility(texture.desc) && textures.visibility.empty()) {
      textures.visibility_desc = texture.desc;
      textures.visibility = unwrapped(texture, g);
    }
  }
  if (textures.color.empty() || textures.visibility.empty()) {
    fail(Exit::bad_input,
         "probes need irradiance ({}) and visibility ({}), both with a guard band, to be drawn "
         "with a scene",
         ddgi::names_of(ddgi::color_formats()), ddgi::names_of(ddgi::visibility_formats()));
  }
  ProbeField field(ddgi::shape_of(g));
  field.set_visibility(textures);
  field.set_color(textures);
  return field;
}

}  // namespace

void ProbeVolumeLight::update(const kinds::HeldVolume& volume, double /*time*/) {
  world_ = field_of(volume);
  fine_.reset();
  if (volume.finer != nullptr) fine_ = field_of(*volume.finer);
}

ddgi::Vec3 ProbeVolumeLight::irradiance(const ddgi::SeenSurface& seen) const {
  const ddgi::Surface& hit = seen.surface;
  // From the finer volume where that has active probes around the point.
  if (fine_ && fine_->holds(hit.position)) {
    const ddgi::Cage cage = fine_->cage(hit.position, hit.normal, seen.to_viewer);
    if (std::ranges::any_of(cage.weight, [](float weight) { return weight > 0; }))
      return fine_->irradiance(cage, fine_->fetch(hit.normal));
  }
  return world_->irradiance(hit.position, hit.normal, seen.to_viewer);
}

}  // namespace gicodec::probes
