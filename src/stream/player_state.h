// The state of a ContainerPlayer.
#pragma once

#include <gicodec/decoder.h>
#include <gicodec/player.h>
#include <gicodec/volume.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace gicodec {

struct ContainerPlayer::State {
  State(PlayerOptions o, ContainerReader r, std::shared_ptr<DecoderScratch> s) noexcept
      : options(std::move(o)), reader(std::move(r)), scratch(std::move(s)) {}

  /// A texture and its region, as in TextureRegion.
  using PartId = std::pair<std::uint8_t, std::uint32_t>;

  Status go_on(bool decoding);
  /// Reads the next selected packet, of any frame, into `ahead`.
  Status look_ahead();
  /// Collects the packets of the frame of `ahead`, in the order of application.
  Status gather();
  Status apply(const ContainerPacket& packet);
  [[nodiscard]] Result<Decoder*> part(PartId id);
  /// limit_exceeded if `more` bytes than decoders hold now are too many.
  [[nodiscard]] Status check_memory(std::uint64_t more, std::uint64_t shared) noexcept;
  /// Precondition: `changed` has capacity for all blocks of the part.
  void note_changed(const Decoder& decoder, PartId id, bool keyframe) noexcept;
  void settle_changed(bool all);
  [[nodiscard]] bool is_played(std::uint8_t texture) const noexcept {
    return texture < entries().size() && is_known(entries()[texture]);
  }
  [[nodiscard]] const std::vector<TextureEntry>& entries() const noexcept {
    return reader.description().textures;
  }
  /// With the layout of the caller's views.
  [[nodiscard]] TextureDesc desc_of(std::uint8_t texture) const noexcept {
    TextureDesc desc = entries()[texture].desc;
    desc.layout = layouts[texture];
    return desc;
  }
  [[nodiscard]] RegionGrid regions(std::uint8_t texture) const noexcept {
    return regions_of(entries()[texture].desc, region_size(texture));
  }
  /// Zeros: the texture is not cut into regions.
  [[nodiscard]] const Grid& region_size(std::uint8_t texture) const noexcept {
    return reader.description().volumes[entries()[texture].volume].region;
  }
  /// Writes blocks of a part, by their number in it, or all if `blocks` is null.
  [[nodiscard]] Status read_part(PartId id, TextureView view,
                                 const std::vector<std::uint32_t>* blocks) const;

  PlayerOptions options;
  ContainerReader reader;
  std::shared_ptr<DecoderScratch> scratch;
  std::vector<Layout> layouts;  ///< by texture
  std::vector<bool> selected;   ///< by texture
  std::map<PartId, Decoder> parts;
  std::uint64_t held = 0, scratched = 0;  ///< bytes of decoders, and of their scratch
  std::optional<ContainerPacket> ahead;
  Status failed = Status::ok;  ///< the reader's error, reported after the packets before it
  std::vector<ContainerPacket> packets;             ///< of the frame; the capacity is kept
  std::size_t count = 0, at = 0;                    ///< packets of the frame, and of those applied
  std::uint64_t packed = 0;                         ///< bytes of the frame's packets
  bool gathering = false;                           ///< `packets` is not complete
  bool started = false;                             ///< next(), skip() or seek() was called
  bool begun = false;                               ///< a frame is not finished
  std::vector<std::vector<std::uint32_t>> changed;  ///< by texture
  bool all_changed = false;
  std::uint64_t frame = 0;
  std::optional<std::uint64_t> sought;  ///< frame of seek(), until next() reaches it
  Where where;
};

}  // namespace gicodec
