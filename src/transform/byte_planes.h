// Records ↔ byte planes, the layout of the byte backends. A record of T bytes becomes one byte in
// each of T planes: for each component its whole low bytes, then the remaining high bits of all
// components as a bit string, first component lowest. With a reference, each component is replaced
// by its zigzag-folded difference modulo 2^bits, so that small changes of either sign leave the
// high bits zero. Bijective for every record.
#pragma once

#include <gicodec/isa.h>
#include <gicodec/texture.h>

#include <cstddef>
#include <span>

namespace gicodec {

/// Precondition: `records`, `planes` and, unless empty, `reference` have the same size, a multiple
/// of the record's.
void to_byte_planes(Isa isa, const Record& record, std::span<const std::byte> records,
                    std::span<const std::byte> reference, std::span<std::byte> planes);
void from_byte_planes(Isa isa, const Record& record, std::span<const std::byte> planes,
                      std::span<const std::byte> reference, std::span<std::byte> records);

}  // namespace gicodec
