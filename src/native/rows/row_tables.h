// Tables that a row chunk carries: distributions of residuals and of repeats, and which of them
// each context has (docs/native/rows.md, "Tables").
#pragma once

#include "base/bytes.h"
#include "base/memory.h"
#include "native/planes/tables.h"
#include "native/rows/row_strip.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace gicodec::native {

struct Step;

/// Roles of residuals: those of exponent and lead, those of others, those of low halves.
inline constexpr unsigned kRowRoles = 3;

/// Classes of the contexts of each role that a chunk has.
using RowClasses = std::array<unsigned, kRowRoles>;

/// Memory of one thread, kept for its capacity.
class RowTables {
 public:
  /// Encoding: those that code the steps well.
  void fit(std::span<const Step> steps, const RowClasses& classes);
  void write(const RowClasses& classes, ByteWriter& writer) const;
  /// Fails the reader where a decoder must refuse them.
  void read(const RowClasses& classes, ByteReader& reader);
  [[nodiscard]] const Tables& tables() const { return tables_; }

 private:
  struct Role {
    unsigned count = 0;
    std::array<Distribution, kDistributions> distribution;
  };
  using Bins = std::array<std::uint32_t, kBins>;
  using RepeatCounts = std::array<std::uint32_t, 3>;
  void count(std::span<const Step> steps);
  void fit_role(unsigned role, unsigned contexts);
  void fit_repeats();
  void build(const RowClasses& classes);

  std::array<Role, kRowRoles> role_;
  unsigned repeats_ = 0;  ///< distributions of repeats
  std::array<std::array<std::uint16_t, 2>, kDistributions> end_{};
  std::array<std::array<std::uint8_t, 256>, kRowRoles> map_;  ///< by context
  std::array<std::uint8_t, 256> repeat_map_;
  Vector<Bins> bins_;  ///< by role and context
  std::array<RepeatCounts, 256> repeat_counts_;
  Vector<RoleTables> built_;
  RowRepeats built_repeats_;
  Tables tables_{};
};

}  // namespace gicodec::native
