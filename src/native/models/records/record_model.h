// Records of small blocks (docs/native/records.md): what changed since the mirror and by how
// much, what is new by what stands before it.
#pragma once

#include "native/mixed/value_model.h"
#include "native/models/records/similar_records.h"

#include <gicodec/texture.h>

#include <span>

namespace gicodec::native {

/// Memory of one thread, kept for its capacity.
class RecordModel {
 public:
  /// Before the first block of a chunk; `values` must outlive its last.
  void reset(const TextureDesc& desc, bool update, ValueModel& values);
  /// One block, in order, from `in` or into `out`. `previous`: its mirror block, not read in
  /// keyframes. `presence` as in jobs.
  template <typename Coder>
  void code(Coder& coder, std::span<const std::byte> in, std::span<std::byte> out,
            std::span<const std::byte> previous, std::span<const std::byte> presence);

 private:
  using Values = std::array<std::uint32_t, kMaxComponents>;
  /// A record of the block, or none.
  struct Seen {
    bool exists = false, changed = false;
    bool known = false;  ///< by `previous`
    Values now{}, previous{};
    std::array<std::int32_t, kMaxComponents> residual{};  ///< of what was predicted
  };
  static constexpr unsigned kPredictors = 4;

  template <typename Coder>
  bool code_changed(Coder& coder, const Seen& here, unsigned column, std::uint32_t index,
                    bool changed);
  template <typename Coder>
  void code_new(Coder& coder, Seen& here, unsigned column, const std::byte* in);
  template <typename Coder>
  void code_update(Coder& coder, Seen& here, unsigned column, const std::byte* in);
  template <typename Coder>
  bool code_same(Coder& coder, const Seen& here, unsigned column, unsigned c, std::uint32_t pattern,
                 std::uint32_t value);

  // Numbers (record_values.cpp).
  template <typename Coder>
  std::uint32_t code_number(Coder& coder, unsigned place, Seen& here, unsigned column,
                            std::uint32_t value);
  [[nodiscard]] std::array<std::uint64_t, kPredictors> predictions(unsigned c, const Seen& here,
                                                                   unsigned column) const;

  // Blocks of one row (record_rows.cpp).
  template <typename Coder>
  bool code_changed_in_row(Coder& coder, const Seen& here, std::uint32_t index, bool changed);
  /// Whether a large component is a copy of another; fills it if so.
  template <typename Coder>
  bool code_copy(Coder& coder, unsigned place, Seen& here, std::uint32_t value);
  /// A small component.
  template <typename Coder>
  std::uint32_t code_difference(Coder& coder, unsigned c, const Seen& here, unsigned column,
                                std::uint32_t value);

  [[nodiscard]] const Seen& w(unsigned column) const { return rows_[row_][column]; }
  [[nodiscard]] const Seen& n(unsigned column) const { return rows_[1 - row_][column + 1]; }
  [[nodiscard]] const Seen& nw(unsigned column) const { return rows_[1 - row_][column]; }
  [[nodiscard]] const Seen& ne(unsigned column) const { return rows_[1 - row_][column + 2]; }
  /// Value of a component of a record, without its exponent's scale: before the update, or now.
  [[nodiscard]] std::uint64_t scaled(unsigned c, const Values& values) const {
    return std::uint64_t{values[c]} << (in_units(c) ? values[exponent_] : 0);
  }
  [[nodiscard]] bool in_units(unsigned c) const { return (mantissas_ >> c & 1) != 0; }
  ValueModel* values_ = nullptr;
  TextureDesc desc_;
  bool update_ = false, one_row_ = false;
  std::uint32_t mantissas_ = 0;  ///< components in units of an exponent, by bit
  unsigned exponent_ = 0;
  std::array<std::uint8_t, kMaxComponents> order_{};  ///< of components of known records

  // Of the chunk so far.
  Seen last_, last_but_one_;        ///< records that were coded
  SimilarRecords similar_;          ///< in rows
  std::uint32_t copy_history_ = 1;  ///< which candidates were right, by bit
  std::uint32_t changed_components_ =
      0;  ///< components of the last known record that changed, by bit
  std::array<std::array<std::int32_t, kPredictors>, kMaxComponents> error_{};
  std::array<std::int32_t, kMaxComponents> noise_{};
  std::array<std::uint64_t, kMaxComponents> moved_{};  ///< sums of what components changed by
  std::uint32_t changes_before_ = 0;                   ///< of the block before, up to 7

  // Of the block.
  std::array<std::array<Seen, kMaxBlockSide + 2>, 2> rows_;
  unsigned row_ = 0;
  std::uint32_t history_ = 1, changes_ = 0;
  std::uint32_t left_ = 0;  ///< known records behind this one, in rows

  // Of the record.
  std::uint32_t last_copied_ =
      0;  ///< whether a component copies the record that changed last: 2 no, 1 yes, 0 not coded
  unsigned coded_ = 0;  ///< components with residuals so far
  std::int64_t residual_ = 0, residual_before_ = 0;
  std::uint64_t lead_now_ = 0, lead_prediction_ = 0;  ///< of the first component by numbers
  std::int64_t lead_change_ = 0;
  unsigned lead_ = 0;
};

}  // namespace gicodec::native
