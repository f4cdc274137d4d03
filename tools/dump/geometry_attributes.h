// The attributes that describe a file's texture (gicodec(1), "What the texture is").
#pragma once

#include "dump/dump.h"

#include <string_view>

namespace gicodec::tools {

inline constexpr const char* kGrid = "gicodec:grid";
inline constexpr const char* kCore = "gicodec:core";
inline constexpr const char* kBorder = "gicodec:border";
inline constexpr const char* kTiling = "gicodec:tiling";
inline constexpr const char* kBlock = "gicodec:block";
inline constexpr const char* kExtent = "gicodec:extent";
inline constexpr const char* kFormat = "gicodec:vkFormat";

[[nodiscard]] Attribute sides_attribute(std::string_view name, const Grid& sides);
[[nodiscard]] Attribute grid_attribute(const Grid& grid);
[[nodiscard]] Attribute int_attribute(std::string_view name, std::uint16_t value);
[[nodiscard]] Attribute tiling_attribute(Tiling tiling);
[[nodiscard]] Attribute format_attribute(Format format);
/// True if two of them have the same meaning, in any notation of numbers.
[[nodiscard]] bool same_meaning(const Attribute& a, const Attribute& b);

}  // namespace gicodec::tools
