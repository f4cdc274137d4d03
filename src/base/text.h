// Validates text from outside.
#pragma once

#include <gicodec/api.h>

#include <string_view>

namespace GICODEC_API gicodec {

/// True for well-formed UTF-8: no overlong forms, no surrogates, nothing above U+10FFFF.
[[nodiscard]] bool is_utf8(std::string_view text) noexcept;

}  // namespace gicodec
