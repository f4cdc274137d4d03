#pragma once

#include "train/histograms.h"

#include <string>

namespace gicodec::train {

/// The source text of src/native/table_data.cpp.
[[nodiscard]] std::string to_source(const Model& model);

}  // namespace gicodec::train
