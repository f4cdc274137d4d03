// The lossy step of what is published within a bounded error: all blocks at a time get what takes
// the fewest bits.
#pragma once

#include <gicodec/backend.h>
#include <gicodec/isa.h>
#include <gicodec/texture.h>

#include "base/memory.h"
#include "quantise/coding_cost.h"
#include "quantise/error_grid.h"
#include "texture/view.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace gicodec {

/// Of one texture. What is held of it, a MirrorView, is what was published before, moved as it is.
class Quantiser {
 public:
  /// Nothing is kept further off than `max_error` (error_bound.h).
  Quantiser(const TextureDesc& desc, Isa isa, float max_error);
  /// True if nothing moves: nothing else needs to be called then.
  [[nodiscard]] bool exact() const noexcept { return grid_.exact(); }

  /// Chooses how `blocks` (ascending, unique) of a view move. `presence`: of every block of the
  /// texture, or nothing. Throws bad_alloc.
  void begin(const CheckedView<const std::byte>& view, std::span<const std::uint32_t> blocks,
             std::span<const std::byte> presence, const MirrorView& held);
  /// Moves the records of the i-th of them. `exists`: which there are, or nothing. Different blocks
  /// at a time by any threads.
  void apply(std::size_t i, const MirrorView& held, std::span<const std::byte> exists,
             std::span<std::byte> records) noexcept;
  /// What was moved is held from now on; once more takes that back.
  void swap() noexcept;

  [[nodiscard]] std::size_t memory() const noexcept;  ///< bytes

 private:
  [[nodiscard]] std::span<std::byte> given(std::uint32_t block) noexcept {
    return std::span(given_).subspan(block * block_bytes_, block_bytes_);
  }

  TextureDesc desc_;
  Isa isa_;
  ErrorGrid grid_;
  std::size_t block_bytes_;
  Vector<std::byte> given_;       ///< by block, what is held was made of
  Vector<std::byte> next_given_;  ///< of `blocks_`; after swap(), what it takes back
  Vector<std::uint32_t> blocks_;  ///< of begin()
  struct Costs {
    CodingCost exact, to_grid, follow, stay;
  };
  std::optional<Costs> costs_;
  bool exact_ = false;   ///< what comes first is not moved to the grid
  bool follow_ = false;  ///< what changes does so as its source does
  // Scratch of begin().
  Vector<std::uint32_t> stale_;
  Vector<std::byte> now_, tried_;
};

}  // namespace gicodec
