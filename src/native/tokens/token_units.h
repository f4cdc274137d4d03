// Units of 16 tokens. Those whose tokens are all 0 may have no codes: a map says which
// (docs/native/tokens.md, "Sparse groups").
#pragma once

#include "base/bytes.h"
#include "base/memory.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace gicodec::native {

inline constexpr std::size_t kUnit = 16;

/// Which units of a group are coded.
class TokenUnits {
 public:
  /// `texels`: of a block; its last unit may have fewer tokens than others.
  TokenUnits(std::size_t blocks, std::size_t texels, Vector<std::uint8_t>& map) noexcept
      : texels_(texels), units_((texels + kUnit - 1) / kUnit), count_(blocks * units_), map_(map) {}

  /// Whether a sample of these tokens, block behind block, has enough units without codes.
  [[nodiscard]] bool quiet(std::span<const std::uint8_t> tokens) const noexcept;
  /// Finds the units that are coded.
  void find(std::span<const std::uint8_t> tokens);
  /// Tokens that are coded of blocks from `first` to before `last`.
  [[nodiscard]] std::size_t coded(std::size_t first, std::size_t last) const noexcept;
  /// Moves the tokens of a block that are coded to `out`. Returns where they end.
  std::uint8_t* gather(std::size_t block, const std::uint8_t* tokens,
                       std::uint8_t* out) const noexcept;
  /// The inverse. `out` has room for whole units. Returns where the block's tokens end.
  const std::uint8_t* scatter(std::size_t block, const std::uint8_t* tokens,
                              std::uint8_t* out) const noexcept;

  /// The map behind its size.
  void write(ByteWriter& writer) const;
  /// False where these bytes are no map of so many units.
  [[nodiscard]] bool read(std::span<const std::byte> bytes);

 private:
  [[nodiscard]] bool is_coded(std::size_t unit) const noexcept {
    return (map_[unit / 8] >> unit % 8 & 1) != 0;
  }
  [[nodiscard]] std::size_t size_of(std::size_t unit) const noexcept {
    return unit + 1 < units_ ? kUnit : texels_ - unit * kUnit;
  }

  std::size_t texels_, units_, count_;
  Vector<std::uint8_t>& map_;
};

}  // namespace gicodec::native
