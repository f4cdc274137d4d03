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

  Status select(std::vector<TextureRegion> parts);
  /// next() and skip().
  Status advance(bool decoding);
  /// Reads the next selected packet, of any frame, into `next_packet`, unless it is there.
  Status read_ahead();
  /// The same, but for a packet that the index lists for a later frame.
  Status read_ahead_within(std::uint64_t frame);
  /// Collects the packets of the frame of `next_packet`, in the order of application.
  Status gather();
  Status apply(const ContainerPacket& packet);
  [[nodiscard]] bool is_played(std::uint8_t texture) const noexcept {
    return texture < entries().size() && is_known(entries()[texture]);
  }
  /// True if the call that ends so goes on with the same frame when it is repeated.
  [[nodiscard]] bool is_repeated(Status status) const noexcept {
    return status == Status::out_of_memory || (growing && status == Status::truncated);
  }
  [[nodiscard]] const std::vector<TextureEntry>& entries() const noexcept {
    return reader.description().textures;
  }

  ContainerReader reader;
  TextureDecoders decoders;
  std::vector<bool> selected;                  ///< by texture
  std::optional<ContainerPacket> next_packet;  ///< read, and not yet in `packets`
  Status postponed = Status::ok;  ///< the reader's error behind `packets`, for a later call

  // Of the packets that are applied together: those of one frame.
  std::vector<ContainerPacket> packets;  ///< the first `packet_count`; the others are spare
  std::size_t packet_count = 0, applied = 0;
  std::uint64_t packet_bytes = 0;
  bool gathering = false;  ///< gather() did not end: the frame may have further packets
  bool growing = false;

  std::uint64_t frame = 0;  ///< of the last next() or skip()
  bool in_frame = false;    ///< that call failed within the frame; the next call continues it
  bool started = false;     ///< next(), skip() or seek() was called
  std::optional<std::uint64_t> sought;  ///< frame of seek(), until next() reaches it
  bool all_changed = false;             ///< the last frame is the first after seek()
  Where where;
};

}  // namespace gicodec
