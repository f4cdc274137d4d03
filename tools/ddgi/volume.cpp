#include "volume.h"

#include "dump/block_place.h"

#include <gicodec/probes.h>

#include <algorithm>
#include <cstring>

namespace gicodec::ddgi {

Vec3 VolumeShape::position(std::uint32_t probe) const {
  const std::uint32_t y = probe / grid.x % grid.y, z = probe / grid.x / grid.y;
  const Vec3 cell{static_cast<float>(probe % grid.x), static_cast<float>(y), static_cast<float>(z)};
  return origin + cell * spacing;
}

VolumeGeometry geometry_of(const VolumeShape& shape) {
  return {shape.grid, ddgi::position(shape.origin), ddgi::position(shape.spacing), {}};
}

VolumeShape shape_of(const VolumeGeometry& g) {
  VolumeShape shape{g.grid, vec(g.origin), vec(g.spacing)};
  const Vec3 cells{static_cast<float>(g.scroll[0]), static_cast<float>(g.scroll[1]),
                   static_cast<float>(g.scroll[2])};
  shape.origin += cells * shape.spacing;
  return shape;
}

VolumeShape spread(Grid grid, const Box& box) {
  const auto step = [](float size, std::uint32_t n) {
    return n > 1 ? size / static_cast<float>(n - 1) : size;
  };
  const Vec3 size = box.size();
  VolumeShape shape{
      grid, box.lo, {step(size.x, grid.x), step(size.y, grid.y), step(size.z, grid.z)}};
  // A single layer stands in the middle.
  if (grid.x == 1) shape.origin.x += size.x / 2;
  if (grid.y == 1) shape.origin.y += size.y / 2;
  if (grid.z == 1) shape.origin.z += size.z / 2;
  return shape;
}

ProbeTextures::ProbeTextures(Grid grid, const TextureForms& forms)
    : color_desc(probe_texture(forms.color, grid, forms.color_core)),
      visibility_desc(probe_texture(forms.visibility, grid, forms.visibility_core)),
      encoding(forms.encoding),
      color(texture_bytes(color_desc)),
      visibility(texture_bytes(visibility_desc)),
      sh(sh_textures(forms.sh, grid)),
      light(forms.light ? std::size_t{grid.x} * grid.y * grid.z : 0) {}

namespace {

bool is_one_of(const TextureDesc& desc, std::span<const Format> formats) {
  return desc.guard_band == 1 &&
         std::find(formats.begin(), formats.end(), desc.record.format) != formats.end();
}

}  // namespace

bool any_light(const ProbeTextures& textures) {
  const Record& record = textures.color_desc.record;
  const ColorTexels format(record.format, textures.encoding);
  for (std::size_t i = 0; i < textures.color.size(); i += record.bytes) {
    const Vec3 c = format.load(&textures.color[i]);
    if (c.x > 0 || c.y > 0 || c.z > 0) return true;
  }
  return false;
}

bool is_color(const TextureDesc& desc) { return is_one_of(desc, color_formats()); }
bool is_visibility(const TextureDesc& desc) { return is_one_of(desc, visibility_formats()); }

void read_block(const TextureDesc& desc, std::span<const std::byte> texture, std::uint32_t probe,
                std::span<std::byte> block) {
  std::byte* to = block.data();
  tools::any_row(desc, probe, [&](std::size_t from, std::size_t bytes) {
    std::memcpy(to, &texture[from], bytes);
    to += bytes;
    return false;
  });
}

void write_block(const TextureDesc& desc, std::span<std::byte> texture, std::uint32_t probe,
                 std::span<const std::byte> block) {
  const std::byte* from = block.data();
  tools::any_row(desc, probe, [&](std::size_t to, std::size_t bytes) {
    std::memcpy(&texture[to], from, bytes);
    from += bytes;
    return false;
  });
}

void fill_guard_band(std::span<std::byte> block, std::uint32_t side, std::size_t texel_bytes) {
  const std::uint32_t last = side - 1, inner = side - 2;
  const auto at = [&](std::uint32_t x, std::uint32_t y) {
    return &block[(std::size_t{y} * side + x) * texel_bytes];
  };
  const auto copy = [&](std::byte* to, const std::byte* from) {
    std::memcpy(to, from, texel_bytes);
  };
  for (std::uint32_t i = 1; i <= inner; ++i) {
    copy(at(i, 0), at(last - i, 1));
    copy(at(i, last), at(last - i, inner));
    copy(at(0, i), at(1, last - i));
    copy(at(last, i), at(inner, last - i));
  }
  copy(at(0, 0), at(inner, inner));
  copy(at(last, 0), at(1, inner));
  copy(at(0, last), at(inner, 1));
  copy(at(last, last), at(1, 1));
}

}  // namespace gicodec::ddgi
