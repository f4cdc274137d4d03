// Flags whose values are VALUE for all textures or NAME=VALUE for one.
#pragma once

#include "dump/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace gicodec::tools {

/// True for NAME=VALUE. A mapping itself has an equals sign: "color=R=irr.R".
inline bool is_named(std::string_view value, bool mapping) {
  const std::string_view first = value.substr(0, value.find(','));
  return std::count(first.begin(), first.end(), '=') > (mapping ? 1 : 0);
}

/// Throws Error of Exit::usage for a NAME that none of the textures has.
inline void check_value_names(const std::vector<std::string>& values, std::string_view flag,
                              const std::vector<std::string>& textures, bool mapping = false) {
  for (const std::string& value : values) {
    if (!is_named(value, mapping)) continue;
    const std::string name = value.substr(0, value.find('='));
    if (std::find(textures.begin(), textures.end(), name) == textures.end()) {
      fail(Exit::usage, "{} {}: no texture is called \"{}\"; there are {}", flag, value, name,
           fmt::join(textures, ", "));
    }
  }
}

/// The parsed value that applies to a texture. `expected`: valid values, in words.
template <typename Parse>
auto value_for(const std::vector<std::string>& values, const std::string& texture,
               std::string_view flag, std::string_view expected, const Parse& parse,
               bool mapping = false) {
  decltype(parse(std::string_view{})) general, own;
  for (const std::string& value : values) {
    const std::size_t equals = value.find('=');
    const bool named = is_named(value, mapping);
    const auto text = named ? std::string_view(value).substr(equals + 1) : std::string_view(value);
    const auto parsed = parse(text);
    if (!parsed) {
      const bool several = named && !mapping && text.find('=') != std::string_view::npos;
      fail(Exit::usage, "{} does not take \"{}\"; expected {}{}", flag, text, expected,
           several ? fmt::format("; give {} once for each texture", flag) : std::string());
    }
    if (!named) general = parsed;
    if (named && value.compare(0, equals, texture) == 0) own = parsed;
  }
  return own ? own : general;
}

}  // namespace gicodec::tools
