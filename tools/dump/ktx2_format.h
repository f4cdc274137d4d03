// What KTX2 files store of a format besides its number.
#pragma once

#include <gicodec/record.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gicodec::tools {

/// typeSize: bytes that a big-endian machine swaps together.
[[nodiscard]] std::uint32_t ktx2_type_size(const Record& record) noexcept;
/// The data format descriptor of a format: a size and one basic block. Not for UNDEFINED.
[[nodiscard]] std::vector<std::byte> ktx2_descriptor(const Record& record);

}  // namespace gicodec::tools
