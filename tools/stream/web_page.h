// What the port of WebSockets answers to plain HTTP: whether the server is well, and its metrics.
#pragma once

#include <string>

namespace gicodec::streaming {

struct WebRequest {
  bool get = false;  ///< its method is GET
  std::string path, authorization;
  bool loopback = false;  ///< it comes from this machine
};

/// What the server has shown last, and when.
struct Shown {
  std::string metrics;
  double at = 0;
};

/// The whole answer, its head included. Metrics are for this machine or, if there is a token, for
/// those who know it; who may not have them is not told that they are there.
[[nodiscard]] std::string web_answer(const WebRequest& request, const Shown& shown,
                                     const std::string& metrics_token, double now);

}  // namespace gicodec::streaming
