// What text from outside has to be.
#pragma once

#include <cstddef>
#include <string_view>

namespace gicodec {

inline constexpr std::size_t kMaxTextureName = 255;

/// No overlong forms, no surrogates, nothing above U+10FFFF.
[[nodiscard]] bool is_utf8(std::string_view text) noexcept;

}  // namespace gicodec
