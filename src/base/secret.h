// What others must not guess: random bytes, and a comparison that does not tell where it failed.
#pragma once

#include <gicodec/status.h>

#include <cstddef>
#include <span>

namespace gicodec {

/// Fills with unpredictable bytes of the operating system; io_failed if it has none to give.
Status system_random(std::span<std::byte> out) noexcept;

/// Takes as long for what differs as for what is equal; only the sizes may show.
[[nodiscard]] bool same_secret(std::span<const std::byte> a, std::span<const std::byte> b) noexcept;

}  // namespace gicodec
