#include "volume_words.h"

#include "dump/dump.h"
#include "dump/error.h"

#include <gicodec/textures.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace gicodec::tools {
namespace {

constexpr std::array<const char*, kComponentTypes> kKinds = {
    "unorm", "snorm", "uint", "ufloat", "sfloat", "exponent", "opaque"};
constexpr std::string_view kOffBy = "off by at most ", kRelatively = " relatively";

}  // namespace

std::string volume_name(const ContainerDescription& description, std::size_t volume) {
  const std::string& name = description.volumes[volume].name;
  return name.empty() ? fmt::format("{}", volume) : name;
}

std::string volume_choice(const ContainerDescription& description, std::size_t volume) {
  const std::string& name = description.volumes[volume].name;
  const auto named = [&](const std::string& text) {
    return std::ranges::count(description.volumes, text, &VolumeEntry::name);
  };
  if (!name.empty() && named(name) == 1) return name;
  std::string number = fmt::format("{}", volume);
  while (named(number) == 1) number.insert(0, 1, '0');  // it is another volume's name
  return number;
}

std::size_t find_volume(const ContainerDescription& description, const std::string& text,
                        const std::string& path) {
  const auto& volumes = description.volumes;
  const auto found = std::ranges::find(volumes, text, &VolumeEntry::name);
  const auto named = std::ranges::count(volumes, text, &VolumeEntry::name);
  if (!text.empty() && named == 1) return static_cast<std::size_t>(found - volumes.begin());
  std::size_t number = 0;
  const char* const end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, number);
  if (parsed.ec == std::errc{} && parsed.ptr == end && number < volumes.size()) return number;
  if (named > 1) {
    fail(Exit::bad_input,
         "{}: {} volumes are called {}; take one by its number, 0 to {}, in the order of \"gicodec "
         "info {}\"",
         path, named, text, volumes.size() - 1, path);
  }
  std::string known;
  for (std::size_t i = 0; i < volumes.size(); ++i) {
    known += (i == 0 ? "" : ", ") + volume_choice(description, i);
  }
  fail(Exit::bad_input, "{}: has no volume {}, only {}", path, text, known);
}

std::string kind_text(std::uint8_t kind) {
  const Kind* known = find_kind(kind);
  return known == nullptr ? fmt::format("unknown kind {}", kind) : std::string(known->name);
}

bool is_drawn(const VolumeEntry& volume) noexcept {
  return volume.kind != kKindTextures && find_kind(volume.kind) != nullptr;
}

std::string unknown_kind(const ContainerDescription& description, std::size_t volume) {
  const std::uint8_t kind = description.volumes[volume].kind;
  if (find_kind(kind) != nullptr) return "";
  return fmt::format("volume {} is of kind {}, which this program does not know",
                     volume_name(description, volume), kind);
}

std::string no_dump(const ContainerDescription& description, const TextureEntry& texture) {
  const std::uint8_t kind = description.volumes[texture.volume].kind;
  if (find_kind(kind) == nullptr) {
    return unknown_kind(description, texture.volume) +
           "; \"gicodec info\" lists it, \"gicodec verify\" checks its packets";
  }
  if (find_format(texture.desc.record.format) == nullptr) {
    return fmt::format(
        "texture {} of volume {} has records of its kind's own, and dumps hold formats of Vulkan "
        "alone; \"gicodec info\" lists it, \"gicodec verify\" decodes it, \"gicodec preview\" "
        "shows "
        "it",
        texture.name, volume_name(description, texture.volume));
  }
  return "";
}

std::string record_text(const Record& record) {
  if (const FormatInfo* known = find_format(record.format)) return std::string(known->name);
  std::string text = fmt::format("{} bytes:", record.bytes);
  for (const Component& component : record.used()) {
    text += fmt::format("{} {} {} {}", &component == record.components.data() ? "" : ",",
                        component.name(), component.bits,
                        kKinds[static_cast<std::size_t>(component.type)]);
  }
  return text;
}

std::string shape_text(const TextureDesc& desc) {
  const Extent size = extent(desc);
  return fmt::format("{}, {}x{}{} in {}, {}", record_text(desc.record), size.width, size.height,
                     size.slices == 1 ? "" : fmt::format("x{}", size.slices), blocks_text(desc),
                     gicodec::to_string(desc.layout.tiling));
}

std::string blocks_text(const TextureDesc& desc) {
  if (!is_probes(desc)) return fmt::format("blocks of {}", block_text(desc.block));
  return fmt::format("{} probes of {} texels and {} of guard band", to_string(desc.grid),
                     block_text(desc.block), desc.guard_band);
}

std::string block_text(const BlockShape& block) {
  const std::string flat = fmt::format("{}x{}", block.x, block.y);
  return block.z == 1 ? flat : fmt::format("{}x{}", flat, block.z);
}

std::string error_text(float largest_error) {
  if (largest_error == 0) return "";
  if (std::isinf(largest_error)) return "by how much is unknown";
  return fmt::format("{}{}{}", kOffBy, largest_error, largest_error < 1 ? kRelatively : "");
}

float error_of(std::string_view text) {
  float error = 0;
  const bool bounded = text.starts_with(kOffBy);
  if (bounded) text.remove_prefix(kOffBy.size());
  const bool relative = text.ends_with(kRelatively);
  if (relative) text.remove_suffix(kRelatively.size());
  const char* const end = text.data() + text.size();
  const auto [next, failure] = std::from_chars(text.data(), end, error);
  const bool whole =
      bounded && failure == std::errc() && next == end && error > 0 && (error < 1) == relative;
  return whole ? error : std::numeric_limits<float>::infinity();
}

TextureDesc part_of(const ContainerDescription& description, const TextureEntry& texture,
                    std::uint32_t region) {
  if (region == StreamId::kWholeVolume) return texture.desc;
  return region_texture(texture.desc, description.volumes[texture.volume].region, region);
}

}  // namespace gicodec::tools
