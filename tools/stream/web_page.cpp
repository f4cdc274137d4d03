#include "web_page.h"

#include "secrets.h"

#include <fmt/core.h>

namespace gicodec::streaming {
namespace {

constexpr double kStale = 15;  ///< seconds after which a server that shows nothing is unhealthy
constexpr const char* kBearer = "Bearer ";

std::string page(const char* status, const char* type, const std::string& body) {
  return fmt::format(
      "HTTP/1.1 {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nCache-Control: no-store\r\n"
      "Connection: close\r\n\r\n{}",
      status, type, body.size(), body);
}

bool may_measure(const WebRequest& request, const std::string& token) {
  return token.empty() ? request.loopback : same_secret(request.authorization, kBearer + token);
}

}  // namespace

std::string web_answer(const WebRequest& request, const Shown& shown,
                       const std::string& metrics_token, double now) {
  if (request.get && request.path == "/health") {
    return now - shown.at <= kStale
               ? page("200 OK", "text/plain", "ok\n")
               : page("503 Service Unavailable", "text/plain", "the server does not answer\n");
  }
  if (request.get && request.path == "/metrics" && may_measure(request, metrics_token))
    return page("200 OK", "text/plain; version=0.0.4", shown.metrics);
  return page("404 Not Found", "text/plain", "not found\n");
}

}  // namespace gicodec::streaming
