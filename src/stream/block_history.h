// The contents of a texture's blocks at different times. Contents that receivers hold are stored
// once, for any number of receivers; a receiver's state is a number per block.
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

// With Use::server, threads may read, hold and release between two calls of publish().

/// A version of a block: the number of its contents, which do not change while it is held.
using BlockId = std::uint32_t;
inline constexpr BlockId kNothing = 0;  ///< not received: zeros; always exists

class BlockHistory {
 public:
  /// A server calls same_records() often, and holds and releases on several threads.
  enum class Use : std::uint8_t { encoder, server };
  /// Contents keep within `max_error` of what is published (error_bound.h).
  BlockHistory(const TextureDesc& desc, Isa isa, Use use, const Threads& threads = {},
               float max_error = 0);

  [[nodiscard]] const TextureDesc& desc() const noexcept { return desc_; }
  /// True if contents may differ from what was published.
  [[nodiscard]] bool lossy() const noexcept { return !quantiser_.exact(); }

  /// Makes the contents of `blocks` (ascending, unique) in a view current; unchanged blocks keep
  /// their number. `presence`: of all blocks. Throws bad_alloc; then nothing has changed.
  void publish(const CheckedView<const std::byte>& view, std::span<const std::uint32_t> blocks,
               std::span<const std::byte> presence = {});
  /// Undoes the last publish(). Precondition: nothing holds what it made current.
  void undo() noexcept;
  /// The current contents of every block.
  [[nodiscard]] std::span<const BlockId> current() const noexcept { return current_; }

  /// Records of all contents, by number.
  [[nodiscard]] BlockTable table() const noexcept { return {records_.data(), block_bytes_}; }
  [[nodiscard]] std::span<const std::byte> records(BlockId id) const noexcept {
    return table()[id];
  }
  /// Presence of all contents, by number; empty for Presence::all.
  [[nodiscard]] BlockTable presence_table() const noexcept {
    return {presence_.data(), presence_bytes_};
  }
  [[nodiscard]] std::span<const std::byte> presence(BlockId id) const noexcept {
    return presence_table()[id];
  }
  /// False if no contents have an irregular guard band.
  [[nodiscard]] bool has_stale_bands() const noexcept { return !stale_.empty(); }
  /// The guard band if it is irregular, else empty.
  [[nodiscard]] std::span<const std::byte> stale_band(BlockId id) const;
  /// True for zeros with a regular guard band.
  [[nodiscard]] bool is_zero(BlockId id) const;
  [[nodiscard]] bool same_records(BlockId a, BlockId b) const noexcept;

  /// Replaces contents by what a lossy backend made of them.
  void replace(BlockId id, std::span<const std::byte> records) noexcept;

  /// Each hold() needs a release(). The history itself holds current contents.
  void hold(BlockId id) noexcept {
    use_ == Use::server ? add(holders_[id]) : static_cast<void>(++holders_[id]);
  }
  void release(BlockId id) noexcept {
    use_ == Use::server ? subtract(holders_[id]) : static_cast<void>(--holders_[id]);
  }

  /// Number of contents that are held, kNothing included.
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
  /// Memory for the band of new contents.
  [[nodiscard]] std::span<std::byte> stale_room(BlockId id);
  /// The current contents, for the quantiser.
  [[nodiscard]] MirrorView held() const noexcept {
    return {{records_.data(), block_bytes_, current_.data()}};
  }
  /// The result of publish() for a block.
  struct Published {
    BlockId id = kNothing;    ///< its new number; kNothing if unchanged
    bool stale = false;       ///< its guard band is irregular
    std::uint32_t block = 0;  ///< set once it is current, like `before`
    BlockId before = kNothing;
  };
  /// Scratch of one thread of publish().
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
  /// Use::server: checksums of records, for fast comparison.
  Vector<std::uint32_t> digests_;
  Vector<std::uint32_t> holders_;  ///< accessed atomically outside publish()
  using Bands = std::map<BlockId, Vector<std::byte>>;
  Bands stale_;
  std::vector<Bands::node_type> spare_;  ///< nodes to reuse
  Vector<BlockId> current_;
  BlockId next_free_ = kNothing + 1;  ///< where to look for one
  // Scratch of publish().
  Vector<BlockId> free_;  ///< at least one per block, ascending but for one step back at most
  Vector<Published> published_;
  Vector<Scratch> scratch_;
};

}  // namespace gicodec
