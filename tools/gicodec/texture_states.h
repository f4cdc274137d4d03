// What the textures of a container hold after some of its packets.
#pragma once

#include "container_input.h"

#include <atomic>
#include <map>
#include <memory>
#include <span>
#include <vector>

namespace gicodec::tools {

/// A packet's texture is decoded where its kind is known. The memory of a texture, or of a region,
/// is taken with its first packet, and counts for all of them together: a description costs
/// nothing.
class TextureStates {
 public:
  explicit TextureStates(const ContainerInput& input, const DecoderFlags& flags = {});

  /// Applies a packet; one of an unknown kind is checked only. Different textures may be used by
  /// different threads, unless one says which records of the other exist.
  void apply(const ContainerPacket& packet);
  /// The packets of a frame in lists that different threads may apply, in order each.
  [[nodiscard]] std::vector<std::vector<const ContainerPacket*>> independent(
      const std::vector<ContainerPacket>& packets) const;
  /// A texture as StoredTexture::info says, zeros before the first packet; empty if no dump can be
  /// made of it.
  [[nodiscard]] std::span<const std::byte> texels(std::size_t texture);

 private:
  struct State {
    std::shared_ptr<DecoderScratch> scratch;    ///< of its decoders
    std::map<std::uint32_t, Decoder> decoders;  ///< by region
    std::vector<std::byte> texels;
    std::vector<std::byte> region;      ///< room for the largest region's texels
    std::vector<std::uint32_t> blocks;  ///< that a packet of a region may have changed
  };
  Decoder& open(std::size_t texture, std::uint32_t region);
  void take_memory(std::size_t texture, std::uint64_t bytes);
  /// Brings State::blocks of a region to State::texels.
  void copy_region(State& state, std::size_t texture, std::uint32_t region);
  /// The texture whose blocks say which records of this one exist.
  [[nodiscard]] std::optional<std::size_t> presence_of(std::size_t texture) const;

  const ContainerInput& input_;
  DecoderFlags flags_;
  std::vector<State> states_;
  std::atomic<std::uint64_t> memory_ = 0;  ///< of what is open
};

}  // namespace gicodec::tools
