// Decoder session: packets in, texture out.
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

/// Working memory that decoders of one thread may share, when there are many of them.
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
  /// Besides the built-in ones; needed during create() only. Those that answer unsupported_format
  /// or unsupported_shape for the description are left out.
  std::vector<const Backend*> backends = {};
  Threads threads = {};  ///< per packet, and of read() of large textures
  /// If set, adds up where the bits of payloads went; must outlive the decoder.
  PayloadStatistics* statistics = nullptr;
  Isa isa = best_isa();  ///< every kernel, those of backends too; the machine must have it
  /// If set, and set to true by any thread: decode() ends soon with Status::cancelled, as after any
  /// other error. Must outlive the decoder.
  const std::atomic<bool>* cancel = nullptr;
  std::shared_ptr<DecoderScratch> scratch = nullptr;  ///< empty: the decoder has its own
};

/// Most that a decoder of such a texture ever holds in memory, besides packets and views: what
/// DecodeLimits::max_total_bytes is compared with. `threads` as in DecoderOptions.
[[nodiscard]] std::uint64_t decoder_memory(const TextureDesc& desc, unsigned threads = 1) noexcept;

/// Turns packets back into the records they were made from. Safe on hostile bytes: a packet is
/// either applied completely or not at all. One thread at a time per decoder; different decoders
/// are independent. Movable; a moved-from decoder may only be destroyed or assigned to.
class Decoder {
 public:
  /// Errors: invalid_description, invalid_settings (threads, isa), limit_exceeded
  /// (max_texture_bytes, max_total_bytes), out_of_memory.
  [[nodiscard]] static Result<Decoder> create(const TextureDesc& desc,
                                              const DecoderOptions& options = {});
  Decoder(Decoder&&) noexcept;
  Decoder& operator=(Decoder&&) noexcept;
  ~Decoder();

  /// Applies one packet to the mirror. After an error the mirror is what it was before.
  /// reference_missing: a packet before this one was not applied; wait for a keyframe.
  /// limit_exceeded: its size or its work is beyond the limits. out_of_order: set_presence() is
  /// needed and has not been called.
  Status decode(std::span<const std::byte> packet);
  /// The same, and writes the blocks that the packet may have changed, changed(), into `view`,
  /// guard bands included. `view` thus stays equal to the mirror if it was equal before.
  /// view_too_small is found before anything is applied.
  Status decode(std::span<const std::byte> packet, TextureView view);

  /// Which records exist, where the description has them counted or masked: what decode() goes by
  /// from now on, e.g. the records() of the decoder of their texture. Not copied. mask_mismatch
  /// for another size; decode() answers corrupt where a block has no such records.
  Status set_presence(std::span<const std::byte> presence);

  /// Writes the whole texture, or some blocks, into `view`.
  Status read(TextureView view) const;
  Status read(TextureView view, std::span<const std::uint32_t> blocks) const;
  /// Writes blocks to other places: blocks[i] to where block places[i] of `desc` stands in `view`,
  /// e.g. those of a region into the texture of the volume (RegionGrid::block_of()).
  /// invalid_argument for lists of different lengths or blocks of another shape or record;
  /// block_out_of_range; view_too_small.
  Status read(std::span<const std::uint32_t> blocks, const TextureDesc& desc, TextureView view,
              std::span<const std::uint32_t> places) const;

  /// Every block, tightly packed; zero where none was received.
  [[nodiscard]] std::span<const std::byte> records() const noexcept;
  /// Per block, not 0 if a packet has brought it since the last keyframe.
  [[nodiscard]] std::span<const std::uint8_t> received() const noexcept;
  /// Blocks that the last packet applied may have changed, ascending: those that it lists, or all
  /// for a keyframe. Valid until the next call of decode().
  [[nodiscard]] std::span<const std::uint32_t> changed() const noexcept;
  [[nodiscard]] const TextureDesc& desc() const noexcept;
  /// Number of the last update applied; 0 before the first.
  [[nodiscard]] std::uint32_t sequence() const noexcept;
  /// Together with sequence(), names the state that the next update must build on.
  [[nodiscard]] std::uint32_t checksum() const noexcept;
  /// A number for the whole contents, equal to that of UpdateMessage::Proof where a client holds
  /// the same.
  [[nodiscard]] std::uint64_t state_hash() const noexcept;

 private:
  struct GICODEC_LOCAL State;
  explicit Decoder(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

}  // namespace gicodec
