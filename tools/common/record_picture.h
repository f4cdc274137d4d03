// Records of an application's own as a picture for a person.
#pragma once

#include "dump/dump.h"

#include <cstdint>
#include <vector>

namespace gicodec::tools {

/// RGB or grey, row by row.
struct RecordPicture {
  std::uint64_t width = 0, height = 0;
  std::uint32_t channels = 0;
  std::vector<std::uint8_t> pixels;
};

/// Its size alone.
[[nodiscard]] RecordPicture record_picture_size(const TextureDesc& desc);
/// The first three components of each record, or the first where there are fewer, as shares of
/// their range; floats as x / (1 + |x|). Blocks of an array stand side by side, about square.
[[nodiscard]] RecordPicture record_picture(const Dump& dump);

}  // namespace gicodec::tools
