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

/// As those of a Decoder, for every texture.
struct VolumeDecoderOptions {
  DecodeLimits limits = {};                   ///< max_total_bytes: of all textures together
  std::vector<const Backend*> backends = {};  ///< besides the built-in ones; during create() only
  Threads threads = {};                       ///< per packet, and of read() of large textures
  Isa isa = best_isa();
  const std::atomic<bool>* cancel = nullptr;  ///< as DecoderOptions::cancel
  std::uint8_t first_texture = 0;             ///< as VolumeEncoderOptions::first_texture
};

/// Turns the packets of a VolumeEncoder back into the volume's textures; its page has an example.
/// Safe on hostile bytes: a packet is either applied completely or not at all. One thread at a time
/// per decoder. Movable; a moved-from decoder may only be destroyed or assigned to.
class VolumeDecoder {
 public:
  /// Errors: those of validate() and of Decoder::create(); invalid_argument for texture ids beyond
  /// 255.
  [[nodiscard]] static Result<VolumeDecoder> create(const VolumeDesc& volume,
                                                    const VolumeDecoderOptions& options = {});
  VolumeDecoder(VolumeDecoder&&) noexcept;
  VolumeDecoder& operator=(VolumeDecoder&&) noexcept;
  ~VolumeDecoder();

  /// Applies the packets of an update, in their order; those that were applied last are passed
  /// over. Nothing is applied unless they are of textures of this volume, each at most once, in
  /// ascending order: unknown_texture, out_of_order. Other errors, those of Decoder::decode(),
  /// leave the packet's texture and those behind it as they were: the same call again goes on
  /// where memory was short; else they need a keyframe.
  Status decode(std::span<const Packet> update);
  /// The same with one packet. What says which records exist comes before those of which it does.
  Status decode(std::span<const std::byte> packet);

  /// Writes a texture, or some of its blocks, guard bands included; zeros where nothing was
  /// received. unknown_texture, view_too_small, block_out_of_range.
  Status read(std::uint8_t texture, TextureView view) const;
  Status read(std::uint8_t texture, TextureView view, std::span<const std::uint32_t> blocks) const;
  /// Blocks that the last decode() may have changed, ascending: those that a packet lists, or all
  /// for a keyframe. Valid until the next one.
  [[nodiscard]] std::span<const std::uint32_t> changed(std::uint8_t texture) const noexcept;
  /// The decoder of a texture, to look at its records(); null for an unknown texture.
  [[nodiscard]] const Decoder* decoder(std::uint8_t texture) const noexcept;

  [[nodiscard]] const VolumeDesc& desc() const noexcept;
  /// What is held at its worst, as limits.max_total_bytes counts it.
  [[nodiscard]] std::uint64_t memory() const noexcept;

 private:
  struct GICODEC_LOCAL State;
  explicit VolumeDecoder(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

}  // namespace gicodec
