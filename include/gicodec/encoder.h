// Encoder session: texture in, packets out.
#pragma once

#include <gicodec/backend.h>
#include <gicodec/packet.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gicodec {

struct EncoderOptions {
  std::string_view backend = "native";  ///< by name, built in or from `backends`
  BackendSettings settings = {};        ///< level, preset, difference, threads, isa
  std::uint32_t gop = 30;               ///< a keyframe every `gop` packets; 0: only on request
  std::uint8_t texture_id = 0;          ///< written into every packet
  std::vector<const Backend*> backends = {};  ///< further ones, needed during create() only
};

/// Which probes go into a packet. Refers to the caller's list, does not copy it.
class Selection {
 public:
  /// Every probe whose block differs from the mirror; in a keyframe, every block that is not all
  /// zero (an inactive probe costs nothing).
  [[nodiscard]] static constexpr Selection changed() noexcept { return {Kind::changed, {}}; }
  /// Every probe, whether it changed or not.
  [[nodiscard]] static constexpr Selection all() noexcept { return {Kind::all, {}}; }
  /// These probes, in any order, each at most once; an empty list gives an empty update.
  constexpr Selection(std::span<const std::uint32_t> probes) noexcept  // NOLINT
      : Selection(Kind::list, probes) {}
  constexpr Selection(const std::vector<std::uint32_t>& probes) noexcept  // NOLINT
      : Selection(Kind::list, probes) {}

  enum class Kind : std::uint8_t { changed, all, list };
  [[nodiscard]] constexpr Kind kind() const noexcept { return kind_; }
  [[nodiscard]] constexpr std::span<const std::uint32_t> list() const noexcept { return probes_; }

 private:
  constexpr Selection(Kind kind, std::span<const std::uint32_t> probes) noexcept
      : probes_(probes), kind_(kind) {}
  std::span<const std::uint32_t> probes_;
  Kind kind_;
};

/// Turns successive contents of one texture into packets (Stengel et al. §3.3, §3.4). Holds the
/// mirror, i.e. what a decoder knows after the last packet. The first packet is a keyframe. One
/// thread at a time per encoder; different encoders are independent. Movable; a moved-from encoder
/// may only be destroyed or assigned to.
class Encoder {
 public:
  [[nodiscard]] static Result<Encoder> create(const TextureDesc& desc,
                                              const EncoderOptions& options = {});
  Encoder(Encoder&&) noexcept;
  Encoder& operator=(Encoder&&) noexcept;
  ~Encoder();

  /// Codes the selected probes of `view`. Unselected probes keep their mirror value, or become zero
  /// at the decoder in a keyframe. An error leaves mirror and sequence as they were.
  /// Errors: view_too_small, probe_out_of_range, probe_repeated, backend_failed, out_of_memory.
  [[nodiscard]] Result<Packet> encode(ConstTextureView view,
                                      Selection selection = Selection::changed());
  /// The same, replacing the contents of `out` and keeping its capacity.
  Status encode_to(ConstTextureView view, Selection selection, Packet& out);
  /// The same into the caller's memory; returns the packet's size. buffer_too_small if `out` is
  /// smaller than the packet; bound() bytes always suffice.
  [[nodiscard]] Result<std::size_t> encode_to(ConstTextureView view, Selection selection,
                                              std::span<std::byte> out);
  /// Upper bound of the size of a packet of that many probes.
  [[nodiscard]] std::size_t bound(std::size_t probes) const noexcept;

  /// A keyframe of the mirror as it stands, for decoders that join late: after it they follow the
  /// packets that come next, as if they had applied the last one. Changes nothing here.
  /// invalid_argument before the first packet; unsupported_backend with one that remembers().
  [[nodiscard]] Result<Packet> snapshot();
  /// Makes the next packet a keyframe.
  void request_keyframe() noexcept;
  /// Probes that are never selected by Selection::changed() (e.g. inside walls): one byte per
  /// probe, 0 for inactive; empty for none. In a keyframe they are zero at the decoder.
  Status set_active(std::span<const std::uint8_t> active);

  /// Writes the mirror into `view`: the texels a decoder holds after the last packet.
  Status read(TextureView view) const;
  [[nodiscard]] const TextureDesc& desc() const noexcept;
  [[nodiscard]] std::uint32_t sequence() const noexcept;  ///< of the last packet; 0 before it
  [[nodiscard]] bool lossy() const noexcept;

 private:
  struct State;
  explicit Encoder(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

}  // namespace gicodec
