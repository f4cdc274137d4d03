// Backends by name or id.
#pragma once

#include <gicodec/backend.h>

#include <cstdint>
#include <span>
#include <string_view>

namespace gicodec {

/// Searches the caller's backends, then the built-in ones; nullptr if unknown.
[[nodiscard]] const Backend* find_backend(std::span<const Backend* const> callers,
                                          std::string_view name) noexcept;
/// Searches the built-in backends; nullptr if unknown.
[[nodiscard]] const Backend* find_backend(std::uint8_t id) noexcept;

}  // namespace gicodec
