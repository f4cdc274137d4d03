// The presets of a Distributor's packets: one of each unicast client, and one of all regions.
#include "session/server/distributor_state.h"

#include <algorithm>
#include <utility>

namespace gicodec {

Status Distributor::set_throughput(ClientId client, double throughput) {
  ServedClient* const found = state_->find(client);
  if (found == nullptr) return Status::unknown_connection;
  found->throughput = throughput;
  return Status::ok;
}

void Distributor::report_update_time(double elapsed, double budget) noexcept {
  ByPreset coded{};
  const auto add = [&coded](const PresetCosts& costs, std::size_t preset) {
    coded[preset] += costs.seconds[preset];
  };
  for (const auto& [id, client] : state_->clients) add(client->costs, client->preset.preset());
  state_->for_each_region([&](const ServedVolume&, const Bundle&, const SharedRegion& region) {
    add(region.costs, state_->shared_preset.preset());
  });
  state_->time.report(elapsed, budget, coded, state_->updated_seconds);
}

bool Distributor::State::chooses_presets() const noexcept {
  return std::any_of(volumes.begin(), volumes.end(), [](const auto& volume) {
    return std::any_of(volume->bundles.begin(), volume->bundles.end(), [](const auto& bundle) {
      return std::any_of(bundle->textures.begin(), bundle->textures.end(),
                         [](const auto& texture) { return texture->options.chooses_preset; });
    });
  });
}

/// Before an update. Shared packets are made for the clients that keep pace, and for all if these
/// are less than half of them or so few that one could decide alone.
void Distributor::State::choose_presets() {
  throughputs.clear();
  throughputs.reserve(clients.size());
  std::size_t keep_pace = 0;
  shared_clients = 0;
  for (const auto& [id, client] : clients) {
    if (client->delivery == Delivery::unicast || client->suspended) continue;
    ++shared_clients;
    if (client->throughput <= 0) continue;
    throughputs.push_back(client->throughput);
    if (!client->rate.slowed()) std::swap(throughputs[keep_pace++], throughputs.back());
  }
  // From here on nothing can fail.
  updated_seconds = std::exchange(published_seconds, 0);
  constexpr std::size_t kEnough = 3;
  const bool all = keep_pace < kEnough || 2 * keep_pace < throughputs.size();
  const std::size_t count = all ? throughputs.size() : keep_pace;
  const double throughput = low_throughput(std::span(throughputs).first(count));
  PresetCosts shared;
  for_each_region([&](const ServedVolume&, const Bundle&, const SharedRegion& region) {
    shared.add(region.costs);
  });
  shared_preset.choose(shared, throughput, time.pace(), time.slowest());
  for (const auto& [id, client] : clients) {
    client->preset.choose(client->costs, client->throughput, time.pace(), time.slowest());
    client->costs = {};
  }
}

}  // namespace gicodec
