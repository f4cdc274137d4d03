// Differences of guard bands by the binary coder (FORMAT.md, "Guard band section").
#pragma once

#include "base/memory.h"

#include <gicodec/status.h>

#include <cstddef>
#include <span>
#include <vector>

namespace gicodec {

/// Appends the bytes' code. `record`: bytes of a record, which bytes resemble by their place in it.
void encode_differences(std::span<const std::byte> bytes, std::size_t record,
                        std::vector<std::byte>& out);
/// The most bytes that so many bytes of code stand for.
[[nodiscard]] std::size_t most_differences(std::size_t code) noexcept;
/// The inverse: fills `bytes`.
Status decode_differences(std::span<const std::byte> code, std::size_t record,
                          std::span<std::byte> bytes);

}  // namespace gicodec
