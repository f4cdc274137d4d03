#include "metrics.h"

#include "percentiles.h"

#include <fmt/format.h>

#include <array>
#include <iterator>

namespace gicodec::streaming {
namespace {

/// By the numbers of Reason.
constexpr std::array<const char*, 16> kReasons{
    "left",     "version",      "token",          "full",        "malformed", "too_large",
    "flood",    "out_of_order", "unknown_volume", "silent",      "stalled",   "shutdown",
    "replaced", "dismissed",    "exhausted",      "unicast_full"};
static_assert(static_cast<std::size_t>(Reason::unicast_full) + 1 == kReasons.size());

void head(std::string& text, const char* name, const char* type, const char* help) {
  fmt::format_to(std::back_inserter(text), "# HELP {0} {2}\n# TYPE {0} {1}\n", name, type, help);
}

template <typename Value>
void add(std::string& text, const char* name, const char* type, const char* help, Value value) {
  head(text, name, type, help);
  fmt::format_to(std::back_inserter(text), "{} {}\n", name, value);
}

}  // namespace

std::string metrics_text(const Metrics& m) {
  std::string text;
  const auto& t = m.totals;
  add(text, "gicodec_clients", "gauge", "Sessions with a connection.", m.clients);
  add(text, "gicodec_connections", "gauge", "Connections, those without a session included.",
      m.connections);
  add(text, "gicodec_updates_total", "counter", "Updates made.", m.updates);
  add(text, "gicodec_late_updates_total", "counter", "Updates that came later than the rate asks.",
      t.late);
  add(text, "gicodec_sent_bytes_total", "counter", "Bytes of packets made for clients.", t.bytes);
  add(text, "gicodec_sent_blocks_total", "counter", "Blocks in packets made for clients.",
      t.blocks);
  add(text, "gicodec_memory_bytes", "gauge", "What the library holds for streams and sessions.",
      m.memory);
  add(text, "gicodec_unheard_guesses_total", "counter",
      "Tokens not looked at because of earlier wrong ones from their address.", m.unheard_guesses);
  head(text, "gicodec_dropped_total", "counter", "Connections ended, by reason.");
  for (std::size_t i = 0; i < kReasons.size(); ++i) {
    const auto it = m.dropped.find(static_cast<Reason>(i));
    fmt::format_to(std::back_inserter(text), "gicodec_dropped_total{{reason=\"{}\"}} {}\n",
                   kReasons[i], it == m.dropped.end() ? 0 : it->second);
  }
  head(text, "gicodec_latency_seconds", "summary",
       "From making an update to its acknowledgement; quantiles of the last ones.");
  const auto [p50, p95, p99] = percentiles(t.latencies);
  fmt::format_to(std::back_inserter(text),
                 "gicodec_latency_seconds{{quantile=\"0.5\"}} {}\n"
                 "gicodec_latency_seconds{{quantile=\"0.95\"}} {}\n"
                 "gicodec_latency_seconds{{quantile=\"0.99\"}} {}\n"
                 "gicodec_latency_seconds_sum {}\ngicodec_latency_seconds_count {}\n",
                 p50, p95, p99, t.latency.sum, t.latency.count);
  head(text, "gicodec_encode_seconds", "summary", "Encoding of an update for all clients.");
  fmt::format_to(std::back_inserter(text),
                 "gicodec_encode_seconds_sum {}\ngicodec_encode_seconds_count {}\n", t.encode.sum,
                 t.encode.count);
  if (!t.published) return text;
  const TrackStatistics& p = *t.published;
  head(text, "gicodec_published_bytes_total", "counter", "Bytes of messages to NATS, by type.");
  fmt::format_to(std::back_inserter(text),
                 "gicodec_published_bytes_total{{type=\"update\"}} {}\n"
                 "gicodec_published_bytes_total{{type=\"snapshot\"}} {}\n"
                 "gicodec_published_bytes_total{{type=\"other\"}} {}\n",
                 p.update_bytes, p.snapshot_bytes, p.other_bytes);
  add(text, "gicodec_unstored_messages", "gauge",
      "Messages that JetStream has not said to keep yet.", t.unanswered);
  return text;
}

}  // namespace gicodec::streaming
