// Types of EXR samples as OpenEXR has them.
#pragma once

#include "dump/sample.h"

#include <OpenEXR/ImfPixelType.h>

#include <cstddef>

namespace gicodec::tools {

inline Imf::PixelType pixel_type(SampleType type) noexcept {
  return type == SampleType::uint32 ? Imf::UINT : type == SampleType::half ? Imf::HALF : Imf::FLOAT;
}
constexpr std::size_t sample_bytes(SampleType type) noexcept {
  return type == SampleType::half ? 2 : 4;
}

}  // namespace gicodec::tools
