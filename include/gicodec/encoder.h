// Encoder: texture in, packets out.
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
  /// Name of a backend, built in or from `backends`.
  std::string_view backend = "native";
  BackendSettings settings = {};
  std::uint32_t gop = 30;       ///< a keyframe every `gop` packets; 0: only on request
  std::uint8_t texture_id = 0;  ///< written into every packet; the application chooses it
  /// Error bound of decoded records, see error_bound.h; 0: lossless. If it allows_error(), packets
  /// are marked lossy. A record that changed then keeps the value sent before while that is within
  /// the bound, or changes by as much as the input, whichever takes fewer bytes. Unchanged blocks
  /// are not sent again.
  float max_error = 0;
  std::vector<const Backend*> backends = {};  ///< besides the built-in ones; for create() only
};

/// The blocks of a packet. Refers to the caller's list without copying it.
class Selection {
 public:
  /// Every block that differs from the mirror. Without set_active(), a block that was never sent
  /// and is all zero (as sent, under an error bound) does not count as different.
  [[nodiscard]] static constexpr Selection changed() noexcept { return {Type::changed, {}}; }
  /// Every block.
  [[nodiscard]] static constexpr Selection all() noexcept { return {Type::all, {}}; }
  /// These blocks, in any order, each at most once. An empty list gives an empty update.
  constexpr Selection(std::span<const std::uint32_t> blocks) noexcept  // NOLINT
      : Selection(Type::list, blocks) {}
  constexpr Selection(const std::vector<std::uint32_t>& blocks) noexcept  // NOLINT
      : Selection(Type::list, blocks) {}

  enum class Type : std::uint8_t { changed, all, list };
  [[nodiscard]] constexpr Type type() const noexcept { return type_; }
  [[nodiscard]] constexpr std::span<const std::uint32_t> list() const noexcept { return blocks_; }

 private:
  constexpr Selection(Type type, std::span<const std::uint32_t> blocks) noexcept
      : blocks_(blocks), type_(type) {}
  std::span<const std::uint32_t> blocks_;
  Type type_;
};

/// Turns successive contents of one texture into packets (Stengel et al. §3.3, §3.4). Holds the
/// mirror: what a decoder holds after the last packet. The first packet is a keyframe. One thread
/// at a time per encoder; different encoders are independent. A moved-from encoder may only be
/// destroyed or assigned to.
class Encoder {
 public:
  /// Errors: invalid_description; unknown_backend; invalid_settings (level, preset, chunk, threads,
  /// isa); invalid_bound (max_error); unsupported_format or unsupported_shape, if the backend
  /// cannot code the texture; out_of_memory.
  [[nodiscard]] static Result<Encoder> create(const TextureDesc& desc,
                                              const EncoderOptions& options = {});
  Encoder(Encoder&&) noexcept;
  Encoder& operator=(Encoder&&) noexcept;
  ~Encoder();

  /// Codes the selected blocks of `view`. Other blocks keep their mirror value; in a keyframe they
  /// become zero at the decoder. An error leaves mirror and sequence as before. Errors:
  /// view_too_small; block_out_of_range; block_repeated; backend_failed; out_of_memory;
  /// out_of_order if the texture needs set_presence() first.
  [[nodiscard]] Result<Packet> encode(ConstTextureView view,
                                      Selection selection = Selection::changed());
  /// The same, into `out`: replaces its contents and keeps its capacity.
  Status encode_to(ConstTextureView view, Selection selection, Packet& out);
  /// The same, into the caller's memory; returns the packet's bytes. buffer_too_small if `out` is
  /// smaller than the packet; bound() bytes always suffice.
  [[nodiscard]] Result<std::size_t> encode_to(ConstTextureView view, Selection selection,
                                              std::span<std::byte> out);
  /// Upper bound of the bytes of a packet of that many blocks.
  [[nodiscard]] std::size_t bound(std::size_t blocks) const noexcept;

  /// A keyframe of the mirror, for decoders that join late: after it they follow the next packets
  /// as if they had applied the last one. Does not change the encoder. out_of_order before the
  /// first packet; unsupported_backend if the backend is_stateful().
  [[nodiscard]] Result<Packet> snapshot();
  /// Makes the next packet a keyframe.
  void request_keyframe() noexcept;
  /// BackendSettings::preset from the next packet on; decoders need not know. invalid_settings;
  /// unsupported_backend if the backend, unlike native, cannot change it.
  Status set_preset(std::string_view preset);
  /// Excludes inactive blocks (e.g. probes inside walls) from Selection::changed(): one byte per
  /// block, 0 for inactive; empty: no block is excluded. In a keyframe inactive blocks are zero at
  /// the decoder. mask_mismatch.
  Status set_active(std::span<const std::uint8_t> active);
  /// Sets which records exist from now on: presence_bytes() per block, of all blocks, for a texture
  /// whose Presence is not all. Missing records are coded as zero, whatever the view holds.
  /// encode() reads only the presence of selected blocks. The packet's decoder must have the same,
  /// so encode the texture that holds the presence first; with a list of blocks, by the same list.
  /// mask_mismatch for another size; presence_invalid for records that a block does not have.
  Status set_presence(std::span<const std::byte> presence);

  /// Writes the mirror into `view`. view_too_small.
  Status read(TextureView view) const;
  [[nodiscard]] const TextureDesc& desc() const noexcept;
  [[nodiscard]] std::uint32_t sequence()
      const noexcept;  ///< of the last packet; 0 before the first
  /// True if decoded records may differ from the encoder's input.
  [[nodiscard]] bool lossy() const noexcept;

 private:
  struct GICODEC_LOCAL State;
  explicit Encoder(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

}  // namespace gicodec
