// The images of an EXR file: its parts, the layers in them, and what no texture holds together.
#pragma once

#include "dump/internal.h"

#include <string>
#include <vector>

namespace gicodec::tools {

/// An image, and its channels as OpenEXR names them are those of info.channels.
struct ExrImage {
  DumpInfo info;
  std::uint32_t x_sampling = 1, y_sampling = 1;
};

/// The images of all parts and levels, or the one that the hints name. In each part a layer's R, G,
/// B and A of one type are an image, its X, Y and Z are one, and every other channel is. Channels
/// that `hints` or an attribute with the format choose are the first image of the first part.
[[nodiscard]] std::vector<ExrImage> images_of(const std::vector<ExrPart>& parts, const Hints& hints,
                                              const std::string& path);

}  // namespace gicodec::tools
