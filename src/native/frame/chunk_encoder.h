#pragma once

#include "native/frame/workspace.h"

#include <functional>

namespace gicodec::native {

/// How much time bytes are worth.
enum class Preset : std::uint8_t {
  turbo,   ///< token chunks
  fast,    ///< static models, chosen by estimates
  strong,  ///< exact search, and models that learn
};

struct EncodeSettings {
  Preset preset = Preset::fast;
  bool others = true;  ///< other forms are tried where they may be smaller
  /// If not 0: match chunks of at most so many bytes, or raw ones.
  std::size_t matches_within = 0;
  unsigned streams = 4;  ///< of token chunks
  int set = -1;          ///< table set to use in all places, or the encoder's choice
  unsigned lanes = 0;    ///< 0: the encoder's choice; more where enough_lanes() says so
  /// Sees every group's steps, for training and statistics; called from the encoding threads.
  std::function<void(const Step* begin, const Step* end)> observe;
};

/// Encodes the probes at `positions` of the update. `texels` are the whole update's.
void encode_chunk(const Update& u, std::span<const std::uint32_t> positions,
                  const BlockTable& texels, const EncodeSettings& settings, Workspace& w,
                  std::vector<std::byte>& out);

}  // namespace gicodec::native
