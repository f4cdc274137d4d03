// Token chunks of the reference decoder (docs/native/tokens.md).
#pragma once

#include "native/reference_model.h"
#include "native/reference_packing.h"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace gicodec::reference {

/// What a block refers to, what it may copy: X, Z, Y, and the place in the chunk of neighbour Y if
/// it is one of its blocks, else -1.
struct TokenAround {
  Values reference;
  std::array<Values, 3> copies;
  std::ptrdiff_t above = -1;
};

class TokenReader {
 public:
  TokenReader(const RecordPlanes& planes, const BlockShape& block, std::size_t texels,
              std::size_t blocks)
      : planes_(planes), columns_(block.x), rows_(block.y), texels_(texels), blocks_(blocks) {}

  /// The head, the tokens and the raw bits; false if something is wrong with them.
  bool read(unsigned first, Bytes& in);
  /// The next block's values.
  Values next(const TokenAround& around);
  /// Whether all raw bits were read, and nothing else is there.
  [[nodiscard]] bool finished() const;

 private:
  struct Group {
    std::vector<std::size_t> planes;
    bool copies = false, follows = false;
    unsigned prediction = 0, small = 1, widest = 0;
    std::vector<bool> coded;       ///< units that have codes; empty: all
    std::vector<unsigned> tokens;  ///< of all blocks
    std::vector<Values> last_row;  ///< of the first slice, by block: differences as they are coded
    std::vector<std::byte> raw;
    std::size_t at = 0;  ///< bits
    [[nodiscard]] unsigned count() const { return small + (copies ? 3 : 0) + widest - 1; }
  };
  bool read_group(Group& group, unsigned streams, Bytes& in) const;
  bool read_map(Bytes& in, Group& group) const;
  bool read_stream(std::span<const std::byte> bytes, const std::vector<unsigned>& lengths,
                   std::size_t begin, std::size_t end, Group& group) const;
  [[nodiscard]] std::size_t units_of_block() const { return (texels_ + 15) / 16; }
  int raw_bits(Group& group, unsigned bits);
  void read_block(Group& group, const TokenAround& around, Values& values);

  const RecordPlanes& planes_;
  unsigned columns_, rows_;
  std::size_t texels_, blocks_, block_ = 0;
  std::vector<Group> groups_;
  bool continues_ = false;
  std::vector<int> constant_;  ///< by plane; -1: it is coded
};

}  // namespace gicodec::reference
