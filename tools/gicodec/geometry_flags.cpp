#include "geometry_flags.h"

#include "common/named_value.h"
#include "dump/error.h"
#include "dump/text.h"

#include <gicodec/engines.h>

#include <algorithm>
#include <array>
#include <charconv>
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

std::string format_names() { return listed(formats(), &FormatInfo::name); }

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

std::optional<Grid> parse_block(std::string_view text) {
  const auto sides = grid_from_string(text);
  if (!sides || std::max({sides->x, sides->y, sides->z}) > kMaxBlockSide) return std::nullopt;
  return sides;
}

/// Two sides, or three.
std::optional<Grid> parse_extent(std::string_view text) {
  const auto separator = text.find_first_of("x,");
  const bool flat = separator != text.npos && separator == text.find_last_of("x,");
  return grid_from_string(flat ? fmt::format("{}{}1", text, text[separator]) : std::string(text));
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

/// Parses "R=irr.R,G=irr.G".
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

std::map<char, std::string> channels_for(const GeometryFlags& flags, const std::string& texture) {
  return value_for(flags.channels, texture, "--channels",
                   "R, G, B, A or E and a channel each, such as R=irr.R,G=irr.G", parse_channels,
                   true)
      .value_or(std::map<char, std::string>{});
}

/// Names of units, by GridUnit.
constexpr std::array<const char*, 5> kUnits = {"probes", "bricks", "cells", "voxels",
                                               "texels and layers"};

std::string layout_names() { return listed(engine_layouts(), &EngineLayout::name); }

const char* unit_of(const EngineLayout& layout) {
  return kUnits[static_cast<std::size_t>(layout.unit)];
}

/// "--layout rtxgi of 8x4x8 probes".
std::string layout_words(const EngineLayout& layout, const Grid& grid) {
  return fmt::format("--layout {} of {} {}", layout.name, to_string(grid), unit_of(layout));
}

std::optional<Grid> layout_grid(const GeometryFlags& flags) {
  return flags.grid.size() == 1 ? grid_from_string(flags.grid.front()) : std::nullopt;
}

/// The grid of --grid. Throws if it is missing or invalid.
Grid required_grid(const GeometryFlags& flags, const EngineLayout& layout) {
  if (flags.grid.empty()) {
    fail(Exit::usage, "--layout {} needs --grid with its {}, such as 8x8x8", layout.name,
         unit_of(layout));
  }
  const std::string& value = flags.grid.front();
  if (flags.grid.size() > 1) {
    fail(Exit::usage, "--layout {} takes one --grid, and {} are given; leave out all but one",
         layout.name, flags.grid.size());
  }
  if (is_named(value, false)) {
    fail(Exit::usage,
         "--grid {}: the grid of --layout {} is that of all its textures; leave out {}", value,
         layout.name, value.substr(0, value.find('=') + 1));
  }
  const auto grid = layout_grid(flags);
  if (!grid) {
    fail(
        Exit::usage,
        "--grid does not take \"{}\"; --layout {} expects its {} along x, y and z, 1 or more, such "
        "as 8x8x8",
        value, layout.name, unit_of(layout));
  }
  return *grid;
}

std::optional<TextureDesc> texture_of(const VolumeDesc& volume, const std::string& name) {
  for (const NamedTexture* texture : textures_of(volume)) {
    if (texture->name == name) return texture->desc;
  }
  return std::nullopt;
}

}  // namespace

void add_geometry_flags(Command& command, GeometryFlags& flags) {
  const std::string group =
      "What the files hold (overrides their attributes; NAME= for one texture)";
  const auto add = [&](const char* name, std::vector<std::string>& values, const char* help,
                       const char* type) {
    command.add_option(name, values, help)->type_name(type)->group(group)->expected(1)->take_all();
  };
  command
      .add_option("--layout", flags.layout,
                  "How an engine keeps the textures, by their names; --grid counts its "
                  "probes, bricks, cells, voxels or texels: " +
                      layout_names())
      ->type_name("NAME")
      ->group(group);
  add("--grid", flags.grid, "Probe grid, e.g. 16x8x32", "[NAME=]XxYxZ");
  add("--core", flags.core,
      "Texels per block side without guard band; default: from the image's size", "[NAME=]N");
  add("--guard-band", flags.guard_band, "Width of the guard band, 0 or 1; default 1", "[NAME=]N");
  add("--tiling", flags.tiling, ("Where blocks stand: " + tilings()).c_str(), "[NAME=]TILING");
  add("--block", flags.block,
      "Texels of a block of a texture that is none of probes; default 8x8x1, of 3D textures 4x4x4",
      "[NAME=]XxYxZ");
  add("--extent", flags.extent,
      "Texels of such a texture; for a 3D texture or an array in an EXR, whose slices stand one "
      "below "
      "the other",
      "[NAME=]XxY[xZ]");
  add("--vk-format", flags.format,
      ("Texel format: " + format_names() + "; default: from the channels").c_str(),
      "[NAME=]FORMAT");
  add("--channels", flags.channels,
      "Which of the files' channels to take, e.g. R=irr.R,G=irr.G,B=irr.B; default: R, G, B, A",
      "[NAME=]R=CHANNEL,...");
}

