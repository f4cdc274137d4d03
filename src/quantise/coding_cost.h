// About how many bits backends take for blocks: decides how a bounded error is spent.
#pragma once

#include <gicodec/record.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gicodec {

/// Counts what is left of components after the predictions that backends have in common, and takes
/// the best of these for each component.
class CodingCost {
 public:
  /// `width`: records in a row of a block.
  CodingCost(const Record& record, std::uint32_t width);

  void clear() noexcept;
  /// A block, of which the receiver holds other records or none (empty). `steps`: by component,
  /// what all codes are multiples of.
  void add(std::span<const std::byte> records, std::span<const std::byte> held,
           std::span<const std::uint32_t> steps) noexcept;
  [[nodiscard]] double bits() const noexcept;

 private:
  /// As it is; beside the record before, the one above, the plane through both; beside the
  /// component before.
  static constexpr std::size_t kPredictions = 5;
  /// So many numbers on either side of zero are counted each, others by their length.
  static constexpr int kNear = 64, kLengths = 34;
  static constexpr std::size_t kSymbols = 2 * kNear + 1 + kLengths;
  struct Counts {
    std::array<std::uint32_t, kSymbols> of{};
    std::uint64_t rest = 0;  ///< bits of the numbers that are not counted each

    void add(std::int64_t number) noexcept;
    [[nodiscard]] double bits(double all) const noexcept;
  };

  Record record_;
  std::uint32_t width_;
  std::uint64_t records_ = 0;
  std::vector<std::array<Counts, kPredictions>> counts_;  ///< by component
};

}  // namespace gicodec
