// Many clients in one process, for load tests.
#pragma once

#include "client_camera.h"
#include "net.h"

#include <gicodec/client.h>

#include <cstdint>
#include <optional>

namespace gicodec::streaming {

struct SimulateOptions {
  Address server;
  NetOptions net;
  ClientOptions client;
  std::uint32_t clients = 1;
  std::uint64_t updates = 0;          ///< after which each leaves; 0: no limit
  double seconds = 0;                 ///< after which all leave; 0: no limit
  double patience = 15;               ///< seconds without any connection after which it gives up
  std::optional<SceneId> scene = {};  ///< that the server must stream
};

struct SimulateResult {
  std::uint32_t connected = 0;  ///< clients that got a Welcome
  std::uint32_t served = 0;     ///< clients that got an update
  std::uint64_t updates = 0, fewest_updates = 0, bytes = 0, blocks = 0;
  std::uint64_t gaps = 0, proofs = 0, failed_proofs = 0, lost = 0;
  bool unanswered = false;            ///< the server was there and left without a Goodbye
  double seconds = 0;                 ///< from the first update to the last
  std::vector<float> decode_seconds;  ///< of each update
  std::vector<float> intervals;       ///< seconds between two updates of a client
  std::vector<float> round_trips;     ///< seconds, as the transport sees them
  Reason reason = Reason::left;       ///< why the server dropped one of them, if it did
  std::string unusable = {};          ///< the fault in the server's messages, if any
};

/// Spreads the clients' cameras along `path`; if it is not known, clients subscribe to everything.
/// Returns once all clients are done or dropped, or after an interrupt. Throws tools::Error.
[[nodiscard]] SimulateResult simulate(const SimulateOptions& options, const CameraPath& path);

}  // namespace gicodec::streaming
