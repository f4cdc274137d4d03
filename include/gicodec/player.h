// Plays a container, in order or from any frame on, into the caller's textures.
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
  /// max_total_bytes covers the peak of all decoders and the packets of a frame. A decoder counts
  /// from the first packet of its texture, or region, on.
  DecodeLimits limits = {};
  std::vector<const Backend*> backends = {};  ///< besides the built-in ones; outlive the player
  std::vector<const Kind*> kinds = {};        ///< besides the built-in ones; outlive the player
  Threads threads = {};                       ///< per packet
  Isa isa = best_isa();                       ///< kernels; the machine must have it
};

/// One thread at a time; several threads may call const members at once. Safe on hostile bytes.
/// Packets of a volume of an unknown kind are checked but not decoded.
class ContainerPlayer {
 public:
  /// `source` must outlive the player. Errors: those of ContainerReader::open(), and
  /// invalid_settings.
  [[nodiscard]] static Result<ContainerPlayer> open(Source& source,
                                                    const PlayerOptions& options = {});
  ContainerPlayer(ContainerPlayer&&) noexcept;
  ContainerPlayer& operator=(ContainerPlayer&&) noexcept;
  ~ContainerPlayer();

  [[nodiscard]] const ContainerDescription& description() const noexcept;
  /// Plays only these textures, and their presence textures; empty: all. If the container can seek,
  /// the player does not read packets of other textures, unless the selected regions are very many.
  /// unknown_texture; out_of_order after next(), skip() or seek().
  Status select(std::span<const std::uint8_t> textures);
  /// The same of single regions of textures that are cut: the blocks of others stay zero. Errors as
  /// above; unknown_region.
  Status select(std::span<const TextureRegion> parts);
  /// Sets the layout of this texture's views, instead of that of description(). unknown_texture;
  /// out_of_order after the texture's first packet; errors of validate().
  Status set_layout(std::uint8_t texture, const Layout& layout);

  /// Applies the next frame and sets frame().
  /// - Status::end after the last frame.
  /// - Status::truncated if the file was cut off or is growing: the textures stay at the last
  ///   frame.
  /// - out_of_memory: the next call repeats the packet.
  /// - Any other error, see where(): the frame is incomplete. The next call goes on after the
  ///   failed packet, whose texture needs a keyframe. If the container itself is damaged, the error
  ///   comes after all packets before the damage; only seek() reaches those behind it.
  [[nodiscard]] Status next();
  /// While the source grows, a frame may lack packets that have not arrived. If so, next() then
  /// returns truncated, and goes on with that frame when it is called again.
  void set_growing(bool growing) noexcept;
  /// Passes over the next frame: its packets are neither checked nor decoded. Their textures then
  /// need keyframes before next() can decode them.
  [[nodiscard]] Status skip();
  /// The next call of next() applies that frame. unknown_frame if the container does not have it,
  /// or is not seekable().
  Status seek(std::uint64_t frame);
  [[nodiscard]] bool seekable() const noexcept;
  /// As ContainerReader::frames().
  [[nodiscard]] Result<std::vector<std::uint64_t>> frames();
  /// As ContainerReader::listed().
  [[nodiscard]] Result<std::vector<ListedPart>> listed();
  /// As ContainerReader::metadata().
  [[nodiscard]] Result<Metadata> metadata(std::uint8_t texture);
  /// True once the player has found the container's end mark.
  [[nodiscard]] bool finished() const noexcept;
  /// Number of the last frame that next() or skip() began.
  [[nodiscard]] std::uint64_t frame() const noexcept;

  /// Writes a texture as of the last frame, guard bands included; blocks that were not received are
  /// zero. unknown_texture, also for one of an unknown kind; view_too_small.
  Status read(std::uint8_t texture, TextureView view) const;
  /// The same, for the changed() blocks only. A view that equals the texture before each frame
  /// equals it afterwards.
  Status read_changed(std::uint8_t texture, TextureView view) const;
  /// Blocks that the last frame may have changed, ascending; all after seek(). Empty for a texture
  /// without packets so far. Valid until the next call of next() or seek().
  [[nodiscard]] std::span<const std::uint32_t> changed(std::uint8_t texture) const noexcept;

  /// The packets of the last frame, at most one per region of a texture; presence textures come
  /// before the textures that need them. Valid until the next call of next(), skip() or seek().
  [[nodiscard]] std::span<const ContainerPacket> packets() const noexcept;

  /// Where playing stands: the last packet that was applied, or the one that failed.
  struct Where {
    std::uint64_t frame = 0;
    std::optional<TextureRegion> part;  ///< none: the container failed behind this frame
    std::uint64_t memory = 0;           ///< after limit_exceeded: the max_total_bytes needed
  };
  [[nodiscard]] Where where() const noexcept;
  /// Peak bytes of all decoders so far.
  [[nodiscard]] std::uint64_t memory() const noexcept;

 private:
  struct GICODEC_LOCAL State;
  explicit ContainerPlayer(std::unique_ptr<State> state) noexcept;
  std::unique_ptr<State> state_;
};

}  // namespace gicodec
