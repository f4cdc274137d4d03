// Decoder of all textures of a volume.
#pragma once

#include <gicodec/api.h>
#include <gicodec/backend.h>
#include <gicodec/decoder.h>
#include <gicodec/isa.h>
#include <gicodec/kind.h>
#include <gicodec/packet.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>
#include <gicodec/threads.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace GICODEC_API gicodec {

/// As DecoderOptions, for every texture.
struct VolumeDecoderOptions {
  DecodeLimits limits = {};                   ///< max_total_bytes: of all textures together
  std::vector<const Backend*> backends = {};  ///< besides the built-in ones; for create() only
  Threads threads = {};                       ///< per packet, and for read() of large textures
  Isa isa = best_isa();
  const std::atomic<bool>* cancel = nullptr;  ///< as DecoderOptions::cancel
  std::uint8_t first_texture = 0;             ///< as VolumeEncoderOptions::first_texture
};

/// Turns the packets of a VolumeEncoder (see its example) back into the volume's textures. Safe on
/// hostile bytes: a packet is applied completely or not at all. One thread at a time per decoder. A
/// moved-from decoder may only be destroyed or assigned to.
class VolumeDecoder {
 public:
  /// Errors: those of validate() and of Decoder::create(); invalid_argument for texture ids beyond
  /// 255.
  [[nodiscard]] static Result<VolumeDecoder> create(const VolumeDesc& volume,
                                                    const VolumeDecoderOptions& options = {});
  VolumeDecoder(VolumeDecoder&&) noexcept;
  VolumeDecoder& operator=(VolumeDecoder&&) noexcept;
  ~VolumeDecoder();

  /// Applies the packets of an update in order; skips a packet that its texture's decoder applied
  /// last. The packets' textures must be of this volume and ascend without repetition; otherwise
  /// unknown_texture or out_of_order, and nothing is applied. Other errors are those of
  /// Decoder::decode(): the failed packet and those behind it are not applied. After out_of_memory
  /// repeat the same call, which continues; after others these textures need a keyframe.
  Status decode(std::span<const Packet> update);
  /// The same with one packet. A packet of presence comes before those of the textures it is for.
  Status decode(std::span<const std::byte> packet);

  /// Writes a texture, or some of its blocks, guard bands included; blocks that were not received
  /// are zero. unknown_texture, view_too_small, block_out_of_range.
  Status read(std::uint8_t texture, TextureView view) const;
  Status read(std::uint8_t texture, TextureView view, std::span<const std::uint32_t> blocks) const;
  /// Blocks that the last decode() may have changed, ascending: those that a packet lists, or all
  /// for a keyframe. Valid until the next decode().
  [[nodiscard]] std::span<const std::uint32_t> changed(std::uint8_t texture) const noexcept;
  /// The decoder of a texture, e.g. for its records(); null for an unknown texture.
  [[nodiscard]] const Decoder* decoder(std::uint8_t texture) const noexcept;

  [[nodiscard]] const VolumeDesc& desc() const noexcept;
  /// Peak bytes of all decoders, as limits.max_total_bytes counts them.
  [[nodiscard]] std::uint64_t memory() const noexcept;

 private:
  struct GICODEC_LOCAL State;
  explicit VolumeDecoder(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

}  // namespace gicodec
