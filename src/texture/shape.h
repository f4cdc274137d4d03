// Block shapes known at compile time, so that the common ones get unrolled copies.
#pragma once

#include <gicodec/texture.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace gicodec {

/// A texel as an opaque value of 2, 4, 8 or 16 bytes.
template <typename T>
[[nodiscard]] inline T load(const std::byte* from) noexcept {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}
template <typename T>
inline void store(std::byte* to, T value) noexcept {
  std::memcpy(to, &value, sizeof value);
}

/// kCore = 0 stands for a side known only at run time.
template <typename T, unsigned kCore>
struct Shape {
  using Texel = T;
  static constexpr unsigned kMaxRow = kCore == 0 ? kMaxCore : kCore;
  unsigned runtime_core;
  [[nodiscard]] constexpr unsigned core() const noexcept {
    return kCore == 0 ? runtime_core : kCore;
  }
};

/// Calls body(Shape) for the description's texel size and core side.
template <typename Body>
void with_shape(const TextureDesc& desc, Body&& body) {
  switch (texel_bytes(desc)) {
    case 2: return body(Shape<std::uint16_t, 0>{desc.core});
    case 4:
      if (desc.core == 8) return body(Shape<std::uint32_t, 8>{8});
      if (desc.core == 16) return body(Shape<std::uint32_t, 16>{16});
      return body(Shape<std::uint32_t, 0>{desc.core});
    case 8: return body(Shape<std::uint64_t, 0>{desc.core});
    case 16: return body(Shape<std::array<std::uint64_t, 2>, 0>{desc.core});
    default: return;
  }
}

/// Top row of the guard band: corner, core row 0 reversed, corner. Bottom row alike with the last
/// core row. `out` holds core + 2 texels.
template <typename S>
inline void outer_row(S shape, const std::byte* core_row, typename S::Texel left,
                      typename S::Texel right, typename S::Texel* out) noexcept {
  const unsigned n = shape.core();
  out[0] = left;
  for (unsigned j = 0; j < n; ++j) {
    out[1 + j] = load<typename S::Texel>(core_row + (n - 1 - j) * sizeof(typename S::Texel));
  }
  out[n + 1] = right;
}

/// Applies the octahedral rule to a core whose rows are `pitch` bytes apart: visit_row(block row,
/// texels) for the two outer rows, visit_sides(core row, left, right) for those between.
template <typename S, typename VisitRow, typename VisitSides>
inline void apply_rule(S shape, const std::byte* core, std::size_t pitch, VisitRow&& visit_row,
                       VisitSides&& visit_sides) {
  using Texel = typename S::Texel;
  const unsigned n = shape.core();
  const std::byte* last_row = core + (n - 1) * pitch;
  const std::size_t last = (n - 1) * sizeof(Texel);
  Texel row[S::kMaxRow + 2];
  outer_row(shape, core, load<Texel>(last_row + last), load<Texel>(last_row), row);
  visit_row(0U, row);
  for (unsigned j = 0; j < n; ++j) {
    const std::byte* mirrored = core + (n - 1 - j) * pitch;
    visit_sides(j, load<Texel>(mirrored), load<Texel>(mirrored + last));
  }
  outer_row(shape, last_row, load<Texel>(core + last), load<Texel>(core), row);
  visit_row(n + 1, row);
}

}  // namespace gicodec
