// Values of flags that are VALUE for all textures or NAME=VALUE for one.
#pragma once

#include "dump/error.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace gicodec::tools {

/// "color=R=irr.R": the texture's name stands before a mapping, which has an equals sign itself.
inline bool is_named(std::string_view value, bool mapping) {
  const std::string_view first = value.substr(0, value.find(','));
  return std::count(first.begin(), first.end(), '=') > (mapping ? 1 : 0);
}

/// The value that counts for a texture, parsed. `expected`: what the value may be.
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
    if (!parsed) fail(Exit::usage, "{} does not take \"{}\"; expected {}", flag, text, expected);
    if (!named) general = parsed;
    if (named && value.compare(0, equals, texture) == 0) own = parsed;
  }
  return own ? own : general;
}

}  // namespace gicodec::tools
