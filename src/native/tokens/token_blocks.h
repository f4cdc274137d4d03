// The blocks of a token chunk: what each refers to and may copy, as planes.
#pragma once

#include "native/frame/workspace.h"
#include "native/tokens/token_chunk.h"
#include "native/tokens/token_head.h"

#include <span>

namespace gicodec::native {

/// Unpacks blocks one at a time, with what they are predicted from. Keeps the planes of those that
/// later ones refer to.
class TokenBlocks {
 public:
  TokenBlocks(const Update& u, std::span<const std::uint32_t> positions, const TokenHead& head,
              TokenMemory& memory);

  /// Unpacks the block at place `b` of the chunk, or what it refers to alone. `records`: of blocks
  /// of the update by position, as far as they are known.
  void load(std::size_t b, const BlockTable& records, bool current);
  /// Planes of a group in the loaded block.
  [[nodiscard]] TokenBlock block(const TokenGroup& group) const;
  [[nodiscard]] std::uint16_t* plane(unsigned p) const { return current_ + p * stride_; }
  /// Sets a plane that is not coded, of all blocks to come.
  void fill(unsigned p, std::uint16_t value);
  [[nodiscard]] const PlaneLayout& layout() const { return layout_; }
  [[nodiscard]] std::size_t texels() const { return texels_; }
  /// Packs the planes, constants among them, as records.
  void store(std::byte* out);

 private:
  enum Axis : unsigned { kAxisX, kAxisZ, kAxisY };  // in the order of copies
  [[nodiscard]] std::size_t step(unsigned axis) const;
  [[nodiscard]] std::size_t kept(std::size_t blocks) const;
  [[nodiscard]] std::int32_t place_of(unsigned axis) const;
  [[nodiscard]] std::uint16_t* slot(std::size_t place) const {
    return ring_ + place % slots_ * size_;
  }
  const std::uint16_t* values(std::size_t place, const BlockTable& records, std::uint16_t* room);
  const std::uint16_t* copied(std::size_t b, unsigned axis, const BlockTable& records);
  void unpack(const std::byte* records, std::uint16_t* planes);
  void load_row_before(std::size_t b, const BlockTable& records);

  const Update& u_;
  std::span<const std::uint32_t> positions_;
  TokenMemory& memory_;
  PlaneLayout layout_;
  bool refers_, continues_, copies_;
  std::size_t texels_, stride_, size_;  // of a plane, and of all of a block
  std::size_t slots_;                   // blocks that are kept: place b is slot b modulo these
  Grid at_{};                           // of the loaded block in the box
  std::uint16_t *packed_, *before_, *zeros_, *room_, *ring_;
  std::uint16_t* current_;
  const std::uint16_t* reference_;
  std::array<const std::uint16_t*, kCopies> copy_{};
  bool has_before_ = false;
};

}  // namespace gicodec::native
