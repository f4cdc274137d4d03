// Raw files: texels, and a JSON sidecar that describes them (gicodec(1), "Dumps").
#include "dump/cure.h"
#include "dump/error.h"
#include "dump/file_system.h"
#include "dump/geometry_attributes.h"
#include "dump/sequence.h"
#include "dump/text.h"
#include "dump/texture_file.h"

#include <gicodec/container.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <system_error>

namespace gicodec::tools {
namespace {

/// Not ordered_json, whose search is linear: sidecars may have many members.
using Json = nlohmann::json;

/// Members of a sidecar that are attributes with numbers.
struct Member {
  const char* name;
  const char* attribute;
  std::size_t numbers;  ///< 0: text
};
constexpr std::array<Member, 6> kMembers{{{"format", kFormat, 0},
                                          {"grid", kGrid, 3},
                                          {"core", kCore, 1},
                                          {"guard_band", kBorder, 1},
                                          {"block", kBlock, 3},
                                          {"tiling", kTiling, 0}}};

constexpr std::uint64_t kMaxSidecarBytes = std::uint64_t{1} << 20;

std::vector<std::uint32_t> numbers_of(const Json& json) {
  std::vector<std::uint32_t> numbers;
  const auto add = [&](const Json& item) {
    const bool fits = item.is_number_unsigned() && item.get<std::uint64_t>() <= UINT32_MAX;
    if (fits) numbers.push_back(item.get<std::uint32_t>());
    return fits;
  };
  if (!json.is_array()) {
    (void)add(json);
    return numbers;
  }
  for (const Json& item : json) {
    if (numbers.size() == 3 || !add(item)) return {};
  }
  return numbers;
}

class Sidecar {
 public:
  Sidecar(const std::string& path, const std::string& text) : path_(path), json_(parse(text)) {
    if (!json_.is_object()) fail(Exit::bad_input, "{}: is no JSON object", path_);
  }

  TextureHead head() {
    TextureHead head;
    for (const auto& [name, value] : json_.items()) {
      if (name == "extent") {
        set_extent(head, value);
      } else if (name == "attributes") {
        add_attributes(head.attributes, value);
      } else {
        add_member(head.attributes, name, value);
      }
    }
    if (head.texels.x == 0) {
      fail(Exit::bad_input, "{}: lacks \"extent\", such as [64, 32] or [64, 32, 16] texels", path_);
    }
    head.format_name = "none";
    return head;
  }

 private:
  /// Throws for a member that stands twice, of which JSON keeps the last.
  [[nodiscard]] Json parse(const std::string& text) const {
    std::vector<std::set<std::string>> names;
    const auto look = [&](int, Json::parse_event_t event, Json& json) {
      if (event == Json::parse_event_t::object_start) names.emplace_back();
      if (event == Json::parse_event_t::object_end) names.pop_back();
      if (event == Json::parse_event_t::key &&
          !names.back().insert(json.get<std::string>()).second) {
        fail(Exit::bad_input, "{}: member \"{}\" stands twice", path_, json.get<std::string>());
      }
      return true;
    };
    try {
      return Json::parse(text, look);
    } catch (const Json::parse_error& error) {
      const auto end = std::min(error.byte, text.size());
      const auto line =
          std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(end), '\n');
      fail(Exit::bad_input, "{}: is no JSON from line {} on", path_, line + 1);
    } catch (const Json::out_of_range&) {
      fail(Exit::bad_input, "{}: has a number that is too large", path_);
    }
  }
  void set_extent(TextureHead& head, const Json& value) {
    const auto sides = numbers_of(value);
    if (sides.size() < 2 || *std::ranges::min_element(sides) == 0) {
      fail(Exit::bad_input, "{}: \"extent\" is no list of two or three sides in texels", path_);
    }
    head.texels = {sides[0], sides[1], sides.size() > 2 ? sides[2] : 1};
    head.volume = head.texels.z > 1;
  }
  void add_attributes(Attributes& attributes, const Json& value) {
    if (!value.is_object() || value.size() > kMaxAttributes) {
      fail(Exit::bad_input, "{}: \"attributes\" is no object of at most {} texts", path_,
           kMaxAttributes);
    }
    for (const auto& [name, text] : value.items()) {
      if (name.empty()) fail(Exit::bad_input, "{}: an attribute has no name", path_);
      if (is_head_field(name)) {
        fail(Exit::bad_input, "{}: attribute {} has a name that has a meaning here", path_, name);
      }
      if (!text.is_string()) {
        fail(Exit::bad_input, "{}: attribute {} is no text; write it in quotes", path_, name);
      }
      for (const Member& member : kMembers) {
        if (name == member.attribute) {
          fail(Exit::bad_input, "{}: attribute {} is to be member \"{}\"", path_, name,
               member.name);
        }
      }
      const auto& content = text.get_ref<const std::string&>();
      const auto bytes = std::as_bytes(std::span(content));
      set_attribute(attributes, content.starts_with("0x") ? bytes_attribute(name, bytes)
                                                          : text_attribute(name, content));
    }
  }
  void add_member(Attributes& attributes, const std::string& name, const Json& value) {
    const auto* member =
        std::ranges::find_if(kMembers, [&](const Member& row) { return row.name == name; });
    if (member == kMembers.end()) {
      fail(Exit::bad_input,
           "{}: member \"{}\" is unknown; all that does not describe the texels belongs into "
           "\"attributes\"",
           path_, name);
    }
    std::string text;
    if (member->numbers == 0 && value.is_string()) text = value.get<std::string>();
    if (const auto numbers = numbers_of(value);
        member->numbers > 0 && numbers.size() == member->numbers) {
      text = fmt::format("{}", fmt::join(numbers, " "));
    }
    if (text.empty()) {
      fail(Exit::bad_input, "{}: \"{}\" is not {}", path_, name,
           member->numbers == 0   ? "a text"
           : member->numbers == 1 ? "a number"
                                  : "a list of three numbers");
    }
    set_attribute(attributes, text_attribute(member->attribute, text));
  }

