// The canonical order of records in blocks that are sets (FORMAT.md, "Sets").
#pragma once

#include "quantise/component_code.h"

#include <gicodec/texture.h>

#include <array>
#include <bit>
#include <cstddef>
#include <span>

namespace gicodec {

/// The components whose bits order a set, each with its highest bit on top of a word.
class SetPlace {
 public:
  static constexpr unsigned kMaxAxes = 3;
  using Axes = std::array<std::uint32_t, kMaxAxes>;  ///< 0 for components that there are not

  explicit SetPlace(const Record& record) noexcept
      : record_(record), axes_(record.count < kMaxAxes ? record.count : kMaxAxes) {}
  [[nodiscard]] unsigned axes() const noexcept { return axes_; }
  [[nodiscard]] unsigned bits(unsigned axis) const noexcept {
    return record_.components[axis].bits;
  }
  [[nodiscard]] Axes operator()(const std::byte* record) const noexcept {
    Axes place{};
    for (unsigned a = 0; a < axes_; ++a) {
      const Component& component = record_.components[a];
      place[a] = code_of(record, component, record_.bytes) << (32U - component.bits);
    }
    return place;
  }
  /// Whether a set has `a` before `b`, by places alone.
  [[nodiscard]] static bool before(const Axes& a, const Axes& b) noexcept {
    unsigned axis = 0;
    std::uint32_t most = a[0] ^ b[0];
    for (unsigned i = 1; i < kMaxAxes; ++i) {
      const std::uint32_t differs = a[i] ^ b[i];
      // A higher first bit: of two with the same the earlier component's comes first.
      if (std::countl_zero(differs) < std::countl_zero(most)) {
        axis = i;
        most = differs;
      }
    }
    return a[axis] < b[axis];
  }

 private:
  const Record& record_;
  unsigned axes_;
};

/// True if every byte of the record is 0.
[[nodiscard]] bool is_zero(std::span<const std::byte> record) noexcept;

/// Puts records into the canonical order. Records that do not exist are zero, and stay behind.
void sort_set(const Record& record, std::span<std::byte> records);

}  // namespace gicodec
