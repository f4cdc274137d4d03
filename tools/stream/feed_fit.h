// Checks a server's flags against its feed.
#pragma once

#include "play_feed.h"
#include "server_flags.h"

namespace gicodec::streaming {

/// Throws tools::Error with a remedy if the backend refuses its flags, or a texture.
void check_backend(const ServerFlags& flags, const FeedVolume& volume);

}  // namespace gicodec::streaming
