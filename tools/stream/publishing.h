// How gi-server becomes a publisher over NATS, at once or when another one is gone.
#pragma once

#include "nats_publisher.h"
#include "play_feed.h"
#include "server_flags.h"

#include <memory>

namespace gicodec::streaming {

/// Connects to NATS, and takes an epoch and the time to begin at into `o`; with --standby it waits
/// for that, and `feed` follows. Null without --nats. Throws tools::Error.
[[nodiscard]] std::unique_ptr<NatsPublisher> begin_publishing(ServerFlags& o, Feed& feed);

}  // namespace gicodec::streaming
