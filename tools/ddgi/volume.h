// The probe volume's place in the world and the two textures that hold it.
#pragma once

#include "probe_light.h"
#include "sh.h"
#include "texels.h"

#include <gicodec/volume.h>

#include <span>
#include <vector>

namespace gicodec::ddgi {

/// What the two textures are made of; as in the paper if nothing is said.
struct TextureForms {
  Format color = Format::A2R10G10B10_UNORM_PACK32;
  Format visibility = Format::R16G16_SFLOAT;
  Encoding encoding = usual_encoding(color);
  std::uint8_t color_core = 8, visibility_core = 16;  ///< texels of a block's side, no guard band
  ShForm sh = ShForm::none;
  bool light = false;  ///< also ProbeTextures::light
};

/// Most probes that are traced.
inline constexpr std::uint64_t kMaxProbes = std::uint64_t{1} << 18;

/// Probe (x, y, z) stands at origin + (x, y, z) · spacing; its index is x + nx·(y + ny·z).
struct VolumeShape {
  Grid grid;
  Vec3 origin, spacing;

  [[nodiscard]] std::uint32_t probes() const { return grid.x * grid.y * grid.z; }
  [[nodiscard]] Vec3 position(std::uint32_t probe) const;
  /// Distances beyond this are stored as this: 1.5 × the diagonal of a cell.
  [[nodiscard]] float distance_cap() const { return 1.5F * length(spacing); }
};

/// As the library has it, and back: where the first probe stands after scrolling.
[[nodiscard]] VolumeGeometry geometry_of(const VolumeShape& shape);
[[nodiscard]] VolumeShape shape_of(const VolumeGeometry& geometry);

/// The grid spread over a box, first and last probes on its faces.
[[nodiscard]] VolumeShape spread(Grid grid, const Box& box);

/// The colour texture holds irradiance over π, gamma-5 encoded in the paper's format; visibility
/// holds mean distance and mean squared distance in metres. Blocks of inactive probes are zero.
struct ProbeTextures {
  TextureDesc color_desc, visibility_desc;
  Encoding encoding = Encoding::gamma5;
  std::vector<std::byte> color, visibility;  ///< texels, tightly packed
  std::vector<ShTexture> sh;
  std::vector<ProbeLight> light;  ///< one per probe

  ProbeTextures() = default;
  /// All zero. Precondition: the descriptions are valid.
  explicit ProbeTextures(Grid grid, const TextureForms& forms = {});

  friend bool operator==(const ProbeTextures&, const ProbeTextures&) = default;
};

/// Whether a probe holds any light.
[[nodiscard]] bool any_light(const ProbeTextures& textures);

/// Whether a texture can be one of the two, by format and guard band.
[[nodiscard]] bool is_color(const TextureDesc& desc);
[[nodiscard]] bool is_visibility(const TextureDesc& desc);

/// Texels of a block's side, and bytes of a block, with its guard band.
[[nodiscard]] constexpr std::uint32_t side_of(const TextureDesc& desc) {
  return desc.block.x + 2U * desc.guard_band;
}
[[nodiscard]] constexpr std::size_t bytes_of_block(const TextureDesc& desc) {
  return std::size_t{side_of(desc)} * side_of(desc) * desc.record.bytes;
}
/// Copies the block of a probe out of a texture or into it, with its guard band.
void read_block(const TextureDesc& desc, std::span<const std::byte> texture, std::uint32_t probe,
                std::span<std::byte> block);
void write_block(const TextureDesc& desc, std::span<std::byte> texture, std::uint32_t probe,
                 std::span<const std::byte> block);
/// Core texel t of such a block.
[[nodiscard]] inline std::byte* core_texel(const TextureDesc& desc, std::span<std::byte> block,
                                           std::uint32_t t) {
  const std::uint32_t core = desc.block.x, band = desc.guard_band;
  return &block[(std::size_t{t / core + band} * side_of(desc) + t % core + band) *
                desc.record.bytes];
}
/// Fills the guard band of a block of texels of so many bytes from its core by the octahedral rule.
void fill_guard_band(std::span<std::byte> block, std::uint32_t side, std::size_t texel_bytes);

}  // namespace gicodec::ddgi
