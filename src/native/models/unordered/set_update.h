// Updates of blocks that are sets (docs/native.md, "Sets"): what became of the records that the
// mirror has, by their places; those that are new are a set of their own.
#pragma once

#include "native/models/unordered/set_model.h"

namespace gicodec::native {

/// Memory of one thread, kept for its capacity.
class SetUpdate {
 public:
  /// Before the first block of a chunk; `values` must outlive its last.
  void reset(ValueModel& values);
  /// The records of one block that exist; `past`: the mirror's block, empty where there is none.
  void encode(BinaryEncoder& coder, const Record& record, std::span<const std::byte> past,
              std::span<const std::byte> records);
  /// False for what no encoder writes. Fills `records`.
  bool decode(BinaryDecoder& coder, const Record& record, std::span<const std::byte> past,
              std::span<std::byte> records);

 private:
  /// Of a record of the past: it is as it was, has its place but other components, or is no more.
  enum Fate : std::uint8_t { kept, changed, gone };

  [[nodiscard]] bool pair(const Record& record, std::span<const std::byte> past,
                          std::span<const std::byte> records);
  template <typename Coder>
  bool code_fates(Coder& coder, std::uint32_t most);
  template <typename Coder>
  Fate code_fate(Coder& coder, Fate fate);
  /// Survivors, and where new records stand, among which they come to stand in decoders.
  template <typename Coder, typename Byte>
  bool code_survivors(Coder& coder, const Record& record, std::span<const std::byte> past,
                      std::span<Byte> records);
  template <typename Coder, typename Byte>
  void code_changed(Coder& coder, const Record& record, const std::byte* past, Byte* now);

  SetModel set_;
  ValueModel* values_ = nullptr;
  std::uint32_t history_ = 0;                                ///< fates, two bits each
  std::array<std::uint32_t, kMaxComponents> differences_{};  ///< the last ones

  // Of the block.
  Vector<Fate> fates_;  ///< of the records of the past
  std::uint32_t survivors_ = 0;
  Vector<std::uint32_t> now_;  ///< encoding: where those that are not gone stand
  Vector<std::byte> new_;      ///< encoding
};

}  // namespace gicodec::native
