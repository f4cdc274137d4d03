// What KTX2 files say of a format besides its number.
#pragma once

#include <gicodec/record.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gicodec::tools {

/// Bytes that are swapped together on machines of the other byte order.
[[nodiscard]] std::uint32_t ktx2_type_size(const Record& record) noexcept;
/// The data format descriptor of a VkFormat: a size and one basic block. Precondition: the record
/// is a preset.
[[nodiscard]] std::vector<std::byte> ktx2_descriptor(const Record& record);

}  // namespace gicodec::tools
