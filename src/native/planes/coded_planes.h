// Which planes of a chunk are coded, and the values of the others, as bytes (docs/native.md,
// "Chunk").
#pragma once

#include "base/bytes.h"
#include "native/planes/planes.h"

#include <cstdint>
#include <span>

namespace gicodec::native {

/// `coded`: planes by bit; `constant`: by plane.
inline void write_coded(const PlaneLayout& layout, std::uint32_t coded,
                        std::span<const std::uint16_t, kMaxPlanes> constant, ByteWriter& writer) {
  for (unsigned p = 0; p < layout.planes; p += 8) {
    writer.fixed(static_cast<std::uint8_t>(coded >> p));
  }
  for (unsigned p = 0; p < layout.planes; ++p) {
    if ((coded >> p & 1) == 0) writer.fixed(constant[p]);
  }
}

inline std::uint32_t read_coded(const PlaneLayout& layout, ByteReader& reader,
                                std::span<std::uint16_t, kMaxPlanes> constant) {
  std::uint64_t coded = 0;
  for (unsigned p = 0; p < layout.planes; p += 8) {
    coded |= std::uint64_t{reader.fixed<std::uint8_t>()} << p;
  }
  if (coded >> layout.planes != 0) {
    reader.fail(Status::corrupt);
    return 0;
  }
  for (unsigned p = 0; p < layout.planes; ++p) {
    if ((coded >> p & 1) != 0) continue;
    constant[p] = reader.fixed<std::uint16_t>();
    if (constant[p] >> (layout.plane[p].bits - 1) > 1) reader.fail(Status::corrupt);
  }
  return static_cast<std::uint32_t>(coded);
}

}  // namespace gicodec::native
