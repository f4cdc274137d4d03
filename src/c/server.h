// A streaming server as C sees it.
#pragma once

#include "c/calls.h"

#include <gicodec/server.h>

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

namespace gicodec::c {

/// The messages that a connection has not taken, and the last one that it took, in one piece.
struct Outbox {
  std::vector<OutgoingMessage> messages;
  std::size_t taken = 0;
  Message last;
};

}  // namespace gicodec::c

struct gicodec_server : gicodec::c::Handle {
  std::optional<gicodec::Server> server;
  bool has_epoch = false;  ///< the caller chose it
  std::map<gicodec::ConnectionId, gicodec::c::Outbox> outboxes;
  std::vector<gicodec::ServerEvent> events;
  std::size_t told = 0;  ///< of these
};
