// Recordings that a server plays.
#pragma once

#include "kinds/feed.h"

#include <gicodec/isa.h>

#include <string>

namespace gicodec::streaming {

using kinds::Feed;
using kinds::FeedFrame;
using kinds::FeedRequest;
using kinds::FeedVolume;
using kinds::is_probes;

struct PlayOptions {
  bool loop = false;              ///< begin again after the last frame, else stay there
  double rate = 10;               ///< frames per second, if the recording has no times
  bool allow_incomplete = false;  ///< play the whole frames before a cut or damage
  Isa isa = best_isa();
  std::uint32_t memory = 2048;  ///< MiB for decoding, at least 2048: --max-memory
};

/// Plays a container, or the dumps of a folder, after checking it. Throws tools::Error of
/// Exit::bad_input if something is missing or damaged, unless that is allowed.
[[nodiscard]] Feed play_feed(const std::string& path, const PlayOptions& options);

}  // namespace gicodec::streaming
