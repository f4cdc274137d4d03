// The state of a ContainerPlayer.
#pragma once

#include <gicodec/player.h>

#include "stream/texture_decoders.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace gicodec {

struct ContainerPlayer::State {
  State(ContainerReader r, TextureDecoders d) noexcept
      : reader(std::move(r)), decoders(std::move(d)) {}

  Status go_on(bool decoding);
  /// Reads the next selected packet, of any frame, into `ahead`.
  Status look_ahead();
  /// Collects the packets of the frame of `ahead`, in the order of application.
  Status gather();
  Status apply(const ContainerPacket& packet);
  [[nodiscard]] bool is_played(std::uint8_t texture) const noexcept {
    return texture < entries().size() && is_known(entries()[texture]);
  }
  [[nodiscard]] const std::vector<TextureEntry>& entries() const noexcept {
    return reader.description().textures;
  }

  ContainerReader reader;
  TextureDecoders decoders;
  std::vector<bool> selected;  ///< by texture
  std::optional<ContainerPacket> ahead;
  Status failed = Status::ok;            ///< the reader's error, for a later call
  std::vector<ContainerPacket> packets;  ///< those of the frame first; the others are spare
  std::size_t count = 0, at = 0;         ///< packets of the frame, and how many were applied
  std::uint64_t packed = 0;              ///< bytes of the frame's packets
  bool gathering = false;                ///< the frame may have further packets
  bool started = false;                  ///< next(), skip() or seek() was called
  bool begun = false;                    ///< a frame is begun and not complete
  bool all_changed = false;
  std::uint64_t frame = 0;
  std::optional<std::uint64_t> sought;  ///< frame of seek(), until next() reaches it
  Where where;
};

}  // namespace gicodec
