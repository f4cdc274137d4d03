#include "c/json.h"

#include <array>
#include <cmath>
#include <string>
#include <type_traits>

namespace gicodec::c {
namespace {

/// Appends nine digits, which name every float, in any locale.
void append(float value, std::string& text) {
  double digits = std::abs(double{value});  // times ten to the exponent
  int exponent = 0;
  for (; digits >= 1e9; ++exponent) digits /= 10;
  for (; digits != 0 && digits < 1e8; --exponent) digits *= 10;
  std::string number = std::to_string(std::llround(digits));
  for (; number.size() > 1 && number.back() == '0'; ++exponent) number.pop_back();
  const int point = static_cast<int>(number.size()) + exponent;  // digits before it
  if (std::signbit(value)) text += '-';
  if (point > 12 || point < -4) {
    if (number.size() > 1) number.insert(1, 1, '.');
    text.append(number).append("e").append(std::to_string(point - 1));
  } else if (exponent >= 0) {
    text.append(number).append(static_cast<std::size_t>(exponent), '0');
  } else if (point > 0) {
    text.append(number.insert(static_cast<std::size_t>(point), 1, '.'));
  } else {
    text.append("0.").append(static_cast<std::size_t>(-point), '0').append(number);
  }
}

}  // namespace

void Json::begin(std::string_view name, char bracket) {
  lead(name);
  text_ += bracket;
  first_ = true;
}

void Json::end(char bracket) {
  text_ += bracket;
  first_ = false;
}

/// A comma where it belongs, and the name.
void Json::lead(std::string_view name) {
  if (!first_) text_ += ',';
  first_ = false;
  if (name.empty()) return;
  quote(name);
  text_ += ':';
}

void Json::quote(std::string_view value) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  text_ += '"';
  if (!is_utf8(value)) value = "\xEF\xBF\xBD";
  for (const char c : value) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      text_ += '\\';
      text_ += c;
    } else if (code < 0x20 || code == 0x7F) {
      text_ += "\\u00";
      text_ += kDigits[code >> 4];
      text_ += kDigits[code & 15];
    } else {
      text_ += c;
    }
  }
  text_ += '"';
}

void Json::add(std::string_view name, std::string_view value) {
  lead(name);
  quote(value);
}

void Json::add(std::string_view name, std::uint64_t value) {
  lead(name);
  text_ += std::to_string(value);
}

void Json::add(std::string_view name, std::int64_t value) {
  lead(name);
  text_ += std::to_string(value);
}

void Json::add(std::string_view name, float value) {
  lead(name);
  if (!std::isfinite(value)) {
    text_ += "null";
    return;
  }
  append(value, text_);
}

void Json::add(std::string_view name, bool value) {
  lead(name);
  text_ += value ? "true" : "false";
}

namespace {

constexpr std::array<std::string_view, 2> kSpaces{"grid", "pool"};
constexpr std::array<std::string_view, 4> kPresences{"all", "count", "mask", "brick"};
constexpr std::array<std::string_view, 6> kModels{"none",      "stacked", "continuous",
                                                  "unordered", "octree",  "hemispheres"};
constexpr std::array<std::string_view, kComponentTypes> kTypes{
    "unorm", "snorm", "uint", "ufloat", "sfloat", "exponent", "opaque"};

/// The name of an enumerator; of a description that was never validated, perhaps its number.
template <typename Enum, std::size_t kCount>
void add_name(std::string_view name, Enum value, const std::array<std::string_view, kCount>& names,
              Json& json) {
  const auto place = static_cast<std::size_t>(value);
  if (place < kCount) return json.add(name, names[place]);
  json.add(name, std::uint64_t{place});
}

template <typename... Numbers>
void add_numbers(std::string_view name, Json& json, Numbers... numbers) {
  json.begin_array(name);
  (json.add({}, numbers), ...);
  json.end_array();
}

void add_grid(std::string_view name, const Grid& grid, Json& json) {
  add_numbers(name, json, grid.x, grid.y, grid.z);
}

template <typename Three>
void add_three(std::string_view name, const Three& three, Json& json) {
  if constexpr (std::is_same_v<Three, Scroll>) {
    add_numbers(name, json, std::int64_t{three[0]}, std::int64_t{three[1]}, std::int64_t{three[2]});
  } else {
    add_numbers(name, json, three[0], three[1], three[2]);
  }
}

void add_record(const Record& record, Json& json) {
  if (const FormatInfo* const info = find_format(record.format)) {
    return json.add("format", info->name);
  }
  json.begin_array("components");
  for (const Component& component : record.used()) {
    json.begin_object();
    json.add("name", component.name());
    json.add("offset", std::uint32_t{component.offset});
    json.add("bits", std::uint32_t{component.bits});
    add_name("type", component.type, kTypes, json);
    json.end_object();
  }
  json.end_array();
}

void add_metadata(const Metadata& metadata, Json& json) {
  json.begin_array("metadata");
  for (const auto& [name, value] : metadata) {
    json.begin_array();
    json.add({}, name);
    json.add({}, value);
    json.end_array();
  }
  json.end_array();
}

void add_geometry(const VolumeGeometry& geometry, Json& json) {
  json.begin_object("geometry");
  add_grid("grid", geometry.grid, json);
  add_three("origin", geometry.origin, json);
  add_three("spacing", geometry.spacing, json);
  add_three("scroll", geometry.scroll, json);
  json.end_object();
}

}  // namespace

