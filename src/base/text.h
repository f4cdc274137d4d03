// What text from outside has to be.
#pragma once

#include <string_view>

namespace gicodec {

/// No overlong forms, no surrogates, nothing above U+10FFFF.
[[nodiscard]] bool is_utf8(std::string_view text) noexcept;

}  // namespace gicodec
