// Pictures as files, and how far two of them are apart.
#pragma once

#include "client_renderer.h"

#include "dump/file.h"

#include <string>

namespace gicodec::ddgi {

/// Writes PNG (tone-mapped with the camera's exposure, sRGB) or EXR (linear, half) by the name's
/// ending, atomically. Throws tools::Error; usage for another ending.
void write_picture(const std::string& path, const Picture& picture, float exposure,
                   tools::Existing existing = tools::Existing::refuse);
/// Throws unless write_picture() knows the ending.
void check_picture_name(const std::string& path);

struct PictureDifference {
  std::size_t differing = 0;  ///< pixels with any differing bit
  double psnr = 0;            ///< in dB of the tone-mapped 8-bit values; infinite where equal
  float largest = 0;          ///< of the linear channels
};
/// Precondition: equal sizes.
[[nodiscard]] PictureDifference compare(const Picture& a, const Picture& b, float exposure);
/// |a − b| · gain.
[[nodiscard]] Picture difference(const Picture& a, const Picture& b, float gain);

}  // namespace gicodec::ddgi
