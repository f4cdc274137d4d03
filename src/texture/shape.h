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

/// Collects whether any two of many texels differ, without a branch per texel.
class Difference {
 public:
  template <typename T>
  void add(const T& a, const T& b) noexcept {
    bits_ |= static_cast<std::uint64_t>(a ^ b);
  }
  void add(const std::array<std::uint64_t, 2>& a, const std::array<std::uint64_t, 2>& b) noexcept {
    bits_ |= (a[0] ^ b[0]) | (a[1] ^ b[1]);
  }
  [[nodiscard]] bool any() const noexcept { return bits_ != 0; }

 private:
  std::uint64_t bits_ = 0;
};

/// kCore = 0 stands for a side known only at run time.
template <typename T, unsigned kCore>
struct Shape {
  using Texel = T;
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

/// The octahedral rule: copy(block row, block column, core row, core column) for every border texel,
/// in ring order.
template <typename S, typename Copy>
inline void walk_rule(S shape, Copy&& copy) {
  const unsigned n = shape.core();
  const unsigned last = n - 1;
  copy(0U, 0U, last, last);
  for (unsigned j = 0; j < n; ++j) copy(0U, j + 1, 0U, last - j);
  copy(0U, n + 1, last, 0U);
  for (unsigned j = 0; j < n; ++j) {
    copy(j + 1, 0U, last - j, 0U);
    copy(j + 1, n + 1, last - j, last);
  }
  copy(n + 1, 0U, 0U, last);
  for (unsigned j = 0; j < n; ++j) copy(n + 1, j + 1, last, last - j);
  copy(n + 1, n + 1, 0U, 0U);
}

}  // namespace gicodec
