// The blocks of a token chunk: what each refers to and may copy, as planes.
#pragma once

#include "native/frame/workspace.h"
#include "native/tokens/token_chunk.h"
#include "native/tokens/token_head.h"

#include <span>

namespace gicodec::native {

/// Unpacks blocks one at a time, with what they are predicted from.
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
  [[nodiscard]] const PlaneLayout& layout() const { return layout_; }
  [[nodiscard]] std::size_t texels() const { return texels_; }
  /// Packs the planes, constants among them, as records.
  void store(std::byte* out);

 private:
  enum Axis : unsigned { kAxisX, kAxisZ, kAxisY };  // in the order of copies
  [[nodiscard]] const std::byte* neighbour(std::size_t b, unsigned axis, const BlockTable& records,
                                           bool in_chunk_only) const;
  void unpack(const std::byte* records, std::uint16_t* planes);
  void load_row_before(std::size_t b, const BlockTable& records);

  const Update& u_;
  std::span<const std::uint32_t> positions_;
  TokenMemory& memory_;
  PlaneLayout layout_;
  bool refers_, continues_, copies_;
  std::size_t texels_, stride_;
  std::uint16_t *packed_, *current_, *reference_;
  std::uint16_t* before_;  // by plane: differences of the row before the block
  bool has_before_ = false;
  std::array<std::uint16_t*, kCopies> copy_;
};

}  // namespace gicodec::native
