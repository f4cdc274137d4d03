// What a ContainerPlayer holds.
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

  /// Of what has packets of its own: a texture and 0, or a region of one and 1 + its number.
  using PartId = std::pair<std::uint8_t, std::uint32_t>;

  Status go_on(bool decoding);
  /// The next packet that is played, whichever frame it is of.
  Status look_ahead();
  /// Its frame's packets, in the order in which they are applied.
  Status gather();
  Status apply(const ContainerPacket& packet);
  [[nodiscard]] Result<Decoder*> part(PartId id);
  /// Whether so many bytes more than what decoders hold are allowed.
  [[nodiscard]] Status check_memory(std::uint64_t more, std::uint64_t shared) noexcept;
  /// Precondition: there is room for all blocks of the part.
  void note_changed(const Decoder& decoder, PartId id, bool keyframe) noexcept;
  void settle_changed(bool all);
  [[nodiscard]] bool is_played(std::uint8_t texture) const noexcept {
    return texture < entries().size() && is_known(entries()[texture]);
  }
  [[nodiscard]] const std::vector<TextureEntry>& entries() const noexcept {
    return reader.description().textures;
  }
  /// As views have it.
  [[nodiscard]] TextureDesc desc_of(std::uint8_t texture) const noexcept {
    TextureDesc desc = entries()[texture].desc;
    desc.layout = layouts[texture];
    return desc;
  }
  [[nodiscard]] RegionGrid regions(std::uint8_t texture) const noexcept {
    return regions_of(entries()[texture].desc, region_size(texture));
  }
  /// Zeros: the texture is one region, whose number is none.
  [[nodiscard]] const Grid& region_size(std::uint8_t texture) const noexcept {
    return reader.description().volumes[entries()[texture].volume].region;
  }
  /// Writes some blocks of a part, as the part counts them, or all.
  [[nodiscard]] Status read_part(PartId id, TextureView view,
                                 const std::vector<std::uint32_t>* blocks) const;

  PlayerOptions options;
  ContainerReader reader;
  std::shared_ptr<DecoderScratch> scratch;
  std::vector<Layout> layouts;  ///< by texture
  std::vector<bool> selected;   ///< by texture
  std::map<PartId, Decoder> parts;
  std::uint64_t held = 0, scratched = 0;  ///< bytes of decoders, and of what they share
  std::optional<ContainerPacket> ahead;
  Status failed = Status::ok;            ///< of the reader, to be told in its turn
  std::vector<ContainerPacket> packets;  ///< of the frame, and room for more
  std::size_t count = 0, at = 0;         ///< packets of the frame, and how many were applied
  std::uint64_t packed = 0;              ///< bytes of the frame's packets
  bool gathering = false;                ///< while there may be more of them
  bool started = false;                  ///< a frame was asked for
  bool begun = false;                    ///< a frame that is not through
  std::vector<std::vector<std::uint32_t>> changed;  ///< by texture
  bool all_changed = false;
  std::uint64_t frame = 0;
  std::optional<std::uint64_t> sought;  ///< what comes before it is applied, and shown with it
  Where where;
};

}  // namespace gicodec
