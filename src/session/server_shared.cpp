// Packets of chunks, made once for all who subscribe. Who comes late gets a snapshot, who takes
// fewer updates than others gets skips, and then the same packets as everybody.
#include "base/guard.h"
#include "session/server_state.h"

#include <algorithm>
#include <utility>

namespace gicodec {
namespace {

/// States of a chunk that are kept for those who are behind.
constexpr std::size_t kMaxBehind = 12;
/// Skips of a chunk in one update: as many as four groups at all rates need on average, and some.
constexpr std::size_t kMaxSkips = 4;
/// An update may be so much larger than the budget, which counts on average.
constexpr float kBurst = 2;

/// True if the receiver holds what the stream sent last.
bool is_current(const UpdateStream& stream, const Join& join) noexcept {
  return !stream.keyframe_next() && stream.state().is(join.sequence, join.checksum);
}

Behind* find_behind(ChunkStream& shared, const Join& join) noexcept {
  const auto same = [&](const Behind& one) { return one.state.is(join.sequence, join.checksum); };
  const auto it = std::ranges::find_if(shared.behind, same);
  return it == shared.behind.end() ? nullptr : &*it;
}

Audience& audience_of(ChunkStream& shared, const Join& join) noexcept {
  if (is_current(shared.stream, join)) return shared.up_to_date;
  Behind* const behind = find_behind(shared, join);
  return behind != nullptr ? behind->audience : shared.waiting;
}

std::vector<SharedPacket> shared_packets(std::vector<WrittenPacket>& written) {
  std::vector<SharedPacket> packets;
  packets.reserve(written.size());
  for (WrittenPacket& one : written) {
    packets.push_back({std::make_shared<const Packet>(std::move(one.packet)),
                       static_cast<std::uint32_t>(one.probes.size())});
  }
  return packets;
}

}  // namespace

/// Every chunk that a client subscribes to: visit(id, place, join, stream).
template <typename Visit>
void Server::State::for_each_join(ServedClient& client, const Visit& visit) noexcept {
  std::size_t place = 0;
  for (const auto& volume : volumes) {
    auto join = client.joins[volume->id].begin();
    for (std::uint32_t chunk = 0; chunk < volume->chunks.chunks(); ++chunk) {
      for (const auto& texture : volume->textures) {
        Join& own = *join++;
        const std::size_t at = place++;
        if (!own.subscribed) continue;
        visit(StreamId{volume->id, texture->id, chunk}, at, own, texture->chunks[chunk]);
      }
    }
  }
}

/// Before an update: who takes part in it, and what they hold.
void Server::State::gather_audiences() noexcept {
  for (const auto& volume : volumes) {
    for (const auto& texture : volume->textures) {
      for (ChunkStream& shared : texture->chunks) {
        shared.up_to_date = shared.waiting = {};
        for (Behind& behind : shared.behind) behind.audience = {};
      }
    }
  }
  for (const auto& entry : clients) {
    ServedClient& client = *entry.second;
    if (client.delivery != Delivery::shared) continue;
    std::size_t streams = 0, bytes = 0;
    for_each_join(client, [&](StreamId, std::size_t, const Join&, const ChunkStream& shared) {
      ++streams;
      bytes += core_bytes(shared.stream.desc()) * shared.stream.probes();
    });
    client.rate.choose(client.budget, streams, bytes / std::max<std::size_t>(streams, 1));
    for_each_join(client, [&](StreamId, std::size_t place, Join& join, ChunkStream& shared) {
      Audience& audience = audience_of(shared, join);
      ++audience.all;
      if (!client.suspended && client.rate.turn(updates, place)) ++audience.served;
    });
  }
}

/// Which snapshots and skips there is time for: the oldest first, of chunks in an order that is
/// another one in every update.
void Server::State::allot_extras() noexcept {
  std::size_t streams = 0;
  for (const auto& volume : volumes) streams += volume->chunks.chunks() * volume->textures.size();
  constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15;
  const std::size_t start = streams == 0 ? 0 : (updates * kGolden >> 32) % streams;
  std::uint64_t left = extra_probes == 0 ? UINT64_MAX : extra_probes;
  const auto allot = [&](Audience& audience, std::uint32_t probes) {
    if (audience.served == 0 || left == 0) return false;
    left -= std::min<std::uint64_t>(left, probes);
    return audience.extra = true;
  };
  for (const bool wrapped : {false, true}) {
    std::size_t place = 0;
    for (const auto& volume : volumes) {
      for (const auto& texture : volume->textures) {
        for (ChunkStream& shared : texture->chunks) {
          if ((place++ < start) != wrapped) continue;
          std::size_t skips = 0;
          for (Behind& behind : shared.behind) {
            if (skips < kMaxSkips && allot(behind.audience, shared.stream.probes())) ++skips;
          }
          allot(shared.waiting, shared.stream.probes());
        }
      }
    }
  }
}

/// Moves the stream on, or not at all; then makes what others need to follow it.
Status Server::State::update_chunk(ServedVolume& volume, ServedTexture& texture,
                                   std::uint32_t chunk, unsigned thread) {
  ChunkStream& shared = texture.chunks[chunk];
  shared.written = 0;
  const auto served = [](const Behind& behind) { return behind.audience.extra; };
  if (shared.up_to_date.served == 0 && !shared.waiting.extra &&
      std::ranges::none_of(shared.behind, served)) {
    return Status::ok;
  }
  auto made = worker(thread, shared.stream.desc());
  if (!made) return made.status();
  StreamWorker& with = **made;
  if (texture.due(updates)) {
    const Status status = advance(volume, texture, shared, with);
    if (status != Status::ok) return status;
  }
  if (shared.stream.keyframe_next()) return Status::ok;
  Status first = Status::ok;
  const auto note = [&first](Status status) {
    if (first == Status::ok) first = status;
  };
  for (Behind& behind : shared.behind) {
    if (behind.audience.extra && behind.audience.packets.empty()) {
      note(guarded([&] { return make_skip(shared, behind, with); }));
    }
  }
  if (shared.waiting.extra && shared.waiting.packets.empty()) {
    note(guarded([&] { return make_snapshot(shared, with); }));
  }
  return first;
}

/// Moves the stream on to what changed, by packets for those who need some anyway: who is up to
/// date, else some of those who are behind, else those who wait. Who held the state before is
/// behind then.
Status Server::State::advance(const ServedVolume& volume, const ServedTexture& texture,
                              ChunkStream& shared, StreamWorker& with) {
  UpdateStream& stream = shared.stream;
  const auto anybody = [](const Behind& behind) { return behind.audience.all > 0; };
  const bool nobody = shared.up_to_date.all == 0 && std::ranges::none_of(shared.behind, anybody);
  if (nobody) stream.request_keyframe();
  const bool known = !stream.keyframe_next();
  std::vector<std::uint32_t> probes;
  for (std::uint32_t probe = 0; probe < stream.probes(); ++probe) {
    if (!volume.is_active(stream.source(probe))) continue;
    if (texture.outdated(stream, probe)) probes.push_back(probe);
  }
  if (probes.empty() && known) return Status::ok;

  // Room first, so that nothing can fail once there are packets.
  if (known) shared.behind.push_back({stream.state(), {}});
  Behind* const before = known ? &shared.behind.back() : nullptr;
  const StreamState* from = nullptr;
  Audience* audience = &shared.waiting;
  if (shared.up_to_date.served > 0) {
    from = &before->state;
    audience = &before->audience;
  } else if (const auto it = std::ranges::find_if(
                 shared.behind, [](const Behind& one) { return one.audience.extra; });
             known && it != shared.behind.end()) {
    from = &it->state;
    audience = &it->audience;
  }
  std::vector<WrittenPacket> written;
  std::vector<SharedPacket> packets;
  StreamState to = stream.state();
  const Status status = guarded([&]() -> Status {
    const Status made = stream.next(from, probes, *with.encoder, with.scratch, to, written);
    if (made == Status::ok) packets = shared_packets(written);
    return made;
  });
  if (status != Status::ok) {
    if (known) shared.behind.pop_back();
    return status;
  }
  if (before != nullptr) before->audience.all = std::exchange(shared.up_to_date.all, 0);
  for (const WrittenPacket& one : written) shared.written += one.probes.size();
  audience->packets = std::move(packets);
  stream.move_to(std::move(to));
  return Status::ok;
}

Status Server::State::make_skip(ChunkStream& shared, Behind& behind, StreamWorker& with) {
  std::vector<WrittenPacket> written;
  const Status status = shared.stream.skip(behind.state, *with.encoder, with.scratch, written);
  if (status != Status::ok) return status;
  behind.audience.packets = shared_packets(written);
  for (const WrittenPacket& one : written) shared.written += one.probes.size();
  return Status::ok;
}

Status Server::State::make_snapshot(ChunkStream& shared, StreamWorker& with) {
  auto packet = std::make_shared<Packet>();
  const Status status = shared.stream.snapshot(*with.encoder, with.scratch, *packet);
  if (status != Status::ok) return status;
  shared.written += shared.stream.probes();
  shared.waiting.packets.push_back({std::move(packet), shared.stream.probes()});
  return status;
}

/// After all chunks are made: one thread. Who cannot be handed what was made holds what he held.
Status Server::State::hand_out_chunks(ServedClient& client) noexcept {
  client.held_back = client.rate.slowed();
  if (client.suspended) return Status::ok;
  const auto for_each_turn = [&](const auto& visit) {
    for_each_join(client, [&](StreamId id, std::size_t place, Join& join, ChunkStream& shared) {
      if (!client.rate.turn(updates, place)) return;
      Audience& audience = audience_of(shared, join);
      visit(id, join, shared, audience);
    });
  };
  std::size_t packets = 0;
  for_each_turn([&](StreamId, const Join&, const ChunkStream&, const Audience& audience) {
    packets += audience.packets.size();
  });
  const Status room = guarded([&]() -> Status {
    client.out.reserve(packets);
    return Status::ok;
  });
  if (room != Status::ok) return room;
  const double most =
      client.budget.bytes == 0 ? 1e18 : kBurst * static_cast<double>(client.budget.bytes);
  std::size_t turns = 0, bytes = 0, probes = 0;
  for_each_turn([&](StreamId id, Join& join, const ChunkStream& shared, Audience& audience) {
    ++turns;
    if (audience.packets.empty()) return;
    std::size_t size = 0;
    for (const SharedPacket& one : audience.packets) size += one.packet->size();
    if (bytes > 0 && static_cast<double>(bytes + size) > most) {
      client.held_back = true;
      return;
    }
    bytes += size;
    for (const SharedPacket& one : audience.packets) {
      client.out.push_back({id, one.probes, one.packet});
      probes += one.probes;
    }
    join.sequence = shared.stream.sequence();
    join.checksum = shared.stream.checksum();
    --audience.all;
  });
  client.rate.sent(turns, bytes, probes);
  return Status::ok;
}

/// After an update: states that nobody holds any more, and more than are kept, with their packets.
void Server::State::forget_behind() noexcept {
  for (const auto& volume : volumes) {
    for (const auto& texture : volume->textures) {
      for (ChunkStream& shared : texture->chunks) {
        shared.waiting.packets.clear();
        std::erase_if(shared.behind, [](const Behind& one) { return one.audience.all == 0; });
        for (Behind& behind : shared.behind) behind.audience.packets.clear();
        if (shared.behind.size() <= kMaxBehind) continue;
        // The oldest of those that fewest hold: they get snapshots.
        shared.behind.erase(std::ranges::min_element(
            shared.behind, {}, [](const Behind& one) { return one.audience.all; }));
      }
    }
  }
}

/// Subscribes to the chunks of which the client sees a probe, and to no others.
void Server::State::set_joins(ServedClient& client, const ServedVolume& volume) noexcept {
  const ProbeMask& visible = client.visible[volume.id];
  auto join = client.joins[volume.id].begin();
  for (std::uint32_t chunk = 0; chunk < volume.chunks.chunks(); ++chunk) {
    const bool wanted =
        !visible.empty() && std::ranges::any_of(volume.chunk_probes[chunk],
                                                [&](std::uint32_t p) { return visible[p] != 0; });
    for (std::size_t i = 0; i < volume.textures.size(); ++i) (join++)->subscribed = wanted;
  }
}

std::pair<Join*, ChunkStream*> Server::State::find_chunk(ServedClient& client, StreamId id) {
  if (id.volume >= volumes.size()) return {};
  ServedVolume& volume = *volumes[id.volume];
  if (id.texture >= volume.textures.size() || id.chunk >= volume.chunks.chunks()) return {};
  // As set_joins() counts them.
  const std::size_t place = std::size_t{id.chunk} * volume.textures.size() + id.texture;
  return {&client.joins[id.volume][place], &volume.textures[id.texture]->chunks[id.chunk]};
}

const StreamState* Server::State::held_of_chunk(ServedClient& client, StreamId id) {
  const auto [join, shared] = find_chunk(client, id);
  if (join == nullptr) return nullptr;
  if (is_current(shared->stream, *join)) return &shared->stream.state();
  const Behind* const behind = find_behind(*shared, *join);
  return behind == nullptr ? nullptr : &behind->state;
}

Status Server::State::resume_chunk(ServedClient& client, StreamId id, std::uint32_t sequence,
                                   std::uint32_t checksum) {
  Join* const join = find_chunk(client, id).first;
  if (join == nullptr) return Status::invalid_argument;
  join->sequence = sequence;
  join->checksum = checksum;
  return Status::ok;
}

}  // namespace gicodec
