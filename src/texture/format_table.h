// The table of texel formats, for code that needs it at compile time.
#pragma once

#include <gicodec/texture.h>

#include <array>

namespace gicodec {

inline constexpr auto kFormats = [] {
  constexpr auto unorm = ComponentKind::unorm;
  constexpr auto ufloat = ComponentKind::ufloat;
  constexpr auto sfloat = ComponentKind::sfloat;
  constexpr auto exponent = ComponentKind::exponent;
  return std::array<FormatInfo, 11>{{
      {Format::R8G8B8A8_UNORM,
       "R8G8B8A8_UNORM",
       4,
       4,
       {{'R', 0, 8, unorm}, {'G', 8, 8, unorm}, {'B', 16, 8, unorm}, {'A', 24, 8, unorm}}},
      {Format::A2R10G10B10_UNORM_PACK32,
       "A2R10G10B10_UNORM_PACK32",
       4,
       4,
       {{'R', 20, 10, unorm}, {'G', 10, 10, unorm}, {'B', 0, 10, unorm}, {'A', 30, 2, unorm}}},
      {Format::A2B10G10R10_UNORM_PACK32,
       "A2B10G10R10_UNORM_PACK32",
       4,
       4,
       {{'R', 0, 10, unorm}, {'G', 10, 10, unorm}, {'B', 20, 10, unorm}, {'A', 30, 2, unorm}}},
      {Format::R16_SFLOAT, "R16_SFLOAT", 2, 1, {{'R', 0, 16, sfloat}, {}, {}, {}}},
      {Format::R16G16_SFLOAT,
       "R16G16_SFLOAT",
       4,
       2,
       {{'R', 0, 16, sfloat}, {'G', 16, 16, sfloat}, {}, {}}},
      {Format::R16G16B16A16_SFLOAT,
       "R16G16B16A16_SFLOAT",
       8,
       4,
       {{'R', 0, 16, sfloat}, {'G', 16, 16, sfloat}, {'B', 32, 16, sfloat}, {'A', 48, 16, sfloat}}},
      {Format::R32_SFLOAT, "R32_SFLOAT", 4, 1, {{'R', 0, 32, sfloat}, {}, {}, {}}},
      {Format::R32G32_SFLOAT,
       "R32G32_SFLOAT",
       8,
       2,
       {{'R', 0, 32, sfloat}, {'G', 32, 32, sfloat}, {}, {}}},
      {Format::R32G32B32A32_SFLOAT,
       "R32G32B32A32_SFLOAT",
       16,
       4,
       {{'R', 0, 32, sfloat}, {'G', 32, 32, sfloat}, {'B', 64, 32, sfloat}, {'A', 96, 32, sfloat}}},
      {Format::B10G11R11_UFLOAT_PACK32,
       "B10G11R11_UFLOAT_PACK32",
       4,
       3,
       {{'R', 0, 11, ufloat}, {'G', 11, 11, ufloat}, {'B', 22, 10, ufloat}, {}}},
      {Format::E5B9G9R9_UFLOAT_PACK32,
       "E5B9G9R9_UFLOAT_PACK32",
       4,
       4,
       {{'R', 0, 9, ufloat}, {'G', 9, 9, ufloat}, {'B', 18, 9, ufloat}, {'E', 27, 5, exponent}}},
  }};
}();

/// Precondition: `format` is known.
constexpr const FormatInfo& format_info(Format format) noexcept {
  for (const auto& info : kFormats) {
    if (info.format == format) return info;
  }
  return kFormats.front();
}

}  // namespace gicodec
