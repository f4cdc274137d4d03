// Supercompression of KTX2 levels (Khronos, "KTX File Format Specification, Version 2", section 4).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gicodec::tools {

enum class Scheme : std::uint8_t { none = 0, basis_lz = 1, zstandard = 2, zlib = 3 };

/// "Zstandard"; empty for unknown numbers.
[[nodiscard]] std::string_view to_string(Scheme scheme) noexcept;
/// The inverse.
[[nodiscard]] std::optional<Scheme> scheme_from_string(std::string_view name) noexcept;

/// Packs a level by Zstandard or ZLIB. Throws Error if memory runs out.
[[nodiscard]] std::vector<std::byte> pack_level(Scheme scheme, std::span<const std::byte> level,
                                                const std::string& path);
/// The inverse, of a level of `bytes` bytes; throws unless it has exactly as many.
[[nodiscard]] std::vector<std::byte> unpack_level(Scheme scheme, std::span<const std::byte> packed,
                                                  std::size_t bytes, const std::string& path);

}  // namespace gicodec::tools
