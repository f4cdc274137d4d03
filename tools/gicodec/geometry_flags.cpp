#include "geometry_flags.h"

#include "dump/error.h"
#include "named_value.h"

#include <algorithm>
#include <charconv>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string_view>

namespace gicodec::tools {
namespace {

std::string tilings() {
  std::string names;
  for (std::uint8_t i = 0; i < kTilingCount; ++i) {
    names += (i > 0 ? ", " : "") + std::string(to_string(static_cast<Tiling>(i)));
  }
  return names;
}

std::string format_names() {
  std::string names;
  for (const FormatInfo& format : formats()) {
    names += (names.empty() ? "" : ", ") + std::string(format.name);
  }
  return names;
}

std::optional<std::uint16_t> parse_number(std::string_view text) {
  std::uint16_t value = 0;
  const char* const end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, value);
  if (parsed.ec != std::errc{} || parsed.ptr != end || value > kMaxBlockSide) return std::nullopt;
  return value;
}

std::optional<std::uint16_t> parse_guard_band(std::string_view text) {
  const auto width = parse_number(text);
  return width && *width > 1 ? std::nullopt : width;
}

std::optional<Tiling> parse_tiling(std::string_view text) {
  const auto tiling = tiling_from_string(text);
  if (!tiling) return std::nullopt;
  return *tiling;
}

std::optional<Format> parse_format(std::string_view text) {
  const FormatInfo* format = find_format(text);
  if (format == nullptr) return std::nullopt;
  return format->record.format;
}

/// "R=irr.R,G=irr.G".
std::optional<std::map<char, std::string>> parse_channels(std::string_view text) {
  std::map<char, std::string> channels;
  std::set<std::string_view> names;
  while (!text.empty()) {
    const std::string_view item = text.substr(0, text.find(','));
    text.remove_prefix(std::min(text.size(), item.size() + 1));
    const bool letter = item.size() > 2 && item[1] == '=' &&
                        std::string_view("RGBAE").find(item[0]) != std::string_view::npos;
    if (!letter || !names.insert(item.substr(2)).second) return std::nullopt;
    if (!channels.emplace(item[0], item.substr(2)).second) return std::nullopt;
  }
  if (channels.empty()) return std::nullopt;
  return channels;
}

}  // namespace

void add_geometry_flags(Command& command, GeometryFlags& flags) {
  const std::string group =
      "What the files hold (overrides their attributes; NAME= for one texture)";
  const auto add = [&](const char* name, std::vector<std::string>& values, const char* help,
                       const char* type) {
    command.add_option(name, values, help)->type_name(type)->group(group)->expected(1)->take_all();
  };
  add("--grid", flags.grid, "Probe grid, e.g. 16x8x32", "[NAME=]XxYxZ");
  add("--core", flags.core,
      "Texels per block side without guard band; default: from the image's size", "[NAME=]N");
  add("--guard-band", flags.guard_band, "Width of the guard band, 0 or 1; default 1", "[NAME=]N");
  add("--tiling", flags.tiling, ("Where blocks stand: " + tilings()).c_str(), "[NAME=]TILING");
  add("--vk-format", flags.format,
      ("Texel format: " + format_names() + "; default: from the channels").c_str(),
      "[NAME=]FORMAT");
  add("--channels", flags.channels,
      "Which of the files' channels to take, e.g. R=irr.R,G=irr.G,B=irr.B; default: R, G, B, A",
      "[NAME=]R=CHANNEL,...");
}

Hints hints_for(const GeometryFlags& flags, const std::string& texture) {
  Hints hints;
  hints.grid = value_for(flags.grid, texture, "--grid", "probes in x, y and z such as 16x8x32",
                         [](std::string_view text) { return grid_from_string(text); });
  const std::string number = fmt::format("0 to {}", kMaxBlockSide);
  hints.core = value_for(flags.core, texture, "--core", number, parse_number);
  hints.guard_band =
      value_for(flags.guard_band, texture, "--guard-band", "0 or 1", parse_guard_band);
  hints.tiling = value_for(flags.tiling, texture, "--tiling", tilings(), parse_tiling);
  hints.format = value_for(flags.format, texture, "--vk-format", format_names(), parse_format);
  hints.channels =
      value_for(flags.channels, texture, "--channels",
                "R, G, B, A or E and a channel each, such as R=irr.R,G=irr.G", parse_channels, true)
          .value_or(hints.channels);
  return hints;
}

void check_names(const GeometryFlags& flags, const std::vector<Sequence>& textures) {
  std::vector<std::string> names;
  for (const Sequence& texture : textures) names.push_back(texture.name);
  check_value_names(flags.grid, "--grid", names);
  check_value_names(flags.core, "--core", names);
  check_value_names(flags.guard_band, "--guard-band", names);
  check_value_names(flags.tiling, "--tiling", names);
  check_value_names(flags.format, "--vk-format", names);
  check_value_names(flags.channels, "--channels", names, true);
}

}  // namespace gicodec::tools
