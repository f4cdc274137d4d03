// The lossy step of an encoder with a bounded error: records become others within the bound that
// cost less.
#pragma once

#include <gicodec/record.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace gicodec {

/// Values that a component keeps to: multiples of a step. Whoever codes them needs not all of their
/// bits.
class ErrorGrid {
 public:
  ErrorGrid(const Record& record, float max_error) noexcept;
  /// True if nothing changes.
  [[nodiscard]] bool exact() const noexcept { return exact_; }
  /// Moves each component no further than the bound: to what is held there, if that is near enough,
  /// so that what stands still costs nothing and does not drift; else to the grid. `held`: as many
  /// records, sent before, or nothing. `given`: if not empty, what those were made of; then the
  /// change since is kept rather than what is held, as far as that is near enough.
  void apply(std::span<std::byte> records, std::span<const std::byte> held,
             std::span<const std::byte> given = {}) const noexcept;
  /// True if every component that may be off is on the grid.
  [[nodiscard]] bool holds(std::span<const std::byte> records) const noexcept;
  /// By component, what all values are multiples of.
  [[nodiscard]] std::array<std::uint32_t, kMaxComponents> steps() const noexcept;

 private:
  struct Axis {
    std::uint32_t error = 0, step = 1;  ///< codes
    std::uint32_t largest = 0;          ///< code that is no infinity nor beyond
    std::uint32_t sign = 0;             ///< bit of floats that have one
    std::uint64_t inverse = 0;  ///< 2^32 / step, rounded up, of codes of up to 16 bits; or 0
    bool is_float = false;
    bool capped = false;  ///< the largest code stands for the multiple beyond it
  };
  [[nodiscard]] static std::uint32_t moved(const Axis& axis, std::uint32_t code) noexcept;

  Record record_;
  std::array<Axis, kMaxComponents> axes_{};
  bool exact_ = true;
};

}  // namespace gicodec
