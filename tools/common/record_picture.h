// A picture of records that an application defines.
#pragma once

#include "dump/dump.h"

#include <cstdint>
#include <vector>

namespace gicodec::tools {

/// A picture, RGB or grey, row by row.
struct RecordPicture {
  std::uint64_t width = 0, height = 0;
  std::uint32_t channels = 0;
  std::vector<std::uint8_t> pixels;
};

/// The picture's size, without pixels.
[[nodiscard]] RecordPicture record_picture_size(const TextureDesc& desc);
/// Shows the first three components of each record, or the first if there are fewer, as shares of
/// their range; floats as x / (1 + |x|). Blocks of an array stand side by side, about square.
[[nodiscard]] RecordPicture record_picture(const Dump& dump);

}  // namespace gicodec::tools