std::string flags_text(const GeometryFlags& flags) {
  std::string text;
  for (const auto& [flag, values] :
       {std::pair("--grid", &flags.grid), std::pair("--core", &flags.core),
        std::pair("--guard-band", &flags.guard_band), std::pair("--tiling", &flags.tiling),
        std::pair("--block", &flags.block), std::pair("--extent", &flags.extent),
        std::pair("--vk-format", &flags.format), std::pair("--channels", &flags.channels)}) {
    for (const std::string& value : *values) text += fmt::format(" {} {}", flag, shell_word(value));
  }
  return text + (flags.layout.empty() ? "" : " --layout " + flags.layout);
}

void add_number_flags(Command& command, NumberOptions& numbers) {
  const std::string group =
      "Which numbers in names of files are frames; default: by looking at the files";
  command
      .add_flag("--stills", numbers.stills, "No other number is: each file is a texture of its own")
      ->group(group);
  command
      .add_option("--frames-from", numbers.patterns,
                  "Those where the pattern has #; * is any text, e.g. \"irr_#\"; may be repeated")
      ->type_name("PATTERN")
      ->group(group)
      ->expected(1)
      ->take_all();
}

std::optional<VolumeDesc> layout_volume(const GeometryFlags& flags) {
  if (flags.layout.empty()) return std::nullopt;
  const EngineLayout* layout = find_engine_layout(flags.layout);
  if (layout == nullptr) {
    fail(Exit::usage, "--layout does not take \"{}\"; expected {}", flags.layout, layout_names());
  }
  for (const auto& [flag, values] :
       {std::pair("--core", &flags.core), std::pair("--guard-band", &flags.guard_band),
        std::pair("--tiling", &flags.tiling), std::pair("--block", &flags.block),
        std::pair("--extent", &flags.extent), std::pair("--vk-format", &flags.format)}) {
    if (values->empty()) continue;
    fail(Exit::usage, "--layout {} says what {} says; leave out one of them", flags.layout, flag);
  }
  const Grid grid = required_grid(flags, *layout);
  auto volume = layout->make(grid);
  if (volume.status() == Status::invalid_description) {
    fail(Exit::usage,
         "{} is more than a volume holds: sides of 1 to {}, and {} blocks of all textures' each",
         layout_words(*layout, grid), kMaxGridSide, kMaxBlocks);
  }
  return take(std::move(volume), layout_words(*layout, grid));
}

std::string texture_names(const VolumeDesc& volume) {
  return listed(textures_of(volume), &NamedTexture::name);
}

Hints hints_for(const GeometryFlags& flags, const std::string& texture) {
  Hints hints;
  if (const auto volume = layout_volume(flags)) {
    hints.desc = texture_of(*volume, texture);
    if (!hints.desc) {
      fail(Exit::usage, "--layout {} has no texture {}, only {}; name the files after these",
           flags.layout, texture, texture_names(*volume));
    }
    hints.channels = channels_for(flags, texture);
    hints.agreed = layout_words(*find_engine_layout(flags.layout), *layout_grid(flags));
    return hints;
  }
  hints.grid = value_for(flags.grid, texture, "--grid", "probes in x, y and z such as 16x8x32",
                         [](std::string_view text) { return grid_from_string(text); });
  const std::string number = fmt::format("0 to {}", kMaxBlockSide);
  hints.core = value_for(flags.core, texture, "--core", number, parse_number);
  hints.guard_band =
      value_for(flags.guard_band, texture, "--guard-band", "0 or 1", parse_guard_band);
  hints.tiling = value_for(flags.tiling, texture, "--tiling", tilings(), parse_tiling);
  hints.block = value_for(
      flags.block, texture, "--block",
      fmt::format("texels in x, y and z of 1 to {}, such as 8x8x1", kMaxBlockSide), parse_block);
  hints.extent = value_for(flags.extent, texture, "--extent", "texels such as 64x32 or 64x64x32",
                           parse_extent);
  hints.format = value_for(flags.format, texture, "--vk-format", format_names(), parse_format);
  hints.channels = channels_for(flags, texture);
  return hints;
}

namespace {

/// Throws for --channels of texture files, which have no channels.
void check_channels(const GeometryFlags& flags, const std::vector<Sequence>& textures) {
  const auto has_channels = [](const Sequence& texture) {
    const auto kind = image_kind(texture.frames.front().path);
    return kind == ImageKind::exr || (kind && !is_written(*kind));
  };
  const bool any = std::ranges::any_of(textures, has_channels);
  for (const std::string& value : flags.channels) {
    const bool named = is_named(value, true);
    for (const Sequence& texture : textures) {
      if (has_channels(texture) || (named ? !value.starts_with(texture.name + "=") : any)) continue;
      fail(Exit::usage,
           "--channels {}: {} has no channels with names, since its format defines them; leave "
           "it out{}",
           value, texture.frames.front().path, any ? ", or name textures that are EXR" : "");
    }
  }
}

}  // namespace

void check_names(const GeometryFlags& flags, const std::vector<Sequence>& textures) {
  std::vector<std::string> names;
  for (const Sequence& texture : textures) names.push_back(texture.name);
  check_value_names(flags.grid, "--grid", names);
  check_value_names(flags.core, "--core", names);
  check_value_names(flags.guard_band, "--guard-band", names);
  check_value_names(flags.tiling, "--tiling", names);
  check_value_names(flags.block, "--block", names);
  check_value_names(flags.extent, "--extent", names);
  check_value_names(flags.format, "--vk-format", names);
  check_value_names(flags.channels, "--channels", names, true);
  check_channels(flags, textures);
}

}  // namespace gicodec::tools
