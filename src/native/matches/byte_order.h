// In which order a match chunk codes the bytes of its records, and as differences to what
// (docs/native/matches.md, "Bytes").
#pragma once

#include "native/frame/workspace.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace gicodec::native {

/// To which record the bytes of a record are differences, modulo 256.
enum class Difference : std::uint8_t {
  none,
  before,  ///< the record before
  above,   ///< the record in the row before
  past,    ///< the mirror's; updates only
};
inline constexpr unsigned kDifferences = 4;

struct ByteOrder {
  Difference difference = Difference::none;
  bool planes = false;  ///< all first bytes of records, all second ones, …; or record by record
};

/// How far apart bytes of an order are: of a record and the next, the row above, the block before;
/// and of planes, or of two blocks.
struct Distances {
  std::uint64_t unit, row, block, far;
};
[[nodiscard]] inline Distances distances_of(const TextureDesc& desc, ByteOrder order,
                                            std::size_t blocks) noexcept {
  const std::uint64_t unit = order.planes ? 1 : desc.record.bytes;
  const std::uint64_t block = unit * record_count(desc.block);
  return {unit, unit * desc.block.x, block, order.planes ? block * blocks : 2 * block};
}

/// Goes through the bytes of the records of blocks in that order.
class ByteWalk {
 public:
  /// `texels`: those of all blocks of the update.
  ByteWalk(const Update& u, std::span<const std::uint32_t> positions, const BlockTable& texels,
           ByteOrder order)
      : u_(u), positions_(positions), texels_(texels), order_(order) {
    seek(0);
  }

  [[nodiscard]] std::size_t size() const { return records() * bytes_; }
  /// Index of the byte in its record.
  [[nodiscard]] std::size_t byte() const { return byte_; }
  /// Index of the byte in its block.
  [[nodiscard]] std::size_t at() const { return record_ * bytes_ + byte_; }
  [[nodiscard]] std::uint32_t position() const { return positions_[index_]; }
  [[nodiscard]] std::uint8_t difference() const {
    return static_cast<std::uint8_t>(std::to_integer<unsigned>(block_[at()]) - reference());
  }
  /// The byte whose difference this is.
  [[nodiscard]] std::byte byte_of(std::uint8_t difference) const {
    return static_cast<std::byte>((difference + reference()) & 255);
  }
  void seek(std::size_t at) {
    const std::size_t record = order_.planes ? at % records() : at / bytes_;
    byte_ = order_.planes ? at / records() : at % bytes_;
    index_ = record / per_block_;
    record_ = record % per_block_;
    enter();
  }
  void step() {
    if (!order_.planes) {
      if (++byte_ < bytes_) return;
      byte_ = 0;
    }
    if (++record_ < per_block_) return;
    record_ = 0;
    if (++index_ == positions_.size()) {
      index_ = 0;
      if (order_.planes) ++byte_;
    }
    enter();
  }

 private:
  [[nodiscard]] std::size_t records() const { return positions_.size() * per_block_; }
  void enter() {
    block_ = texels_[positions_[index_]].data();
    before_ = index_ > 0 ? texels_[positions_[index_ - 1]].data() : nullptr;
    if (order_.difference == Difference::past)
      past_ = u_.mirror.blocks[u_.probes[positions_[index_]]].data();
  }
  [[nodiscard]] unsigned reference() const {
    switch (order_.difference) {
      case Difference::none:
        return 0;
      case Difference::before:
        return back(1);
      case Difference::above:
        return back(u_.desc.block.x);
      case Difference::past:
        return std::to_integer<unsigned>(past_[at()]);
    }
    return 0;
  }
  /// The same byte so many records before; 0 before all.
  [[nodiscard]] unsigned back(std::size_t records) const {
    const std::byte* from = record_ >= records ? block_ : before_;
    if (from == nullptr) return 0;
    const std::size_t record = record_ >= records ? record_ : record_ + per_block_;
    return std::to_integer<unsigned>(from[(record - records) * bytes_ + byte_]);
  }

  const Update& u_;
  std::span<const std::uint32_t> positions_;
  BlockTable texels_;
  ByteOrder order_;
  std::size_t bytes_ = u_.desc.record.bytes, per_block_ = record_count(u_.desc.block);
  std::size_t index_ = 0, record_ = 0, byte_ = 0;
  const std::byte* block_ = nullptr;
  const std::byte* before_ = nullptr;
  const std::byte* past_ = nullptr;
};

}  // namespace gicodec::native
