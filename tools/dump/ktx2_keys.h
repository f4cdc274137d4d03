// Keys and values of KTX2 files as attributes, and back.
#pragma once

#include "dump/dump.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace gicodec::tools {

/// Of keys that stand twice the first counts; those that are no UTF-8 are left out.
[[nodiscard]] Attributes read_ktx2_keys(std::span<const std::byte> bytes, const std::string& path);
/// The inverse, for keys in order, each once, padded by zeros.
[[nodiscard]] std::vector<std::byte> write_ktx2_keys(const Attributes& attributes,
                                                     const std::string& path);

}  // namespace gicodec::tools
