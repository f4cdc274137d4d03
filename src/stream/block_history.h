// Blocks of one texture as they were at different times. What receivers were sent last is kept here
// once, however many they are; each of them holds a number per block.
#pragma once

#include <gicodec/backend.h>
#include <gicodec/isa.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>

#include "base/atomic_count.h"
#include "base/memory.h"
#include "quantise/quantiser.h"
#include "texture/view.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>

namespace gicodec {

// Between two calls of publish() any number of threads may read, hold and release what a server
// has.

/// Contents of a block that never change, until nobody holds them.
using BlockId = std::uint32_t;
inline constexpr BlockId kNothing = 0;  ///< nothing was received: zeros; always there

class BlockHistory {
 public:
  /// A server asks for same_records() often, and has threads that hold and release.
  enum class Use : std::uint8_t { encoder, server };
  /// What is published is kept no further off than `max_error` (error_bound.h).
  BlockHistory(const TextureDesc& desc, Isa isa, Use use, const Threads& threads = {},
               float max_error = 0);

  [[nodiscard]] const TextureDesc& desc() const noexcept { return desc_; }
  /// Whether contents may be off.
  [[nodiscard]] bool lossy() const noexcept { return !quantiser_.exact(); }

  /// Makes the contents of `blocks` (ascending, unique) in a view the current ones; those that did
  /// not change keep their number. `presence`: of every block of the texture. Throws bad_alloc, and
  /// nothing has changed then.
  void publish(const CheckedView<const std::byte>& view, std::span<const std::uint32_t> blocks,
               std::span<const std::byte> presence = {});
  /// Takes back the last publish(); precondition: no other one since, and nobody holds what it made
  /// current.
  void undo() noexcept;
  /// The current contents of every block.
  [[nodiscard]] std::span<const BlockId> current() const noexcept { return current_; }

  /// All contents, by number.
  [[nodiscard]] BlockTable table() const noexcept { return {records_.data(), block_bytes_}; }
  [[nodiscard]] std::span<const std::byte> records(BlockId id) const noexcept {
    return table()[id];
  }
  /// Which records exist; nothing where all do.
  [[nodiscard]] BlockTable presence_table() const noexcept {
    return {presence_.data(), presence_bytes_};
  }
  [[nodiscard]] std::span<const std::byte> presence(BlockId id) const noexcept {
    return presence_table()[id];
  }
  /// False if no guard band that was published and is held is stale.
  [[nodiscard]] bool has_stale_bands() const noexcept { return !stale_.empty(); }
  /// The guard band if it does not follow the rule, else nothing.
  [[nodiscard]] std::span<const std::byte> stale_band(BlockId id) const;
  /// True of zeros with a guard band by the rule.
  [[nodiscard]] bool is_zero(BlockId id) const;
  [[nodiscard]] bool same_records(BlockId a, BlockId b) const noexcept;

  /// What a lossy backend made of contents.
  void replace(BlockId id, std::span<const std::byte> records) noexcept;

  /// Every hold() needs its release(); the current contents are held by the history itself.
  void hold(BlockId id) noexcept {
    use_ == Use::server ? add(holders_[id]) : static_cast<void>(++holders_[id]);
  }
  void release(BlockId id) noexcept {
    use_ == Use::server ? subtract(holders_[id]) : static_cast<void>(--holders_[id]);
  }

  /// Contents that somebody holds, nothing included.
  [[nodiscard]] std::size_t size() const noexcept;
  [[nodiscard]] std::size_t memory() const noexcept;  ///< bytes

 private:
  [[nodiscard]] std::span<std::byte> at(BlockId id, std::size_t blocks) noexcept {
    return std::span(records_).subspan(id * block_bytes_, blocks * block_bytes_);
  }
  [[nodiscard]] bool is_current(std::uint32_t block, std::span<const std::byte> records,
                                std::span<const std::byte> exists,
                                std::span<const std::byte> band) const;
  void make_room(std::size_t blocks);
  /// Where the band of new contents goes.
  [[nodiscard]] std::span<std::byte> stale_room(BlockId id);
  /// What publish() moves records beside.
  [[nodiscard]] MirrorView held() const noexcept {
    return {{records_.data(), block_bytes_, current_.data()}};
  }
  /// What publish() did with a block.
  struct Published {
    BlockId id = kNothing;    ///< its new number; nothing if it did not change
    bool stale = false;       ///< and has such a guard band
    std::uint32_t block = 0;  ///< set when it is current, as is
    BlockId before = kNothing;
  };
  /// What one thread of publish() needs.
  struct Scratch {
    Vector<std::uint32_t> stale;
    Vector<std::byte> band, room;
  };
  void publish_range(const CheckedView<const std::byte>& view,
                     std::span<const std::uint32_t> blocks, std::span<const std::byte> presence,
                     std::span<const BlockId> free, std::span<Published> published,
                     Scratch& scratch);

  TextureDesc desc_;
  Isa isa_;
  Use use_;
  Threads threads_;
  Quantiser quantiser_;
  std::size_t block_bytes_, presence_bytes_;
  Vector<std::byte> records_, presence_;
  /// Of a server's records: tell most that differ apart in few bytes.
  Vector<std::uint32_t> digests_;
  Vector<std::uint32_t> holders_;  ///< accessed atomically outside publish()
  using Bands = std::map<BlockId, Vector<std::byte>>;
  Bands stale_;
  std::vector<Bands::node_type> spare_;  ///< of bands that nobody holds any more
  Vector<BlockId> current_;
  // Scratch of publish().
  Vector<BlockId> free_;  ///< one for each block at least, ascending
  Vector<Published> published_;
  Vector<Scratch> scratch_;
};

}  // namespace gicodec
