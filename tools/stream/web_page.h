// Answers of the WebSockets port to plain HTTP: the server's health, and its metrics.
#pragma once

#include <string>

namespace gicodec::streaming {

struct WebRequest {
  bool get = false;  ///< its method is GET
  std::string path, authorization;
  bool loopback = false;  ///< it comes from this machine
};

/// The metrics that the server has shown last, and when.
struct Shown {
  std::string metrics;
  double at = 0;
};

/// The whole answer with its header. Metrics are for this machine or, if there is a token, for
/// requests with it; others get the answer for an unknown path.
[[nodiscard]] std::string web_answer(const WebRequest& request, const Shown& shown,
                                     const std::string& metrics_token, double now);

}  // namespace gicodec::streaming
