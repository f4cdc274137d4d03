// Blocks that are sets (docs/native/unordered.md): places by bisection, which codes how many
// records are on the lower side, other components by those of records around.
#pragma once

#include "native/mixed/value_model.h"
#include "quantise/set_order.h"

#include <gicodec/texture.h>

#include <span>

namespace gicodec {
class BinaryEncoder;
class BinaryDecoder;
}  // namespace gicodec

namespace gicodec::native {

/// Memory of one thread, kept for its capacity.
class SetModel {
 public:
  /// Before the first block of a chunk; `values` must outlive its last.
  void reset(ValueModel& values);
  /// The records of one block that exist, one after the other.
  void encode(BinaryEncoder& coder, const Record& record, std::span<const std::byte> records);
  /// False for what no encoder writes. Fills `records`.
  bool decode(BinaryDecoder& coder, const Record& record, std::span<std::byte> records);

 private:
  using Axes = SetPlace::Axes;

  /// Records of a box: axis by axis, bits of their place that are known. An axis is *shared* if all
  /// of them are.
  struct Node {
    std::uint32_t first, count;
    Axes place;
    std::array<std::uint8_t, SetPlace::kMaxAxes> known;
    std::uint8_t shared, axis, history;
  };
  /// Coordinates that many records had, the last one first.
  struct Recent {
    static constexpr unsigned kMax = 12;
    std::array<std::uint32_t, kMax> value{};
    unsigned count = 0;
    void use(std::uint32_t coordinate);
  };

  template <typename Coder>
  bool code(Coder& coder, const SetPlace& place, std::uint32_t count);
  template <typename Coder>
  bool code_ordered(Coder& coder, const SetPlace& place, std::uint32_t count);
  template <typename Coder>
  bool code_shared(Coder& coder, const Node& node, unsigned axis);
  template <typename Coder>
  bool code_rest(Coder& coder, const SetPlace& place, Node& node, unsigned axis);
  template <typename Coder>
  std::uint32_t code_left(Coder& coder, const Node& node, unsigned axis);
  template <typename Coder>
  bool code_leaf(Coder& coder, const SetPlace& place, Node& node);
  /// Components from `first` on.
  template <typename Coder>
  void code_values(Coder& coder, std::uint32_t index, unsigned first, std::uint32_t plane,
                   std::uint32_t cell);
  /// Where one of the records before is, from the halves that the next bit makes.
  [[nodiscard]] std::uint32_t side(unsigned last, unsigned axis, std::uint32_t low,
                                   unsigned bit) const;

  ValueModel* values_ = nullptr;
  Vector<Mixer<kFlagContexts>> counts_;
  std::array<Recent, SetPlace::kMaxAxes> recent_;
  std::array<Axes, 3> last_{};  ///< places of the records before
  std::array<std::uint32_t, kMaxComponents> before_{}, before_that_{};

  // Of the block.
  const Record* record_ = nullptr;
  const std::byte* in_ = nullptr;
  std::byte* out_ = nullptr;
  Vector<Axes> places_;  ///< encoding
};

}  // namespace gicodec::native
