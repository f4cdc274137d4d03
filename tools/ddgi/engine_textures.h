// The textures of an engine's layout (<gicodec/engines.h>), filled from a traced volume.
#pragma once

#include "volume.h"

#include <gicodec/engines.h>

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gicodec::ddgi {

/// The probes that have to be traced for a layout: the grid, or the least one above it that is made
/// of whole bricks. Throws tools::Error of Exit::usage if those are too many.
[[nodiscard]] Grid probes_of(const EngineLayout& layout, Grid wanted);
/// What the layout counts in a volume of that many probes: its --grid.
[[nodiscard]] Grid layout_grid(const EngineLayout& layout, Grid probes);
/// The box that a volume lights, least corner first; nullopt for light maps, and for layouts whose
/// geometry says it.
[[nodiscard]] std::optional<std::array<double, 6>> lit_box(const EngineLayout& layout,
                                                           const VolumeShape& shape);
/// What the tracer's own textures have to be. `encoding`: of colour, where it is octahedral.
[[nodiscard]] TextureForms forms_of(const EngineLayout& layout);

struct EngineTexture {
  std::string name;
  TextureDesc desc;
  std::vector<std::byte> texels;  ///< tightly packed
};

class EngineTextures {
 public:
  /// `probes` as probes_of() gives them; they must outlive none of this.
  EngineTextures(const EngineLayout& layout, Grid probes);

  [[nodiscard]] const VolumeDesc& volume() const noexcept { return volume_; }
  [[nodiscard]] std::span<const EngineTexture> textures() const noexcept { return textures_; }

  /// `traced`: with the forms of forms_of().
  void fill(const ProbeTextures& traced, std::span<const std::uint32_t> active);

 private:
  void fill_probes(const ProbeTextures& traced, const std::vector<std::uint8_t>& active);

  const EngineLayout& layout_;
  Grid probes_;
  VolumeDesc volume_;
  std::vector<EngineTexture> textures_;
};

}  // namespace gicodec::ddgi
