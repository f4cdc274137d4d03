// Secrets: random bytes, and a comparison in constant time.
#pragma once

#include <gicodec/status.h>

#include <cstddef>
#include <span>

namespace gicodec {

/// Fills `out` with unpredictable bytes from the operating system; io_failed if it has none.
Status system_random(std::span<std::byte> out) noexcept;

/// True if equal. Its time depends on the sizes only.
[[nodiscard]] bool same_secret(std::span<const std::byte> a, std::span<const std::byte> b) noexcept;

}  // namespace gicodec