void describe(const TextureDesc& desc, Json& json) {
  add_record(desc.record, json);
  json.add("record_bytes", std::uint32_t{desc.record.bytes});
  add_grid("grid", desc.grid, json);
  add_grid("block", {desc.block.x, desc.block.y, desc.block.z}, json);
  json.add("guard_band", std::uint32_t{desc.guard_band});
  add_name("space", desc.space, kSpaces, json);
  add_name("presence", desc.presence, kPresences, json);
  add_name("model", desc.model, kModels, json);
  if (desc.records != Grid{}) add_grid("records", desc.records, json);
  json.add("tiling", to_string(desc.layout.tiling));
  if (desc.layout.pad_before != 0) json.add("pad_before", std::uint32_t{desc.layout.pad_before});
  if (desc.layout.pad_after != 0) json.add("pad_after", std::uint32_t{desc.layout.pad_after});
  if (desc.layout.slots != Grid{}) add_grid("slots", desc.layout.slots, json);
}

void describe(const VolumeDesc& volume, Json& json) {
  json.begin_object();
  const Kind* const kind = find_kind(volume.kind);
  json.add("kind", kind == nullptr ? std::string_view("unknown") : kind->name);
  json.begin_array("groups");
  for (const TextureGroup& group : volume.groups) {
    json.begin_object();
    json.add("bundled", group.bundled);
    json.begin_array("textures");
    for (const NamedTexture& texture : group.textures) {
      json.begin_object();
      json.add("name", texture.name);
      describe(texture.desc, json);
      json.end_object();
    }
    json.end_array();
    json.end_object();
  }
  json.end_array();
  json.end_object();
}

void describe(const ContainerDescription& description, Json& json) {
  json.begin_object();
  json.begin_object("scene");
  json.add("name", description.scene.name);
  json.add("geometry", description.scene.geometry);
  json.end_object();
  add_metadata(description.metadata, json);
  json.begin_array("volumes");
  for (const VolumeEntry& volume : description.volumes) {
    json.begin_object();
    json.add("name", volume.name);
    const Kind* const kind = find_kind(volume.kind);
    json.add("kind", kind == nullptr ? std::string_view("unknown") : kind->name);
    if (volume.geometry) add_geometry(*volume.geometry, json);
    add_metadata(volume.metadata, json);
    json.add("first_texture", volume.first_texture);
    json.add("textures", volume.textures);
    json.end_object();
  }
  json.end_array();
  json.begin_array("textures");
  for (const TextureEntry& texture : description.textures) {
    json.begin_object();
    json.add("name", texture.name);
    json.add("volume", texture.volume);
    if (is_known(texture)) describe(texture.desc, json);
    json.add("largest_error", texture.largest_error);
    add_metadata(texture.metadata, json);
    json.end_object();
  }
  json.end_array();
  json.end_object();
}

}  // namespace gicodec::c
