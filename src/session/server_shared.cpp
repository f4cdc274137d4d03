// Packets of chunks, made once for all who subscribe. A client that comes later gets a snapshot and
// then the same packets as everybody.
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

  std::vector<std::uint32_t> probes;
  for (std::uint32_t probe = 0; probe < shared.stream.probes(); ++probe) {
    if (!volume.is_active(shared.stream.source(probe))) continue;
    if (texture.outdated(shared.stream, probe)) probes.push_back(probe);
  }
  if (!probes.empty() || shared.stream.keyframe_next()) {
    std::vector<WrittenPacket> written;
    const Status status = shared.stream.write(*with.encoder, probes, with.scratch, written);
    if (status != Status::ok) return status;
    for (WrittenPacket& one : written) {
      shared.stream.commit(one);
      shared.packets.push_back({std::make_shared<const Packet>(std::move(one.packet)),
                                static_cast<std::uint32_t>(one.probes.size())});
    }
  }
  if (shared.waiting > 0 && shared.waiting < shared.subscribers) {
    Packet packet;
    const Status status = shared.stream.snapshot(*with.encoder, with.scratch, packet);
    if (status != Status::ok) return status;
    shared.snapshot = {std::make_shared<const Packet>(std::move(packet)), shared.stream.probes()};
  }
  return Status::ok;
}

/// After all chunks are made: one thread.
void Server::State::hand_out_chunks(ServedClient& client) {
  for (const auto& volume : volumes) {
    auto join = client.joins[volume->id].begin();
    for (std::uint32_t chunk = 0; chunk < volume->chunks.chunks(); ++chunk) {
      for (const auto& texture : volume->textures) {
        Part& part = (join++)->part;
        ChunkStream& shared = texture->chunks[chunk];
        if (part == Part::none || !texture->due(updates)) continue;
        const bool late = part == Part::waiting && shared.snapshot.packet != nullptr;
        if (std::exchange(part, Part::joined) == Part::waiting) --shared.waiting;
        const auto packets = late ? std::span(&shared.snapshot, 1) : std::span(shared.packets);
        for (const SharedPacket& one : packets) {
          client.out.push_back({{volume->id, texture->id, chunk}, one.probes, one.packet});
        }
      }
    }
  }
}

/// Subscribes to the chunks of which the client sees a probe, and to no others.
void Server::State::set_joins(ServedClient& client, ServedVolume& volume) {
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
