// Packets for one client: visible blocks that changed since they were sent to it, as many as its
// budget allows (Stengel et al. §3.4).
#include "base/guard.h"
#include "session/server/distributor_state.h"

#include <algorithm>

namespace gicodec {
namespace {

/// Packets are written again, of fewer blocks, until they fit the budget.
constexpr int kAttempts = 8;
/// Candidates that are weighed, per block that can be sent.
constexpr std::size_t kWeighed = 4;

std::vector<Planned> plan(const ServedClient& client, std::span<const Candidate> chosen) {
  std::vector<Planned> planned;
  for (const Candidate& candidate : chosen) {
    if (planned.empty() || planned.back().bundle != candidate.bundle)
      planned.push_back({candidate.bundle});
    planned.back().blocks.push_back(candidate.block);
  }
  // A client whose state is unknown needs a keyframe, even an empty one.
  for (std::uint32_t i = 0; i < client.unicast.size(); ++i) {
    const UnicastBundle& unicast = client.unicast[i];
    const auto unknown = [](const UpdateStream& stream) {
      return stream.keyframe_next() && stream.sequence() != 0;
    };
    const auto same = [i](const Planned& p) { return p.bundle == i; };
    if (unicast.bundle->due &&
        std::any_of(unicast.streams.begin(), unicast.streams.end(), unknown) &&
        std::none_of(planned.begin(), planned.end(), same)) {
      planned.push_back({i});
    }
  }
  return planned;
}

/// The number of blocks to try first.
std::size_t first_guess(const ServedClient& client) {
  std::size_t limit = client.budget.blocks == 0 ? SIZE_MAX : client.budget.blocks;
  if (client.budget.bytes == 0 || client.unicast.empty()) return limit;
  float expected = client.bytes_per_block;
  if (expected <= 0) {
    const auto& streams = client.unicast.front().streams;
    for (const UpdateStream& stream : streams) {
      expected += static_cast<float>(block_bytes(stream.desc())) / kGuessedRatio + 1;
    }
    expected /= static_cast<float>(streams.size());
  }
  const double affordable = static_cast<double>(client.budget.bytes) / expected;
  if (affordable < static_cast<double>(limit)) limit = static_cast<std::size_t>(affordable);
  return std::max<std::size_t>(limit, 1);
}

std::size_t bytes_of(std::span<const Planned> planned) {
  std::size_t bytes = 0;
  for (const Planned& p : planned) {
    for (const Written& written : p.written) {
      for (const WrittenPacket& packet : written.packets()) bytes += packet.packet.size();
    }
  }
  return bytes;
}

}  // namespace

Status Distributor::State::write_unicast(ServedClient& client, unsigned thread,
                                         std::span<Planned> planned) {
  for (Planned& p : planned) {
    UnicastBundle& unicast = client.unicast[p.bundle];
    client.written += p.blocks.size() * unicast.streams.size();
    p.written.resize(unicast.streams.size());
    // If one texture of a bundle needs a keyframe, all get one: they share their blocks.
    const bool anew = std::any_of(unicast.streams.begin(), unicast.streams.end(),
                                  [](const UpdateStream& one) { return one.keyframe_next(); });
    const auto from = anew ? UpdateStream::From::keyframe : UpdateStream::From::sent;
    for (std::size_t i = 0; i < unicast.streams.size(); ++i) {
      UpdateStream& stream = unicast.streams[i];
      const auto found = encoder(thread, *unicast.bundle->textures[i], stream,
                                 unicast.encoders[i].get(), client.preset.preset());
      if (!found) return found.status();
      const Status status =
          stream.write(from, p.blocks, **found, workers[thread].writer, p.written[i]);
      if (status != Status::ok) return status;
    }
  }
  return Status::ok;
}

/// Writes packets of as many pending blocks as the budget has room for. `sent`: their number.
Status Distributor::State::write_within_budget(ServedClient& client, unsigned thread,
                                               std::vector<Planned>& planned, std::size_t& sent) {
  std::size_t limit = first_guess(client);
  auto [candidates, all_pending] = collect(client, updates, times(limit, kWeighed));
  const bool linked =
      std::any_of(client.unicast.begin(), client.unicast.end(),
                  [](const UnicastBundle& unicast) { return unicast.volume->linked; });
  const auto find_missing = [&](const Candidate& one) {
    return missing_dependencies(client, one, updates);
  };
  // A stateful backend cannot write the packets again.
  const bool once = std::any_of(client.unicast.begin(), client.unicast.end(),
                                [](const UnicastBundle& one) { return one.bundle->is_stateful; });
  bool weighed = false;
  for (int attempt = 0;; ++attempt) {
    if (!weighed && limit < blocks_of(candidates)) {
      keep_oldest(candidates, kWeighed * limit);
      weigh(client, candidates);
      weighed = true;
    }
    choose(candidates, limit, linked ? Missing(find_missing) : Missing());
    planned = plan(client, candidates);
    const Status status = write_unicast(client, thread, planned);
    if (status != Status::ok) return status;
    const std::size_t bytes = bytes_of(planned), blocks = blocks_of(candidates);
    const bool fits = client.budget.bytes == 0 || bytes <= client.budget.bytes;
    if (fits || candidates.size() <= 1 || once) {
      client.has_pending = all_pending > 0;
      client.held_back = blocks < all_pending && limit != client.budget.blocks;
      sent = blocks;
      return Status::ok;
    }
    const double ratio = static_cast<double>(client.budget.bytes) / static_cast<double>(bytes);
    const auto fewer = static_cast<std::size_t>(0.9 * ratio * static_cast<double>(blocks));
    limit = attempt + 1 >= kAttempts ? 1 : std::clamp<std::size_t>(fewer, 1, blocks - 1);
  }
}

/// Makes all of an update's packets or none.
Status Distributor::State::update_unicast(ServedClient& client, unsigned thread) {
  std::vector<Planned> planned;
  std::vector<std::shared_ptr<Packet>> packets;
  std::size_t sent = 0;
  const Status status = guarded([&]() -> Status {
    const Status written = write_within_budget(client, thread, planned, sent);
    if (written != Status::ok) return written;
    for (const Planned& p : planned) {
      for (const Written& one : p.written) {
        for (std::size_t i = 0; i < one.packets().size(); ++i) {
          packets.push_back(std::make_shared<Packet>());
        }
      }
    }
    client.out.reserve(packets.size());
    return Status::ok;
  });
  if (status != Status::ok) {
    // Stateful encoders have seen blocks that will not be sent.
    for (UnicastBundle& unicast : client.unicast) {
      if (!unicast.bundle->is_stateful) continue;
      for (UpdateStream& stream : unicast.streams) stream.request_keyframe();
    }
    return status;
  }
  // From here on nothing can fail.
  const std::size_t bytes = bytes_of(planned);
  auto next = packets.begin();
  for (Planned& p : planned) {
    UnicastBundle& unicast = client.unicast[p.bundle];
    for (const std::uint32_t block : p.blocks) unicast.pending_since[block] = 0;
    for (std::size_t i = 0; i < unicast.streams.size(); ++i) {
      const ServedTexture& texture = *unicast.bundle->textures[i];
      unicast.streams[i].commit(p.written[i]);
      const StreamId id{unicast.volume->id(), texture.id, StreamId::kWholeVolume};
      for (WrittenPacket& written : p.written[i].packets()) {
        **next = std::move(written.packet);
        const auto blocks = static_cast<std::uint32_t>(written.contents.blocks.size());
        if (texture.options.chooses_preset) {
          client.costs.add(texture.history.desc(), blocks, (*next)->size(), client.preset.preset());
        }
        client.out.push_back(
            {id, 0, blocks, written.sequence, is_keyframe(written.type), std::move(*next++)});
      }
    }
  }
  if (sent > 0) {
    const float now = static_cast<float>(bytes) / static_cast<float>(sent);
    client.bytes_per_block =
        client.bytes_per_block <= 0 ? now : 0.75F * client.bytes_per_block + 0.25F * now;
  }
  return Status::ok;
}

}  // namespace gicodec
