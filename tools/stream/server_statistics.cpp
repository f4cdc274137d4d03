#include "server_statistics.h"

#include "clock.h"
#include "dump/data_text.h"
#include "dump/error.h"
#include "dump/file.h"
#include "dump/text.h"
#include "log.h"
#include "percentiles.h"

#include <fmt/format.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <cerrno>
#include <cmath>
#include <cstring>

namespace gicodec::streaming {
namespace {

using nlohmann::ordered_json;

constexpr double kInterval = 1;
constexpr std::size_t kMaxLatencies = 1U << 20, kRecent = 4096;
using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

/// Columns of the log; those of the streams follow.
const std::vector<std::string> kLogColumns{"update", "time",       "trace_ms", "encode_ms",
                                           "active", "connection", "packets",  "bytes"};

bool is_statistics(std::string_view head) {
  return head.starts_with("{\"summary\":{\"time\":") ||
         (head.starts_with("{\"time\":\"") && head.find("\",\"second\":") != head.npos);
}
bool is_log(std::string_view head) {
  return head.starts_with(fmt::format("{}", fmt::join(kLogColumns, ",")));
}

File open(const std::string& path, bool (*is_report)(std::string_view)) {
  if (!path.empty()) tools::check_report(path, is_report);
  File file(path.empty() ? nullptr : std::fopen(path.c_str(), "w"), std::fclose);
  if (!path.empty() && !file)
    tools::fail(tools::Exit::io, "{}: cannot be opened: {}", path, std::strerror(errno));
  // A killed server leaves complete lines.
  if (file) static_cast<void>(std::setvbuf(file.get(), nullptr, _IOLBF, BUFSIZ));
  return file;
}

bool is_whole(std::FILE* file) {
  return file == nullptr || (std::fflush(file) == 0 && std::ferror(file) == 0);
}
std::string lacks_lines(const std::string& path) {
  return path + ": could not be written, lines are missing; is the disk full?";
}
void check_written(std::FILE* file, const std::string& path) {
  if (!is_whole(file)) tools::fail(tools::Exit::io, "{}", lacks_lines(path));
}

double rounded(double value) { return std::round(value * 1000) / 1000; }
/// 0 if too little time has passed for a rate.
double per_second(double count, double seconds) { return seconds > 1e-6 ? count / seconds : 0; }
double mbps(std::uint64_t bytes, double seconds) {
  return per_second(static_cast<double>(bytes) * 8e-6, seconds);
}
const char* name(Delivery delivery) { return delivery == Delivery::unicast ? "unicast" : "shared"; }

ordered_json latency_json(const std::vector<float>& seconds) {
  const auto [p50, p95, p99] = percentiles(seconds);
  return {{"p50", rounded(p50 * 1e3)}, {"p95", rounded(p95 * 1e3)}, {"p99", rounded(p99 * 1e3)}};
}

}  // namespace

void Durations::add(double seconds) {
  sum += seconds;
  most = std::max(most, seconds);
  ++count;
}

double Durations::mean_ms() const { return count > 0 ? sum / static_cast<double>(count) * 1e3 : 0; }

ServerStatistics::ServerStatistics(const Output& output, const std::vector<FeedVolume>& volumes)
    : output_(output),
      lines_(open(output.file, is_statistics)),
      log_(open(output.log, is_log)),
      terminal_(!output.quiet && isatty(STDERR_FILENO) != 0) {
  for (const FeedVolume& volume : volumes) {
    first_stream_.push_back(streams_.size());
    for (const NamedTexture* texture : textures_of(volume.desc)) {
      streams_.push_back(volume.name + "." + texture->name);
    }
  }
  if (!log_) return;
  std::vector<std::string> columns = kLogColumns;
  columns.insert(columns.end(), streams_.begin(), streams_.end());
  tools::write_csv(log_.get(), columns);
}

ServerStatistics::~ServerStatistics() {
  if (terminal_) clear_status();
}

void ServerStatistics::opened(ConnectionId connection, const std::string& address) {
  connections_[connection].address = address;
}

void ServerStatistics::named(ConnectionId connection, const std::string& user) {
  if (const auto it = connections_.find(connection); it != connections_.end())
    it->second.user = user;
}

ServerStatistics::Totals ServerStatistics::totals(Server& server) {
  for (auto& [id, connection] : connections_) collect(server, id, connection);
  return {late_, bytes_, blocks_, all_encode_, latency_, recent_, published_, unanswered_};
}

void ServerStatistics::closed(Server& server, ConnectionId connection) {
  const auto it = connections_.find(connection);
  if (it == connections_.end()) return;
  collect(server, connection, it->second);
  connections_.erase(it);
}

double ServerStatistics::updating_seconds() const {
  if (updates_ < 2) return 0;
  const auto n = static_cast<double>(updates_);
  return (last_update_ - first_update_) * n / (n - 1);
}

void ServerStatistics::updated(Server& server, const Update& update) {
  if (++updates_ == 1) first_update_ = update.now;
  last_update_ = update.now;
  encode_.add(update.encode_seconds);
  all_encode_.add(update.encode_seconds);
  if (update.trace_seconds >= 0) {
    trace_.add(update.trace_seconds);
    all_trace_.add(update.trace_seconds);
  }
  const auto connections = server.connections().value_or({});
  most_connections_ = std::max(most_connections_, connections.size());
  for (const ConnectionId connection : connections) {
    std::vector<std::uint64_t> probes(streams_.size());
    std::uint64_t bytes = 0;
    const auto packets = server.packets(connection);
    for (const OutgoingPacket& packet : packets) {
      bytes += packet.packet->size();
      blocks_ += packet.blocks;
      probes[first_stream_[packet.stream.volume] + packet.stream.texture] += packet.blocks;
    }
    bytes_ += bytes;
    if (!log_) continue;
    std::vector<std::string> fields{
        fmt::format("{}", update.number),
        fmt::format("{}", update.time),
        fmt::format("{:.3f}", std::max(0.0, update.trace_seconds) * 1e3),
        fmt::format("{:.3f}", update.encode_seconds * 1e3),
        fmt::format("{}", update.active),
        fmt::format("{}", connection),
        fmt::format("{}", packets.size()),
        fmt::format("{}", bytes)};
    for (const std::uint64_t count : probes) fields.push_back(fmt::format("{}", count));
    tools::write_csv(log_.get(), fields);
  }
}

void ServerStatistics::collect(Server& server, ConnectionId id, Connection& connection) {
  for (const float latency : server.take_latencies(id)) {
    connection.latencies.push_back(latency);
    if (all_latencies_.size() < kMaxLatencies) all_latencies_.push_back(latency);
    if (recent_.size() < kRecent) recent_.push_back(latency);
    recent_[latency_.count % kRecent] = latency;
    latency_.add(latency);
  }
}

ordered_json ServerStatistics::line(Server& server, double now) {
  const double seconds = now - last_;
  ordered_json clients = ordered_json::array();
  std::uint64_t all_bytes = 0;
  for (auto& [id, connection] : connections_) {
    collect(server, id, connection);
    const auto s = server.statistics(id);
    if (!s) continue;
    const std::uint64_t bytes = s->bytes - connection.last.bytes;
    all_bytes += bytes;
    clients.push_back(
        {{"connection", id},
         {"client", s->client},
         {"address", connection.address},
         {"user", connection.user},
         {"delivery", name(s->delivery)},
         {"mbps", rounded(mbps(bytes, seconds))},
         {"updates_per_s",
          rounded(per_second(static_cast<double>(s->updates - connection.last.updates), seconds))},
         {"probes_per_s",
          rounded(per_second(static_cast<double>(s->blocks - connection.last.blocks), seconds))},
         {"latency_ms", latency_json(connection.latencies)},
         {"in_flight", s->in_flight},
         {"in_flight_bytes", s->in_flight_bytes},
         {"pending", s->pending},
         {"update_bytes", s->update_bytes},
         {"preset", s->preset},
         {"skipped", s->skipped},
         {"resyncs", s->resyncs}});
    connection.last = *s;
    connection.latencies.clear();
  }
  ordered_json totals{{"updates_per_s",
                       rounded(per_second(static_cast<double>(updates_ - last_updates_), seconds))},
                      {"mbps", rounded(mbps(all_bytes, seconds))},
                      {"trace_ms", rounded(trace_.mean_ms())},
                      {"views_ms", rounded(views_.mean_ms())},
                      {"encode_ms", rounded(encode_.mean_ms())},
                      {"late", late_},
                      {"memory_bytes", server.memory()}};
  if (published_) totals["published"] = published_json();
  trace_ = encode_ = views_ = {};
  last_updates_ = updates_;
  last_ = now;
  return {{"time", utc_time()},
          {"second", rounded(now - began_)},
          {"update", server.updates()},
          {"clients", std::move(clients)},
          {"totals", std::move(totals)}};
}

/// Since the beginning.
ordered_json ServerStatistics::published_json() const {
  return {{"updates", published_->updates},         {"update_bytes", published_->update_bytes},
          {"snapshots", published_->snapshots},     {"snapshot_bytes", published_->snapshot_bytes},
          {"other_bytes", published_->other_bytes}, {"unanswered", unanswered_}};
}

void ServerStatistics::write(const ordered_json& json) {
  for (std::FILE* file : {lines_.get(), output_.json ? stdout : nullptr}) {
    if (file == nullptr) continue;
    tools::write_json(file, json);
    tools::flush_text(file);
  }
}

void ServerStatistics::status(const ordered_json& line) const {
  const auto& totals = line["totals"];
  show_status("{}, {:.1f} updates/s, {:.2f} Mbps, trace {:.0f} ms, encode {:.1f} ms",
              count(line["clients"].size(), "client"), totals["updates_per_s"].get<double>(),
              totals["mbps"].get<double>(), totals["trace_ms"].get<double>(),
              totals["encode_ms"].get<double>());
}

void ServerStatistics::tick(Server& server, double now) {
  if (began_ < 0) began_ = last_ = now;
  if (now - last_ < kInterval) return;
  const ordered_json json = line(server, now);
  if (wants_lines()) write(json);
  if (terminal_) status(json);
}

void ServerStatistics::table(Server& server) const {
  const double seconds = updating_seconds();
  const auto [p50, p95, p99] = percentiles(all_latencies_);
  tools::print("{} in {:.1f} s, {:.1f} per second, {} late; at most {} at a time\n",
               count(updates_, "update"), seconds,
               per_second(static_cast<double>(updates_), seconds), late_,
               count(most_connections_, "client"));
  tools::print("sent      {:10.2f} Mbps  {} bytes, {} blocks\n", mbps(bytes_, seconds), bytes_,
               blocks_);
  tools::print("latency   {:10.1f} ms    median; 95 %: {:.1f}, 99 %: {:.1f}\n", p50 * 1e3,
               p95 * 1e3, p99 * 1e3);
  const auto row = [](const char* what, const Durations& d) {
    tools::print("{:9} {:10.1f} ms    mean; most {:.1f}\n", what, d.mean_ms(), d.most * 1e3);
  };
  row("trace", all_trace_);
  row("views", all_views_);
  row("encode", all_encode_);
  if (published_) {
    const std::uint64_t bytes =
        published_->update_bytes + published_->snapshot_bytes + published_->other_bytes;
    tools::print("published {:10.2f} Mbps  {} bytes, {:.1f} % of them snapshots\n",
                 mbps(bytes, seconds), bytes,
                 100 * static_cast<double>(published_->snapshot_bytes) /
                     static_cast<double>(std::max<std::uint64_t>(bytes, 1)));
  }
  tools::print("memory    {:10.1f} MB\n", static_cast<double>(server.memory()) * 1e-6);
}

void ServerStatistics::finish(Server& server, double now) {
  if (began_ < 0) began_ = last_ = now;
  for (auto& [id, connection] : connections_) collect(server, id, connection);
  if (now > last_ && wants_lines()) write(line(server, now));
  const double seconds = updating_seconds();
  ordered_json summary{
      {"time", utc_time()},
      {"seconds", rounded(seconds)},
      {"updates", updates_},
      {"updates_per_s", rounded(per_second(static_cast<double>(updates_), seconds))},
      {"late", late_},
      {"most_clients", most_connections_},
      {"bytes", bytes_},
      {"blocks", blocks_},
      {"mbps", rounded(mbps(bytes_, seconds))},
      {"latency_ms", latency_json(all_latencies_)},
      {"trace_ms", rounded(all_trace_.mean_ms())},
      {"views_ms", rounded(all_views_.mean_ms())},
      {"encode_ms", rounded(all_encode_.mean_ms())},
      {"memory_bytes", server.memory()}};
  if (published_) summary["published"] = published_json();
  write({{"summary", summary}});
  if (terminal_) clear_status();
  if (!output_.json && !output_.quiet) table(server);
}

std::string ServerStatistics::trouble() {
  for (const auto& [file, path] :
       {std::pair(lines_.get(), &output_.file), std::pair(log_.get(), &output_.log)}) {
    if (troubled_ || file == nullptr || std::ferror(file) == 0) continue;
    troubled_ = true;
    return lacks_lines(*path);
  }
  return {};
}

void ServerStatistics::check_written() const {
  streaming::check_written(lines_.get(), output_.file);
  streaming::check_written(log_.get(), output_.log);
}

}  // namespace gicodec::streaming
