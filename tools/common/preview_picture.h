// A texture as a picture, for gicodec preview.
#pragma once

#include "dump/dump.h"

#include <optional>
#include <string>

namespace gicodec::tools {

struct PreviewTuning {
  std::optional<double> exposure;  ///< colour: stops
  std::optional<double> gamma;     ///< colour: exponent that decodes it
  std::optional<double> max_distance;
};

/// Writes a PNG atomically: colour for three channels or more, else grey distances.
void write_preview(const std::string& path, const Dump& dump, const PreviewTuning& tuning,
                   Existing existing = Existing::refuse);

}  // namespace gicodec::tools
