// Decoder: packets in, texture out.
#pragma once

#include <gicodec/api.h>
#include <gicodec/backend.h>
#include <gicodec/packet.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace GICODEC_API gicodec {

/// Working memory for many decoders to share. They must then run one at a time.
class DecoderScratch {
 public:
  /// out_of_memory.
  [[nodiscard]] static Result<std::shared_ptr<DecoderScratch>> create();
  ~DecoderScratch();

 private:
  friend class Decoder;
  struct GICODEC_LOCAL State;
  explicit DecoderScratch(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

struct DecoderOptions {
  DecodeLimits limits = {};
  /// Besides the built-in ones; used during create() only. Backends that answer unsupported_format
  /// or unsupported_shape are left out.
  std::vector<const Backend*> backends = {};
  Threads threads = {};  ///< per packet, and for read() of large textures
  /// If set, decode() adds to it. Must outlive the decoder.
  PayloadStatistics* statistics = nullptr;
  Isa isa = best_isa();  ///< kernels, the backends' too; the machine must have it
  /// If set: once any thread makes it true, decode() soon fails with Status::cancelled. Must
  /// outlive the decoder.
  const std::atomic<bool>* cancel = nullptr;
  std::shared_ptr<DecoderScratch> scratch = nullptr;  ///< null: the decoder has its own
};

/// Peak memory of a decoder of such a texture, in bytes, without packets and views.
/// DecodeLimits::max_total_bytes limits it. `threads`: DecoderOptions::threads.count.
[[nodiscard]] std::uint64_t decoder_memory(const TextureDesc& desc, unsigned threads = 1) noexcept;

/// Turns packets back into the records they were made from. Safe on hostile bytes: a packet is
/// applied completely or not at all. One thread at a time per decoder; different decoders are
/// independent. A moved-from decoder may only be destroyed or assigned to.
class Decoder {
 public:
  /// Errors: invalid_description, invalid_settings (threads, isa), limit_exceeded
  /// (max_texture_bytes, max_total_bytes), out_of_memory.
  [[nodiscard]] static Result<Decoder> create(const TextureDesc& desc,
                                              const DecoderOptions& options = {});
  Decoder(Decoder&&) noexcept;
  Decoder& operator=(Decoder&&) noexcept;
  ~Decoder();

  /// Applies one packet to the mirror. An error leaves the mirror as before. reference_missing: an
  /// earlier packet was not applied; wait for a keyframe. limit_exceeded: the packet's size or work
  /// is beyond the limits. out_of_order: the texture needs set_presence() first.
  Status decode(std::span<const std::byte> packet);
  /// The same, then writes the blocks that the packet may have changed, changed(), into `view`,
  /// guard bands included. A view that equals the mirror stays equal. view_too_small is reported
  /// before the packet is applied.
  Status decode(std::span<const std::byte> packet, TextureView view);

  /// Sets which records exist for the next decode() calls, for a texture whose Presence is not all:
  /// e.g. the records() of the decoder of the presence texture. Not copied. mask_mismatch for
  /// another size; decode() answers corrupt if a block does not have such records.
  Status set_presence(std::span<const std::byte> presence);

  /// Writes the whole texture, or some blocks, into `view`. view_too_small, block_out_of_range.
  Status read(TextureView view) const;
  Status read(TextureView view, std::span<const std::uint32_t> blocks) const;
  /// Writes blocks to other places: blocks[i] to where block places[i] of `desc` stands in `view`,
  /// e.g. those of a region into the texture of the volume (RegionGrid::block_of()).
  /// invalid_argument for lists of different lengths or blocks of another shape or record;
  /// block_out_of_range; view_too_small.
  Status read(std::span<const std::uint32_t> blocks, const TextureDesc& desc, TextureView view,
              std::span<const std::uint32_t> places) const;

  /// All blocks, tightly packed; zero if not received.
  [[nodiscard]] std::span<const std::byte> records() const noexcept;
  /// One byte per block, not 0 if the last keyframe or a packet since then listed it.
  [[nodiscard]] std::span<const std::uint8_t> received() const noexcept;
  /// Blocks that the last packet applied may have changed, ascending: those that it lists, or all
  /// for a keyframe. Valid until the next call of decode().
  [[nodiscard]] std::span<const std::uint32_t> changed() const noexcept;
  [[nodiscard]] const TextureDesc& desc() const noexcept;
  /// Number of the last update applied; 0 before the first.
  [[nodiscard]] std::uint32_t sequence() const noexcept;
  /// Identifies, with sequence(), the state that the next update must build on.
  [[nodiscard]] std::uint32_t checksum() const noexcept;
  /// Hash of the whole contents. UpdateMessage::Proof holds the same hash for the same contents.
  [[nodiscard]] std::uint64_t state_hash() const noexcept;

 private:
  struct GICODEC_LOCAL State;
  explicit Decoder(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

}  // namespace gicodec
