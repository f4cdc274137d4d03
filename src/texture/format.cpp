#include "texture/format_table.h"

#include <algorithm>

namespace gicodec {
std::span<const FormatInfo> formats() noexcept { return kFormats; }

const FormatInfo* find_format(Format format) noexcept {
  const auto* it = std::ranges::find(kFormats, format, &FormatInfo::format);
  return it == kFormats.end() ? nullptr : it;
}

const FormatInfo* find_format(std::string_view name) noexcept {
  constexpr std::string_view prefix = "VK_FORMAT_";
  if (name.starts_with(prefix)) name.remove_prefix(prefix.size());
  const auto* it = std::ranges::find(kFormats, name, &FormatInfo::name);
  return it == kFormats.end() ? nullptr : it;
}

}  // namespace gicodec