  const std::string& path_;
  Json json_;
};

/// "8 8 1" as [8, 8, 1]; null for any other text.
Json numbers_json(const std::string& text) {
  Json numbers = Json::array();
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at != end) {
    std::uint32_t number = 0;
    const auto parsed = std::from_chars(at, end, number);
    if (parsed.ec != std::errc{}) return nullptr;
    numbers.push_back(number);
    at = parsed.ptr == end ? end : parsed.ptr + 1;
  }
  return numbers.size() == 1 ? numbers.front() : numbers;
}

Attribute extent_attribute(const Grid& texels) {
  return {kRawExtent, "v3i", fmt::format("{} {} {}", texels.x, texels.y, texels.z)};
}

}  // namespace

std::string raw_sidecar_path(const std::string& path, bool shared) {
  if (shared) return texture_path(path) + ".json";
  return path_text(native_path(path).replace_extension(".json"));
}

TextureHead parse_sidecar(const std::string& text, const std::string& path) {
  TextureHead head = Sidecar(path, text).head();
  set_attribute(head.attributes, extent_attribute(head.texels));
  return head;
}

TextureHead read_raw_head(TextureFile& file, const Hints& hints) {
  const std::string own = raw_sidecar_path(file.path(), false),
                    shared = raw_sidecar_path(file.path(), true);
  std::error_code error;
  const bool has_own = std::filesystem::exists(native_path(own), error),
             has_shared = std::filesystem::exists(native_path(shared), error);
  TextureHead head;
  if (!has_own && !has_shared) {
    const bool described = hints.format && hints.extent;
    if (!hints.desc && !described) {
      fail(Exit::bad_input, "{}: has no sidecar {}{} that describes it; {}", file.path(), own,
           own == shared ? "" : fmt::format(" or {} (for all frames)", shared),
           to_cure(Cure::describe_raw));
    }
    head.texels = hints.desc ? texels_of(*hints.desc) : *hints.extent;
    head.volume = !hints.desc && head.texels.z > 1;
    head.format_name = "none";
    head.attributes = {extent_attribute(head.texels), {kRawSidecar, "string", "none"}};
  } else {
    const std::string& path = has_own ? own : shared;
    TextureFile sidecar(path);
    if (sidecar.size() > kMaxSidecarBytes) {
      fail(Exit::bad_input, "{}: has more than {} bytes", path, kMaxSidecarBytes);
    }
    const auto bytes = sidecar.read(0, static_cast<std::size_t>(sidecar.size()));
    head = parse_sidecar({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, path);
    if (!has_own) set_attribute(head.attributes, {kRawSidecar, "string", "shared"});
  }
  head.bytes = file.size();
  return head;
}

void drop_implied_raw(DumpInfo& info) {
  std::erase(info.attributes, extent_attribute(texels_of(info.desc)));
}

std::string raw_sidecar(const DumpInfo& info, const std::string& path) {
  const Attribute* where = find_attribute(info.attributes, kRawSidecar);
  if (where != nullptr && where->value == "none") return "";
  Grid texels = texels_of(info.desc);
  if (const Attribute* kept = find_attribute(info.attributes, kRawExtent)) {
    const auto sides = numbers_json(kept->value);
    const auto numbers = numbers_of(sides);
    texels = {};
    if (numbers.size() == 3 && numbers[0] > 0 && numbers[1] > 0 && numbers[2] > 0) {
      texels = {numbers[0], numbers[1], numbers[2]};
    }
    const Grid records = texels.x == 0 ? Grid{} : records_of(texels, info.desc.record.format);
    if (extent(info.desc) != Extent{records.x, records.y, records.z}) {
      fail(Exit::bad_input, "{}: attribute {} is of another texture", path, kRawExtent);
    }
  }
  nlohmann::ordered_json json;
  json["format"] = std::string(find_format(info.desc.record.format)->name);
  json["extent"] = {texels.x, texels.y};
  if (texels.z > 1 || is_volume(info.desc)) json["extent"].push_back(texels.z);
  for (const Member& member : kMembers) {
    const Attribute* attribute = find_attribute(info.attributes, member.attribute);
    if (attribute == nullptr) continue;
    json[member.name] =
        member.numbers == 0 ? Json(attribute->value) : numbers_json(attribute->value);
  }
  for (const Attribute& attribute : info.attributes) {
    const bool is_member = std::ranges::any_of(
        kMembers, [&](const Member& member) { return member.attribute == attribute.name; });
    if (is_member || is_head_field(attribute.name)) continue;
    std::string text = attribute.value;
    if (attribute.value.starts_with("0x")) {
      const auto bytes = attribute_bytes(attribute, path);
      text.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    }
    if (!is_utf8(text) || !is_utf8(attribute.name)) {
      fail(Exit::bad_input, "{}: attribute {} is not text, and a sidecar holds only text", path,
           attribute.name);
    }
    json["attributes"][attribute.name] = text;
  }
  return json.dump(2) + "\n";
}

}  // namespace gicodec::tools
