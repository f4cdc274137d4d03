#include "client_summary.h"

#include "dump/data_text.h"
#include "dump/text.h"
#include "log.h"
#include "percentiles.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace gicodec::streaming {
namespace {

using nlohmann::ordered_json;

double mbps(std::uint64_t bytes, double seconds) {
  return seconds > 0 ? static_cast<double>(bytes) * 8e-6 / seconds : 0;
}

double rounded(double value) { return std::round(value * 1000) / 1000; }

ordered_json percentile_json(const std::vector<float>& seconds) {
  const auto [p50, p95, p99] = percentiles(seconds);
  return {{"p50", rounded(p50 * 1e3)}, {"p95", rounded(p95 * 1e3)}, {"p99", rounded(p99 * 1e3)}};
}

void print_recorded(const Recorded& recorded) {
  if (recorded.files.empty() && recorded.left.empty()) return;
  std::vector<std::string> names = recorded.files;
  names.insert(names.end(), recorded.left.begin(), recorded.left.end());
  tools::print(", {:.2f} MB recorded in {}", static_cast<double>(recorded.bytes) * 1e-6,
               tools::printable(fmt::format("{}", fmt::join(names, ", "))));
}

}  // namespace

void summarise(const SimulateResult& r, std::uint32_t clients, bool json) {
  const double each =
      r.seconds > 0 ? static_cast<double>(r.updates) / r.seconds / std::max(1U, r.connected) : 0;
  const double decode = std::accumulate(r.decode_seconds.begin(), r.decode_seconds.end(), 0.0) /
                        std::max<double>(1, static_cast<double>(r.decode_seconds.size()));
  if (json) {
    const ordered_json summary{{"clients", clients},
                               {"connected", r.connected},
                               {"seconds", rounded(r.seconds)},
                               {"updates", r.updates},
                               {"fewest_updates", r.fewest_updates},
                               {"updates_per_s", rounded(each)},
                               {"mbps", rounded(mbps(r.bytes, r.seconds))},
                               {"blocks", r.blocks},
                               {"decode_ms", rounded(decode * 1e3)},
                               {"decode_percentiles_ms", percentile_json(r.decode_seconds)},
                               {"interval_ms", percentile_json(r.intervals)},
                               {"round_trip_ms", percentile_json(r.round_trips)},
                               {"lost_connections", r.lost},
                               {"gaps", r.gaps},
                               {"proofs", r.proofs},
                               {"failed_proofs", r.failed_proofs}};
    tools::write_json(stdout, summary);
  } else {
    const auto [p50, p95, p99] = percentiles(r.intervals);
    tools::print(
        "{} of {} in {:.1f} s: {:.1f} updates/s for each that was served, {:.2f} Mbps in "
        "all, decode {:.2f} "
        "ms, between updates {:.0f} ms (95 %: {:.0f}, 99 %: {:.0f}), {} lost, {}, {}, {} failed\n",
        r.connected, count(clients, "client"), r.seconds, each, mbps(r.bytes, r.seconds),
        decode * 1e3, p50 * 1e3, p95 * 1e3, p99 * 1e3, count(r.lost, "connection"),
        count(r.gaps, "gap"), count(r.proofs, "proof"), r.failed_proofs);
  }
}

void summarise(const ViewerResult& r, const Recorded& recorded, bool json) {
  const double render = r.frames > 0 ? r.render_seconds / static_cast<double>(r.frames) * 1e3 : 0;
  if (json) {
    const ordered_json summary{{"updates", r.updates},
                               {"seconds", rounded(r.seconds)},
                               {"all_seconds", rounded(r.all_seconds)},
                               {"connect_ms", rounded(r.connect_seconds * 1e3)},
                               {"first_ms", rounded(r.first_seconds * 1e3)},
                               {"longest_pause_ms", rounded(r.longest_pause * 1e3)},
                               {"mbps", rounded(mbps(r.statistics.bytes, r.seconds))},
                               {"bytes", r.statistics.bytes},
                               {"packets", r.statistics.packets},
                               {"blocks", r.statistics.blocks},
                               {"held_blocks", r.held},
                               {"all_blocks", r.blocks},
                               {"frames", r.frames},
                               {"render_ms", rounded(render)},
                               {"connections", r.connections},
                               {"resumed", r.connections > 1 && r.resumed},
                               {"round_trip_ms", r.round_trip_ms},
                               {"gaps", r.statistics.gaps},
                               {"proofs", r.statistics.proofs},
                               {"failed_proofs", r.statistics.failed_proofs},
                               {"lossy", r.lossy},
                               {"recorded", recorded.files},
                               {"recorded_without_name", recorded.left}};
    tools::write_json(stdout, summary);
    return;
  }
  tools::print("{} in {:.1f} s, {:.2f} Mbps, {}", count(r.updates, "update"), r.seconds,
               mbps(r.statistics.bytes, r.seconds), count(r.statistics.blocks, "block"));
  if (r.blocks > 0) tools::print(" ({} of {} held)", r.held, r.blocks);
  if (r.frames > 0) tools::print(", {} of {:.0f} ms", count(r.frames, "picture"), render);
  if (r.connections > 1) {
    tools::print(", {} connections{}", r.connections, r.resumed ? ", resumed" : ", begun anew");
  }
  if (r.statistics.gaps > 0) tools::print(", {}", count(r.statistics.gaps, "gap"));
  if (r.statistics.proofs > 0) {
    tools::print(", {}, {} failed", count(r.statistics.proofs, "proof"),
                 r.statistics.failed_proofs);
  }
  print_recorded(recorded);
  tools::print("; {:.1f} s in all, {:.2f} s to the first update, longest pause {:.2f} s\n",
               r.all_seconds, r.first_seconds, r.longest_pause);
  for (const std::string& texture : r.lossy) tools::print("LOSSY: {}\n", texture);
}

}  // namespace gicodec::streaming
