// Updates of blocks that are sets (docs/native/unordered.md): the states of the records that the
// mirror has, by their places; new records are a set of their own.
#pragma once

#include "native/models/unordered/set_model.h"

namespace gicodec::native {

/// Memory of one thread, kept for its capacity.
class SetUpdate {
 public:
  /// Before the first block of a chunk; `values` must outlive its last.
  void reset(ValueModel& values);
  /// The records of one block that exist; `previous`: the mirror's block, empty where there is
  /// none.
  void encode(BinaryEncoder& coder, const Record& record, std::span<const std::byte> previous,
              std::span<const std::byte> records);
  /// False for what no encoder writes. Fills `records`.
  bool decode(BinaryDecoder& coder, const Record& record, std::span<const std::byte> previous,
              std::span<std::byte> records);

 private:
  /// Of a record of the mirror: it is unchanged, has its place but other components, or is removed.
  enum RecordState : std::uint8_t { kept, changed, removed };

  [[nodiscard]] bool pair(const Record& record, std::span<const std::byte> previous,
                          std::span<const std::byte> records);
  template <typename Coder>
  bool code_states(Coder& coder, std::uint32_t most);
  template <typename Coder>
  RecordState code_state(Coder& coder, RecordState state);
  /// Retained records; decoders merge them with the new ones, which `records` ends with.
  template <typename Coder, typename Byte>
  bool code_retained(Coder& coder, const Record& record, std::span<const std::byte> previous,
                     std::span<Byte> records);
  template <typename Coder, typename Byte>
  void code_changed(Coder& coder, const Record& record, const std::byte* previous, Byte* now);

  SetModel set_;
  ValueModel* values_ = nullptr;
  std::uint32_t history_ = 0;                                ///< states, two bits each
  std::array<std::uint32_t, kMaxComponents> differences_{};  ///< the last ones

  // Of the block.
  Vector<RecordState> states_;  ///< of the mirror's records
  std::uint32_t retained_ = 0;
  Vector<std::uint32_t> retained_at_;  ///< encoding: the places of retained records
  Vector<std::byte> new_;              ///< encoding
};

}  // namespace gicodec::native
