#include "dump/geometry_attributes.h"

#include <fmt/core.h>

#include <algorithm>
#include <string>

namespace gicodec::tools {

Attribute sides_attribute(std::string_view name, const Grid& sides) {
  return {std::string(name), "v3i", fmt::format("{} {} {}", sides.x, sides.y, sides.z)};
}
Attribute grid_attribute(const Grid& grid) { return sides_attribute(kGrid, grid); }
Attribute int_attribute(std::string_view name, std::uint16_t value) {
  return {std::string(name), "int", fmt::format("{}", value)};
}
Attribute time_attribute(double time) {
  return {kTimeAttribute, "float", fmt::format("{}", static_cast<float>(time))};
}
Attribute tiling_attribute(Tiling tiling) {
  return {std::string(kTiling), "string", std::string(gicodec::to_string(tiling))};
}
Attribute format_attribute(Format format) {
  return {std::string(kFormat), "string", fmt::format("VK_FORMAT_{}", find_format(format)->name)};
}

bool same_meaning(const Attribute& a, const Attribute& b) {
  if (a.type != b.type) return false;
  if (a.name == kFormat) return find_format(a.value) == find_format(b.value);
  if (a.type != "v3i" && a.type != "int") return a.value == b.value;
  const auto sides = [](std::string text) {
    std::replace(text.begin(), text.end(), ' ', 'x');
    return grid_from_string(text + (text.find('x') == std::string::npos ? "x0x0" : ""), 0);
  };
  return sides(a.value) && sides(a.value) == sides(b.value);
}

void describe(Attributes& attributes, const TextureDesc& desc) {
  set_attribute(attributes, format_attribute(desc.record.format));
  if (!is_probes(desc)) {
    const Extent size = extent(desc);
    const auto side = [](std::uint64_t records) { return static_cast<std::uint32_t>(records); };
    set_attribute(attributes, sides_attribute(kExtent, {side(size.width), side(size.height),
                                                        side(size.slices)}));
    set_attribute(attributes, sides_attribute(kBlock, {desc.block.x, desc.block.y, desc.block.z}));
    return;
  }
  set_attribute(attributes, grid_attribute(desc.grid));
  set_attribute(attributes, int_attribute(kCore, desc.block.x));
  set_attribute(attributes, int_attribute(kBorder, desc.guard_band));
  set_attribute(attributes, tiling_attribute(desc.layout.tiling));
}

bool is_probes(const TextureDesc& desc) noexcept {
  return desc.space == Space::grid && desc.model == Model::stacked && desc.block.z == 1 &&
         desc.block.x == desc.block.y && desc.records == Grid{} && desc.presence == Presence::all;
}

}  // namespace gicodec::tools
