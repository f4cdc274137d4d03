// The state of a server as Prometheus reads it.
#pragma once

#include "server_statistics.h"

#include <gicodec/protocol.h>

#include <cstdint>
#include <map>
#include <string>

namespace gicodec::streaming {

struct Metrics {
  std::size_t clients = 0, connections = 0;
  std::uint64_t updates = 0;
  std::size_t memory = 0;
  std::uint64_t unheard_guesses = 0;
  std::map<Reason, std::uint64_t> dropped;  ///< connections
  ServerStatistics::Totals totals;
};

[[nodiscard]] std::string metrics_text(const Metrics& metrics);

}  // namespace gicodec::streaming
