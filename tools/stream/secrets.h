// Secrets of users: makes, hashes and compares them.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace gicodec::streaming {

/// Takes the same time whether they differ or not.
[[nodiscard]] bool same_secret(std::string_view a, std::string_view b);

/// Unpredictable bytes of the operating system. Throws tools::Error of Exit::io.
[[nodiscard]] std::string random_bytes(std::size_t size);
/// PBKDF2 with HMAC and SHA-256, 32 bytes.
[[nodiscard]] std::string slow_hash(std::string_view secret, std::string_view salt,
                                    unsigned rounds);

[[nodiscard]] std::string to_hex(std::string_view bytes);
[[nodiscard]] std::optional<std::string> from_hex(std::string_view text);

}  // namespace gicodec::streaming
