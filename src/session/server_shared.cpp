// Packets of chunks, made once for all who subscribe. A client that comes later gets a snapshot and
// then the same packets as everybody.
#include "base/guard.h"
#include "session/server_state.h"

#include <algorithm>
#include <utility>

namespace gicodec {
namespace {

using Part = Join::Part;

/// Who holds the stream's last packet goes on with it; others wait for a snapshot.
Part part_of(const UpdateStream& stream, std::uint32_t sequence, std::uint32_t checksum) {
  const bool current = sequence > 0 && !stream.keyframe_next() && sequence == stream.sequence() &&
                       checksum == stream.checksum();
  return current ? Part::joined : Part::waiting;
}

}  // namespace

/// Makes all packets or none; a snapshot that cannot be made leaves those who wait waiting.
Status Server::State::update_chunk(ServedVolume& volume, ServedTexture& texture,
                                   std::uint32_t chunk, unsigned thread) {
  ChunkStream& shared = texture.chunks[chunk];
  shared.packets.clear();
  shared.snapshot = {};
  if (shared.subscribers == 0 || !texture.due(updates)) return Status::ok;
  auto made = worker(thread, shared.stream.desc());
  if (!made) return made.status();
  StreamWorker& with = **made;
  // Nobody holds an earlier state: a keyframe serves them all.
  if (shared.waiting == shared.subscribers) shared.stream.request_keyframe();
  const bool keyframe = shared.stream.keyframe_next();

  std::vector<std::uint32_t> probes;
  for (std::uint32_t probe = 0; probe < shared.stream.probes(); ++probe) {
    if (!volume.is_active(shared.stream.source(probe))) continue;
    if (texture.outdated(shared.stream, probe)) probes.push_back(probe);
  }
  std::vector<WrittenPacket> written;
  if (!probes.empty() || keyframe) {
    const Status status = shared.stream.write(*with.encoder, probes, with.scratch, written);
    if (status != Status::ok) return status;
  }
  std::vector<std::shared_ptr<Packet>> packets(written.size());
  for (auto& packet : packets) packet = std::make_shared<Packet>();
  shared.packets.reserve(written.size());
  // From here on nothing can fail but a snapshot.
  for (std::size_t i = 0; i < written.size(); ++i) {
    shared.stream.commit(written[i]);
    *packets[i] = std::move(written[i].packet);
    shared.packets.push_back(
        {std::move(packets[i]), static_cast<std::uint32_t>(written[i].probes.size())});
  }
  shared.made = updates;
  shared.keyframe = keyframe;
  if (shared.waiting == 0 || shared.waiting == shared.subscribers) return Status::ok;
  return make_snapshot(shared, with);
}

Status Server::State::make_snapshot(ChunkStream& shared, StreamWorker& with) {
  auto packet = std::make_shared<Packet>();
  const Status status = shared.stream.snapshot(*with.encoder, with.scratch, *packet);
  if (status == Status::ok) shared.snapshot = {std::move(packet), shared.stream.probes()};
  return status;
}

/// After all chunks are made: one thread. Who cannot be handed what was made waits for a snapshot.
Status Server::State::hand_out_chunks(ServedClient& client) noexcept {
  const auto for_each_join = [&](const auto& visit) {
    for (const auto& volume : volumes) {
      auto join = client.joins[volume->id].begin();
      for (std::uint32_t chunk = 0; chunk < volume->chunks.chunks(); ++chunk) {
        for (const auto& texture : volume->textures) {
          Join& state = *join++;
          ChunkStream& shared = texture->chunks[chunk];
          if (state.part == Part::none || shared.made != updates) continue;
          visit(StreamId{volume->id, texture->id, chunk}, state.part, shared);
        }
      }
    }
  };
  std::size_t packets = 0;
  for_each_join([&](StreamId, Part, const ChunkStream& shared) {
    packets += std::max<std::size_t>(shared.packets.size(), 1);
  });
  const Status room = guarded([&]() -> Status {
    client.out.reserve(packets);
    return Status::ok;
  });
  for_each_join([&](StreamId id, Part& part, ChunkStream& shared) {
    if (room != Status::ok) {
      if (shared.packets.empty() || std::exchange(part, Part::waiting) == Part::waiting) return;
      ++shared.waiting;
      return;
    }
    const bool late = part == Part::waiting && shared.snapshot.packet != nullptr;
    if (part == Part::waiting) {
      if (!late && !shared.keyframe) return;
      part = Part::joined;
      --shared.waiting;
    }
    for (const SharedPacket& one : late ? std::span(&shared.snapshot, 1) : shared.packets) {
      client.out.push_back({id, one.probes, one.packet});
    }
  });
  return room;
}

/// Subscribes to the chunks of which the client sees a probe, and to no others.
void Server::State::set_joins(ServedClient& client, ServedVolume& volume) noexcept {
  const ProbeMask& visible = client.visible[volume.id];
  auto join = client.joins[volume.id].begin();
  for (std::uint32_t chunk = 0; chunk < volume.chunks.chunks(); ++chunk) {
    const bool wanted = !client.suspended && !visible.empty() &&
                        std::ranges::any_of(volume.chunk_probes[chunk], [&](std::uint32_t probe) {
                          return visible[probe] != 0;
                        });
    for (const auto& texture : volume.textures) {
      Join& state = *join++;
      if (wanted == (state.part != Part::none)) continue;
      ChunkStream& shared = texture->chunks[chunk];
      if (wanted) {
        state.part = part_of(shared.stream, state.sequence, state.checksum);
        ++shared.subscribers;
        if (state.part == Part::waiting) ++shared.waiting;
        continue;
      }
      --shared.subscribers;
      if (std::exchange(state.part, Part::none) == Part::waiting) {
        --shared.waiting;
      } else {
        state.sequence = shared.stream.sequence();
        state.checksum = shared.stream.checksum();
      }
    }
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

Status Server::State::resume_chunk(ServedClient& client, StreamId id, std::uint32_t sequence,
                                   std::uint32_t checksum) {
  const auto [join, shared] = find_chunk(client, id);
  if (join == nullptr) return Status::invalid_argument;
  join->sequence = sequence;
  join->checksum = checksum;
  if (join->part == Part::none) return Status::ok;
  const Part wanted = part_of(shared->stream, sequence, checksum);
  if (wanted == join->part) return Status::ok;
  shared->waiting += wanted == Part::waiting ? 1 : -1;
  join->part = wanted;
  return Status::ok;
}

}  // namespace gicodec
