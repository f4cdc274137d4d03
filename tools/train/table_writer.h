#pragma once

#include "train/fit.h"

#include <string>

namespace gicodec::train {

/// The text of src/native/planes/tables.txt (docs/native.md, "Tables").
[[nodiscard]] std::string to_text(const Model& model);

}  // namespace gicodec::train
