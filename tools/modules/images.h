// What the module gicodec-images offers: PNG, TIFF and DPX by OpenImageIO.
#pragma once

#include "modules/module.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace gicodec::tools {

enum class StoredSamples : std::uint8_t { uint8, uint16, half, float32, other };

/// What an image's header says; nothing of it has been checked.
struct ImageHead {
  int width = 0, height = 0, depth = 0;
  std::vector<std::string> channels;  ///< their names
  StoredSamples samples = StoredSamples::other;
  std::string type_name;  ///< of the samples, in words
  int bits = 0;           ///< per sample as the file has them
  bool mixed = false;     ///< channels of different types
  bool deep = false;      ///< any number of samples a texel
  std::string colour_space;
  std::uint64_t bytes = 0;    ///< of all samples
  int pages = 1, levels = 1;  ///< of which the first is read; at most 1,000 are counted
};

class ImageReader {
 public:
  virtual ~ImageReader() = default;
  ImageHead head;
  /// Fills head.bytes bytes, texel after texel; returns why it cannot, or nothing.
  virtual std::string read(std::span<std::byte> samples) = 0;
};

struct ImageModule {
  ModuleHead head;
  /// Opens with the parser of `kind` ("png", "tiff", "dpx") and no other; null and why if that
  /// refuses the file.
  std::unique_ptr<ImageReader> (*open)(const char* kind, const std::string& path, std::string& why);
  /// A PNG of 8-bit sRGB samples; returns why that cannot be, or nothing.
  std::string (*encode_png)(std::uint32_t width, std::uint32_t height, std::uint32_t channels,
                            std::span<const std::uint8_t> pixels,
                            std::vector<unsigned char>& bytes);
};

/// Loaded at the first call; throws Error of Exit::internal if that fails.
[[nodiscard]] const ImageModule& image_module();

}  // namespace gicodec::tools
