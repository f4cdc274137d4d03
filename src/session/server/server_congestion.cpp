// How much each client gets in an update: congestion control, rate, budget and the server's time
// limit it.
#include "session/server/server_state.h"

#include <algorithm>
#include <cmath>

namespace gicodec {
namespace {

/// Rounds down; values beyond kMax become kMax, which is no limit in practice.
std::uint64_t whole_bytes(double bytes) noexcept {
  constexpr double kMax = 1e18;
  return static_cast<std::uint64_t>(std::min(bytes, kMax));
}

}  // namespace

void Server::set_limit_for_few(std::uint32_t blocks) noexcept { state_->set_limit_for_few(blocks); }

void Server::State::set_limit_for_few(double blocks) noexcept {
  limit_for_few = blocks;
  distributor.set_limit_for_few(blocks > 0 ? static_cast<std::uint32_t>(std::max(blocks, 1.0)) : 0);
}

void Server::report_update_time(double elapsed, double budget) noexcept {
  if (!std::isfinite(elapsed) || !std::isfinite(budget) || budget <= 0) return;
  state_->set_limit_for_few(next_limit_for_few(state_->limit_for_few, state_->distributor.written(),
                                               std::max(elapsed, 0.0), budget));
  state_->distributor.report_update_time(std::max(elapsed, 0.0), budget);
  // The time of making an update does not count as its delay.
  for (const auto& [id, connection] : state_->connections) {
    if (connection->in_flight.empty() || connection->in_flight.back().made != state_->updated)
      continue;
    connection->in_flight.back().sent.made += std::clamp(elapsed, 0.0, budget);
  }
}

/// Gives even shares to ready clients with pending blocks. If a share is less than a block, clients
/// take turns; if the limit is less than a block, some updates have no turn.
void Server::State::share_unicast_blocks() noexcept {
  const auto takes = [this](const auto& entry) {
    const Session* const session = entry.second->session;
    return entry.second->ready && session != nullptr && session->delivery == Delivery::unicast &&
           distributor.has_pending(session->client);
  };
  double block = 1;  // counts once per texture of its group
  for (const auto& volume : distributor.table()) {
    for (const TextureGroup& group : volume->desc.groups) {
      block = std::max(block, static_cast<double>(group.textures.size()));
    }
  }
  const double most = std::max(limit_for_few, block);
  unicast_blocks = std::clamp(unicast_blocks + limit_for_few, -most, most);
  const auto unicast_takers =
      static_cast<double>(std::count_if(connections.begin(), connections.end(), takes));
  const double share = std::floor(unicast_blocks / std::max(unicast_takers, 1.0));
  const bool all = share >= block;
  for (const auto& [id, connection] : connections) {
    if (connection->session == nullptr) continue;
    Session& session = *connection->session;
    session.unicast_limited = limit_for_few > 0 && session.delivery == Delivery::unicast;
    // Without pending blocks a client needs room for one, so that new ones are found.
    const double least = distributor.has_pending(session.client) ? 0 : block;
    session.unicast_blocks = static_cast<std::uint32_t>(std::max(all ? share : 0, least));
  }
  if (all) return;
  auto turns = std::min(std::floor(unicast_blocks / block), unicast_takers);
  for (auto next = connections.upper_bound(last_turn); turns >= 1; ++next) {
    if (next == connections.end()) next = connections.begin();
    if (!takes(*next)) continue;
    next->second->session->unicast_blocks = static_cast<std::uint32_t>(block);
    last_turn = next->first;
    --turns;
  }
}

/// Sets a client's budget to the least of its own, `bytes`, its share and the rates. False if a
/// rate leaves nothing; updates pay for what earlier ones took beyond it.
bool Server::State::fits_rate(Connection& connection, std::uint64_t bytes, double now) noexcept {
  Session& session = *connection.session;
  Budget budget = session.budget;
  const auto tighten = [](auto& value, auto limit) {
    if (limit != 0) value = value == 0 ? limit : std::min(value, limit);
  };
  if (session.unicast_limited) tighten(budget.blocks, session.unicast_blocks);
  tighten(budget.bytes, bytes);
  if (options.limits.max_bytes_per_second != 0) {
    const auto rate = static_cast<double>(options.limits.max_bytes_per_second);
    session.credit = std::min(rate, session.credit + std::max(now - session.credit_at, 0.0) * rate);
    session.credit_at = now;
    if (session.credit < 1) return false;
    tighten(budget.bytes, whole_bytes(session.credit));
  }
  if (options.limits.max_total_bytes_per_second != 0) {
    const double share = total_credit / takers;
    if (share < 1) return false;
    tighten(budget.bytes, whole_bytes(share));
  }
  connection.congestion_limited = budget.bytes == bytes;
  static_cast<void>(distributor.set_budget(session.client, budget));
  return true;
}

/// When the oldest update in flight that is not empty was made.
std::optional<double> Server::State::oldest_filled(const Connection& connection) noexcept {
  const auto filled = [](const InFlight& update) { return !update.sent.empty; };
  const auto it = std::find_if(connection.in_flight.begin(), connection.in_flight.end(), filled);
  return it == connection.in_flight.end() ? std::nullopt : std::optional(it->sent.made);
}

/// Skips a client that has used up its rate, or lags. A lagging client gets empty updates, which
/// tell it the time, and whether it has missed an update.
void Server::State::choose_turn(Connection& connection, double now) noexcept {
  ConnectionStatistics& s = connection.statistics;
  if (connection.in_flight.empty()) connection.progress = now;
  const std::optional<double> oldest = oldest_filled(connection);
  const auto bytes = connection.congestion.budget(now, oldest, s.in_flight_bytes, interval);
  const bool full = connection.in_flight.size() >= options.limits.max_in_flight;
  s.lagging = !bytes || full || s.in_flight_bytes >= options.limits.max_in_flight_bytes;
  static_cast<void>(
      distributor.set_throughput(connection.session->client, connection.congestion.throughput()));
  const bool may = fits_rate(connection, bytes.value_or(0), now);
  const bool waits = connection.session->unicast_limited && connection.session->unicast_blocks == 0;
  using Turn = Connection::Turn;
  connection.ready = may && !s.lagging && *bytes > 0;
  connection.turn = connection.ready && !waits ? Turn::full : Turn::empty;
  // Only an update of the new sync point lets the client acknowledge those of earlier ones.
  const bool agreed =
      connection.in_flight.empty() || connection.in_flight.back().sync == connection.sync;
  if ((full || !may) && agreed) connection.turn = Turn::none;
  // If all updates in flight are lost, only another update shows the client so.
  constexpr double kReminder = 1;  // seconds
  if (full && agreed &&
      now - std::max(connection.in_flight.back().made, connection.reminded) >= kReminder) {
    connection.turn = Turn::reminder;
  }
  static_cast<void>(distributor.suspend(connection.session->client, connection.turn != Turn::full));
  if (connection.turn != Turn::full) ++s.skipped;
}

/// Measures the interval between updates, and the mean budget of congestion control.
void Server::State::measure_interval(double now) noexcept {
  constexpr double kWeight = 1.0 / 8, kLongest = 4, kShortest = 0.01;
  const double passed = updated >= 0 ? std::max(now - updated, 0.0) : 1;
  const auto rate = static_cast<double>(options.limits.max_total_bytes_per_second);
  total_credit = std::min(rate, total_credit + passed * rate);
  if (options.interval > 0) {
    interval = options.interval;
  } else if (updated >= 0) {
    const double since = std::max(now - updated, kShortest);
    interval = interval == 0
                   ? since
                   : interval + kWeight * (std::min(since, kLongest * interval) - interval);
  }
  updated = now;
  double bytes = 0;
  takers = 0;
  for (const auto& [id, connection] : connections) {
    if (connection->session == nullptr) continue;
    bytes += connection->congestion.bytes();
    takers += 1;
  }
  mean_bytes = bytes / std::max(takers, 1.0);
}

}  // namespace gicodec
