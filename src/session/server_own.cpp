// Packets made for one client: the probes it sees that changed since they were sent to it, as many
// as its budget allows (Stengel et al. §3.4).
#include "base/guard.h"
#include "session/block_difference.h"
#include "session/server_state.h"

#include <algorithm>

namespace gicodec {
namespace {

/// Packets are written again, of fewer probes, until they fit the budget.
constexpr int kAttempts = 8;
/// How much a probe changed is looked at for so many times those that can be sent.
constexpr std::size_t kWeighed = 4;
/// First guess of what a probe costs: a third of its texels.
constexpr float kGuessedRatio = 3;

/// Probes of all due streams that the client sees and does not hold as they are.
std::vector<Candidate> collect(ServedClient& client, std::uint64_t update) {
  std::vector<Candidate> candidates;
  for (std::uint32_t i = 0; i < client.own.size(); ++i) {
    OwnStream& own = client.own[i];
    if (!own.texture->due(update)) continue;
    const ProbeMask& visible = client.visible[own.volume->id];
    const Grid& grid = own.stream.desc().grid;
    for (std::uint32_t probe = 0; probe < own.stream.probes(); ++probe) {
      std::uint32_t& since = own.owed_since[probe];
      const bool owed = !visible.empty() && visible[probe] != 0 && own.volume->is_active(probe) &&
                        own.texture->outdated(own.stream, probe);
      if (!owed) {
        since = 0;
        continue;
      }
      if (since == 0) since = static_cast<std::uint32_t>(update);
      candidates.push_back(
          {i, probe, static_cast<std::uint32_t>(update) - since, 0, spread_order(grid, probe)});
    }
  }
  return candidates;
}

void weigh(const ServedClient& client, std::span<Candidate> candidates) {
  for (Candidate& candidate : candidates) {
    const OwnStream& own = client.own[candidate.stream];
    const BlockHistory& history = own.texture->history;
    candidate.change =
        own.stream.moved(candidate.probe)
            ? 1.0F
            : changed_share(own.stream.desc(), history.core(own.stream.sent(candidate.probe)),
                            history.core(history.current()[candidate.probe]));
  }
}

std::vector<Planned> plan(const ServedClient& client, std::span<const Candidate> chosen,
                          std::uint64_t update) {
  std::vector<Planned> planned;
  for (const Candidate& candidate : chosen) {
    if (planned.empty() || planned.back().stream != candidate.stream) {
      planned.push_back({candidate.stream, {}, {}});
    }
    planned.back().probes.push_back(candidate.probe);
  }
  // A receiver whose state is unknown needs its keyframe even if nothing is in it.
  for (std::uint32_t i = 0; i < client.own.size(); ++i) {
    const OwnStream& own = client.own[i];
    if (!own.stream.keyframe_next() || own.stream.sequence() == 0) continue;
    if (!own.texture->due(update)) continue;
    const auto same = [&](const Planned& p) { return p.stream == i; };
    if (std::ranges::none_of(planned, same)) planned.push_back({i, {}, {}});
  }
  return planned;
}

/// How many of the wanted probes are tried first.
std::size_t first_guess(const ServedClient& client, std::span<const Candidate> candidates) {
  const std::size_t wanted = candidates.size();
  std::size_t limit = client.budget.probes == 0 ? wanted : client.budget.probes;
  if (client.budget.bytes == 0 || wanted == 0) return limit;
  float expected = client.bytes_per_probe;
  if (expected <= 0) {
    const auto& desc = client.own[candidates.front().stream].stream.desc();
    expected = static_cast<float>(core_bytes(desc)) / kGuessedRatio + 1;
  }
  const double affordable = static_cast<double>(client.budget.bytes) / expected;
  if (affordable < static_cast<double>(limit)) limit = static_cast<std::size_t>(affordable);
  return std::max<std::size_t>(limit, 1);
}

std::size_t bytes_of(std::span<const Planned> planned) {
  std::size_t bytes = 0;
  for (const Planned& p : planned) {
    for (const WrittenPacket& written : p.packets) bytes += written.packet.size();
  }
  return bytes;
}

}  // namespace

Status Server::State::write_own(ServedClient& client, unsigned thread, std::span<Planned> planned) {
  for (Planned& p : planned) {
    OwnStream& own = client.own[p.stream];
    auto made = worker(thread, own.stream.desc());
    if (!made) return made.status();
    BackendEncoder& encoder = own.encoder ? *own.encoder : *(*made)->encoder;
    client.written += p.probes.size();
    const Status status = own.stream.write(encoder, p.probes, (*made)->scratch, p.packets);
    if (status != Status::ok) return status;
  }
  return Status::ok;
}

/// Writes packets of as many candidates as the budget has room for; the others are dropped.
Status Server::State::write_within_budget(ServedClient& client, unsigned thread,
                                          std::vector<Candidate>& candidates,
                                          std::vector<Planned>& planned) {
  const std::size_t wanted = candidates.size();
  std::size_t limit = first_guess(client, candidates);
  if (limit < candidates.size()) {
    keep_oldest(candidates, kWeighed * limit);
    weigh(client, candidates);
  }
  for (int attempt = 0;; ++attempt) {
    choose(candidates, limit);
    planned = plan(client, candidates, updates);
    const Status status = write_own(client, thread, planned);
    if (status != Status::ok) return status;
    const std::size_t bytes = bytes_of(planned);
    const bool fits = client.budget.bytes == 0 || bytes <= client.budget.bytes;
    // What a backend remembers cannot be taken back.
    if (fits || candidates.size() <= 1 || remembers) {
      client.held_back = candidates.size() < wanted && candidates.size() != client.budget.probes;
      return Status::ok;
    }
    const double ratio = static_cast<double>(client.budget.bytes) / static_cast<double>(bytes);
    const auto fewer =
        static_cast<std::size_t>(0.9 * ratio * static_cast<double>(candidates.size()));
    limit = attempt + 1 >= kAttempts ? 1 : std::clamp<std::size_t>(fewer, 1, candidates.size() - 1);
  }
}

/// All of an update's packets or none.
Status Server::State::update_own(ServedClient& client, unsigned thread) {
  std::vector<Planned> planned;
  std::vector<std::shared_ptr<Packet>> packets;
  std::size_t sent = 0;
  const Status status = guarded([&]() -> Status {
    std::vector<Candidate> candidates = collect(client, updates);
    const Status written = write_within_budget(client, thread, candidates, planned);
    if (written != Status::ok) return written;
    sent = candidates.size();
    for (const Planned& p : planned) {
      for (std::size_t i = 0; i < p.packets.size(); ++i) {
        packets.push_back(std::make_shared<Packet>());
      }
    }
    client.out.reserve(packets.size());
    return Status::ok;
  });
  if (status != Status::ok) {
    // Encoders that remember have seen what is not going to be sent.
    for (OwnStream& own : client.own) {
      if (own.encoder != nullptr) own.stream.request_keyframe();
    }
    return status;
  }
  // From here on nothing can fail.
  const std::size_t bytes = bytes_of(planned);
  auto next = packets.begin();
  for (Planned& p : planned) {
    OwnStream& own = client.own[p.stream];
    for (const std::uint32_t probe : p.probes) own.owed_since[probe] = 0;
    for (WrittenPacket& written : p.packets) {
      own.stream.commit(written);
      **next = std::move(written.packet);
      client.out.push_back({{own.volume->id, own.texture->id, StreamId::kWholeVolume},
                            static_cast<std::uint32_t>(written.probes.size()),
                            std::move(*next++)});
    }
  }
  if (sent > 0) {
    const float now = static_cast<float>(bytes) / static_cast<float>(sent);
    client.bytes_per_probe =
        client.bytes_per_probe <= 0 ? now : 0.75F * client.bytes_per_probe + 0.25F * now;
  }
  return Status::ok;
}

}  // namespace gicodec
