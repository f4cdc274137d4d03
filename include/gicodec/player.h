// Plays a container: frame after frame, or any of them, into textures of the caller's.
#pragma once

#include <gicodec/api.h>
#include <gicodec/backend.h>
#include <gicodec/container.h>
#include <gicodec/io.h>
#include <gicodec/isa.h>
#include <gicodec/kind.h>
#include <gicodec/packet.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace GICODEC_API gicodec {

struct PlayerOptions {
  /// max_total_bytes: of all that is decoded, at its worst, and the packets of a frame; taken with
  /// a texture's, or a region's, first packet, since descriptions cost nothing.
  DecodeLimits limits = {};
  std::vector<const Backend*> backends = {};  ///< besides the built-in ones; must outlive it
  std::vector<const Kind*> kinds = {};        ///< likewise
  Threads threads = {};                       ///< per packet
  Isa isa = best_isa();                       ///< kernels; the machine must have it
};

/// One thread at a time; const members may be called by several. Safe on hostile bytes. Of a volume
/// whose kind is unknown, packets are checked only.
class ContainerPlayer {
 public:
  /// `source` must outlive the player. Errors: those of ContainerReader::open();
  /// invalid_settings.
  [[nodiscard]] static Result<ContainerPlayer> open(Source& source,
                                                    const PlayerOptions& options = {});
  ContainerPlayer(ContainerPlayer&&) noexcept;
  ContainerPlayer& operator=(ContainerPlayer&&) noexcept;
  ~ContainerPlayer();

  [[nodiscard]] const ContainerDescription& description() const noexcept;
  /// Plays nothing but these textures, and of what they need what says which records exist; of
  /// others nothing is read where the container can seek, unless their regions are very many. None:
  /// all of them. unknown_texture; out_of_order after next(), skip() or seek().
  Status select(std::span<const std::uint8_t> textures);
  /// Views of this texture lie so, rather than as description() has it. Before its first packet,
  /// else out_of_order; unknown_texture; those of validate().
  Status set_layout(std::uint8_t texture, const Layout& layout);

  /// Applies the next frame, whose number is frame() then. Status::end after the last one,
  /// Status::truncated where the file was cut off, or goes on to grow, after which the frame before
  /// stays. After any other error, see where(), this frame is not whole, and the next call goes on
  /// behind the packet that failed: its texture needs a keyframe. Where memory is short,
  /// out_of_memory, it goes on with that packet. Damage is told after the packets
  /// before it; what comes behind is not found again but by seek().
  [[nodiscard]] Status next();
  /// The same, but the frame's packets are neither checked nor decoded: their textures need
  /// keyframes before next() can go on with them.
  [[nodiscard]] Status skip();
  /// From here on next() begins with that frame. unknown_frame if the container does not
  /// have it, or is not seekable().
  Status seek(std::uint64_t frame);
  [[nodiscard]] bool seekable() const noexcept;
  /// True once the end of the container was seen.
  [[nodiscard]] bool finished() const noexcept;
  [[nodiscard]] std::uint64_t frame() const noexcept;

  /// Writes a texture as it is after the last frame, guard bands included, zeros where nothing was
  /// received. unknown_texture, also for one whose kind is unknown; view_too_small.
  Status read(std::uint8_t texture, TextureView view) const;
  /// The same, but only the blocks that the frame brought, or all after seek(): what keeps `view`
  /// equal to the texture if it was.
  Status read_changed(std::uint8_t texture, TextureView view) const;
  /// These blocks, ascending; none of a texture of which nothing came yet. Valid until the next
  /// call of next() or seek().
  [[nodiscard]] std::span<const std::uint32_t> changed(std::uint8_t texture) const noexcept;

  /// Those of the frame, a region of a texture at most once, what says which records exist before
  /// the textures that need it. Valid until the next call of next(), skip() or seek().
  [[nodiscard]] std::span<const ContainerPacket> packets() const noexcept;

  /// Of the packet that was applied last, or that failed.
  struct Where {
    std::uint64_t frame = 0;
    std::optional<TextureRegion> part;  ///< none: no packet failed, but the container behind it
    std::uint64_t memory = 0;           ///< after limit_exceeded: max_total_bytes that it takes
  };
  [[nodiscard]] Where where() const noexcept;
  /// Bytes that are held, at their worst, for what has been played so far.
  [[nodiscard]] std::uint64_t memory() const noexcept;

 private:
  struct GICODEC_LOCAL State;
  explicit ContainerPlayer(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

}  // namespace gicodec
