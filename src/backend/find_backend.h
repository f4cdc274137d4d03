// Backends by name or id.
#pragma once

#include <gicodec/backend.h>

#include <cstdint>
#include <span>
#include <string_view>

namespace gicodec {

/// Among the caller's and the built-in ones; nullptr if there is none. The caller's come first, so
/// that they can replace built-in ones.
[[nodiscard]] const Backend* find_backend(std::span<const Backend* const> callers,
                                          std::string_view name) noexcept;
/// Among the built-in ones.
[[nodiscard]] const Backend* find_backend(std::uint8_t id) noexcept;

}  // namespace gicodec
