// PNG pictures, and images that are not EXR.
#pragma once

#include "file.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace gicodec::tools {

/// Throws Error of Exit::bad_input with a hint if libpng refuses the size.
void check_png_size(const std::string& path, std::uint64_t width, std::uint64_t height);
/// Writes an sRGB PNG of 1 or 3 channels with 8 bits each, rows tightly packed, atomically.
/// `before_writing` is called after compression and may throw to prevent writing.
void write_png(const std::string& path, std::uint32_t width, std::uint32_t height,
               std::uint32_t channels, std::span<const std::uint8_t> pixels,
               Existing existing = Existing::refuse, void (*before_writing)() = nullptr);

}  // namespace gicodec::tools
