// Encoder session: texture in, packets out.
#pragma once

#include <gicodec/api.h>
#include <gicodec/backend.h>
#include <gicodec/packet.h>
#include <gicodec/settings.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace GICODEC_API gicodec {

struct EncoderOptions {
  /// By name, built in or from `backends`.
  std::string_view backend = "native";
  BackendSettings settings = {};  ///< level, preset, difference, threads, isa
  std::uint32_t gop = 30;         ///< a keyframe every `gop` packets; 0: only on request
  std::uint8_t texture_id = 0;    ///< written into every packet
  /// How far decoded records may be off, see error_bound.h. Where that is anything
  /// (allows_error()), packets say that they are lossy; records stay what was sent while that is
  /// near enough, or move as their source does, whichever takes fewer bytes, and blocks that did
  /// not change are not sent again.
  float max_error = 0;
  std::vector<const Backend*> backends = {};  ///< further ones, needed during create() only
};

/// Which blocks go into a packet. Refers to the caller's list, does not copy it.
class Selection {
 public:
  /// Every block that the decoder does not hold as it is. As long as set_active() did not say which
  /// blocks matter, those that are zero throughout (as they are sent, under a bound) and were never
  /// sent are taken for held.
  [[nodiscard]] static constexpr Selection changed() noexcept { return {Kind::changed, {}}; }
  /// Every block, whether it changed or not.
  [[nodiscard]] static constexpr Selection all() noexcept { return {Kind::all, {}}; }
  /// These blocks, in any order, each at most once; an empty list gives an empty update.
  constexpr Selection(std::span<const std::uint32_t> blocks) noexcept  // NOLINT
      : Selection(Kind::list, blocks) {}
  constexpr Selection(const std::vector<std::uint32_t>& blocks) noexcept  // NOLINT
      : Selection(Kind::list, blocks) {}

  enum class Kind : std::uint8_t { changed, all, list };
  [[nodiscard]] constexpr Kind kind() const noexcept { return kind_; }
  [[nodiscard]] constexpr std::span<const std::uint32_t> list() const noexcept { return blocks_; }

 private:
  constexpr Selection(Kind kind, std::span<const std::uint32_t> blocks) noexcept
      : blocks_(blocks), kind_(kind) {}
  std::span<const std::uint32_t> blocks_;
  Kind kind_;
};

/// Turns successive contents of one texture into packets (Stengel et al. §3.3, §3.4). Holds the
/// mirror, i.e. what a decoder knows after the last packet. The first packet is a keyframe. One
/// thread at a time per encoder; different encoders are independent. Movable; a moved-from encoder
/// may only be destroyed or assigned to.
class Encoder {
 public:
  /// Errors: invalid_description; unknown_backend; invalid_settings (a level, preset, chunk, number
  /// of threads or isa that the backend does not take); invalid_bound (max_error);
  /// unsupported_format and unsupported_shape, what the backend does not code; out_of_memory.
  [[nodiscard]] static Result<Encoder> create(const TextureDesc& desc,
                                              const EncoderOptions& options = {});
  Encoder(Encoder&&) noexcept;
  Encoder& operator=(Encoder&&) noexcept;
  ~Encoder();

  /// Codes the selected blocks of `view`. Unselected ones keep their mirror value, or become zero
  /// at the decoder in a keyframe. An error leaves mirror and sequence as they were.
  /// Errors: view_too_small, block_out_of_range, block_repeated, backend_failed, out_of_memory;
  /// out_of_order where set_presence() is needed and has not been called.
  [[nodiscard]] Result<Packet> encode(ConstTextureView view,
                                      Selection selection = Selection::changed());
  /// The same, replacing the contents of `out` and keeping its capacity.
  Status encode_to(ConstTextureView view, Selection selection, Packet& out);
  /// The same into the caller's memory; returns the packet's size. buffer_too_small if `out` is
  /// smaller than the packet; bound() bytes always suffice.
  [[nodiscard]] Result<std::size_t> encode_to(ConstTextureView view, Selection selection,
                                              std::span<std::byte> out);
  /// Upper bound of the size of a packet of that many blocks.
  [[nodiscard]] std::size_t bound(std::size_t blocks) const noexcept;

  /// A keyframe of the mirror as it stands, for decoders that join late: after it they follow the
  /// packets that come next, as if they had applied the last one. Changes nothing here.
  /// out_of_order before the first packet; unsupported_backend with one that is_stateful().
  [[nodiscard]] Result<Packet> snapshot();
  /// Makes the next packet a keyframe.
  void request_keyframe() noexcept;
  /// Blocks that Selection::changed() never selects (e.g. probes inside walls): one byte per block,
  /// 0 for inactive; empty: nothing is said. In a keyframe they are zero at the decoder.
  /// mask_mismatch.
  Status set_active(std::span<const std::uint8_t> active);
  /// Which records exist from now on, where the description has them counted or masked:
  /// presence_bytes() per block, of all blocks. What does not exist is coded as zero, whatever the
  /// view holds. Only that of the selected blocks is looked at, and the decoder of their packet
  /// must be told the same of them: with a list, encode the texture that says it first, with that
  /// list. mask_mismatch for another size, presence_invalid for records that a block does not have.
  Status set_presence(std::span<const std::byte> presence);

  /// Writes the mirror into `view`: what a decoder holds after the last packet.
  Status read(TextureView view) const;
  [[nodiscard]] const TextureDesc& desc() const noexcept;
  [[nodiscard]] std::uint32_t sequence() const noexcept;  ///< of the last packet; 0 before it
  [[nodiscard]] bool lossy() const noexcept;

 private:
  struct GICODEC_LOCAL State;
  explicit Encoder(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

}  // namespace gicodec
