// Blocks of one texture as they were at different times. What many clients were sent last is kept
// here once, however many they are; each of them holds a number per probe.
#pragma once

#include <gicodec/isa.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>

#include "texture/view.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace gicodec {

// Between two calls of publish() any number of threads may read, hold and release.

/// A block that never changes, until nobody holds it.
using BlockId = std::uint32_t;
inline constexpr BlockId kZeroBlock = 0;  ///< all texels zero; always there

class BlockHistory {
 public:
  BlockHistory(const TextureDesc& desc, Isa isa);

  [[nodiscard]] const TextureDesc& desc() const noexcept { return desc_; }

  /// Makes the contents of a view the current ones; probes that did not change keep their block.
  /// Throws bad_alloc, and nothing has changed then.
  void publish(const CheckedView<const std::byte>& view);
  /// Counts the calls of publish(). A block number may mean another block in the next generation,
  /// unless somebody held it.
  [[nodiscard]] std::uint64_t generation() const noexcept { return generation_; }
  /// The current block of every probe.
  [[nodiscard]] std::span<const BlockId> current() const noexcept { return current_; }

  /// Core texels of a block, and its guard band if that does not follow the rule, else nothing.
  [[nodiscard]] std::span<const std::byte> core(BlockId id) const noexcept {
    return std::span(cores_).subspan(id * core_bytes_, core_bytes_);
  }
  [[nodiscard]] std::span<const std::byte> stale_ring(BlockId id) const;
  [[nodiscard]] bool same_core(BlockId a, BlockId b) const noexcept;

  /// Every hold() needs its release(); the current blocks are held by the history itself.
  void hold(BlockId id) noexcept;
  void release(BlockId id) noexcept;

  /// Blocks that somebody holds, the zero block included.
  [[nodiscard]] std::size_t blocks() const noexcept { return holders_.size() - free_.size(); }
  [[nodiscard]] std::size_t memory() const noexcept;  ///< bytes

 private:
  [[nodiscard]] std::span<const std::byte> stripped(std::uint32_t probe) const noexcept {
    return std::span(stripped_).subspan(probe * core_bytes_, core_bytes_);
  }
  void find_changes(const CheckedView<const std::byte>& view);
  void collect();
  void make_room(std::size_t blocks);

  TextureDesc desc_;
  Isa isa_;
  std::size_t core_bytes_;
  std::vector<std::byte> cores_;
  std::vector<std::uint32_t> digests_;  ///< of cores: tell most that differ apart in few bytes
  std::vector<std::uint32_t> holders_;  ///< accessed atomically outside publish()
  std::vector<BlockId> free_;
  std::map<BlockId, std::vector<std::byte>> stale_;
  std::vector<BlockId> current_;
  std::uint64_t generation_ = 0;
  // Scratch of publish().
  std::vector<std::uint32_t> probes_, stale_places_, changed_;
  std::map<std::uint32_t, std::vector<std::byte>> changed_rings_;  ///< stale ones, by probe
  std::vector<std::byte> stripped_, ring_;
};

}  // namespace gicodec
