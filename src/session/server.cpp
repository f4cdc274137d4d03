#include <gicodec/server.h>

#include "base/guard.h"
#include "base/parallel.h"
#include "session/block_difference.h"
#include "session/server_state.h"
#include "stream/find_backend.h"

#include <algorithm>
#include <array>
#include <utility>

namespace gicodec {
namespace {

constexpr unsigned kMaxThreads = 256;
constexpr std::size_t kMaxVolumes = 1024;
constexpr std::size_t kMaxTextures = 255;

}  // namespace

bool ServedTexture::outdated(const UpdateStream& stream, std::uint32_t probe) const noexcept {
  if (!stream.differs(probe)) return false;
  if (stream.moved(probe)) return true;
  const BlockId held = stream.sent(probe), now = history.current()[stream.source(probe)];
  // A guard band that is or was stale counts as a change of its own.
  if (!history.stale_ring(held).empty() || !history.stale_ring(now).empty()) return true;
  if (history.same_core(held, now)) return false;
  const float threshold = options.threshold;
  return !(threshold > 0) ||
         differs_by_more(stream.desc(), history.core(held), history.core(now), threshold);
}

Result<StreamWorker*> Server::State::worker(unsigned thread, const TextureDesc& desc) {
  auto& of_thread = workers[thread];
  const auto same = [&](const auto& entry) { return entry->scratch.desc() == desc; };
  if (const auto it = std::ranges::find_if(of_thread, same); it != of_thread.end()) {
    return it->get();
  }
  auto encoder = backend->make_encoder(desc, options.settings);
  if (!encoder) return encoder.status();
  of_thread.push_back(std::make_unique<StreamWorker>(desc, *std::move(encoder)));
  return of_thread.back().get();
}

Server::Server(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
Server::Server(Server&&) noexcept = default;
Server& Server::operator=(Server&&) noexcept = default;
Server::~Server() = default;

Result<Server> Server::create(const ServerOptions& options) {
  return guarded([&]() -> Result<Server> {
    const auto in_range = [](std::uint32_t side) { return side >= 1 && side <= kMaxGridSide; };
    if (options.threads < 1 || options.threads > kMaxThreads || !in_range(options.chunk.x) ||
        !in_range(options.chunk.y) || !in_range(options.chunk.z) ||
        !is_supported(options.settings.isa)) {
      return Status::invalid_argument;
    }
    auto state = std::make_unique<State>();
    state->options = options;
    state->backend = find_backend(options.backends, [&](const Backend& candidate) {
      return candidate.name() == options.backend;
    });
    if (state->backend == nullptr) return Status::unknown_backend;
    state->workers.resize(options.threads);
    return Server(std::move(state));
  });
}

Result<std::uint16_t> Server::add_volume(const VolumeGeometry& geometry,
                                         std::span<const StreamedTexture> textures) {
  return guarded([&]() -> Result<std::uint16_t> {
    if (const Status status = validate(geometry); status != Status::ok) return status;
    if (textures.empty() || textures.size() > kMaxTextures) return Status::invalid_argument;
    if (state_->volumes.size() >= kMaxVolumes) return Status::limit_exceeded;
    const auto id = static_cast<std::uint16_t>(state_->volumes.size());
    auto volume = std::make_unique<ServedVolume>(
        ServedVolume{id, geometry, {}, ChunkGrid(geometry.grid, state_->options.chunk), {}, {}});
    for (std::uint32_t chunk = 0; chunk < volume->chunks.chunks(); ++chunk) {
      volume->chunk_probes.push_back(volume->chunks.probes_of(chunk));
    }
    bool remembers = false;
    for (const StreamedTexture& texture : textures) {
      if (const Status status = validate(texture.desc); status != Status::ok) return status;
      if (!(texture.desc.grid == geometry.grid) || texture.interval == 0 ||
          !(texture.threshold >= 0)) {
        return Status::invalid_argument;
      }
      auto encoder = state_->backend->make_encoder(texture.desc, state_->options.settings);
      if (!encoder) return encoder.status();
      // What clients hold is known only if they hold what was published.
      if ((*encoder)->lossy()) return Status::unsupported_backend;
      if ((*encoder)->remembers() && state_->any_shared()) return Status::unsupported_backend;
      remembers = (*encoder)->remembers();
      const auto texture_id = static_cast<std::uint8_t>(volume->textures.size());
      auto served =
          std::make_unique<ServedTexture>(texture, texture_id, state_->options.settings.isa);
      for (std::uint32_t chunk = 0; chunk < volume->chunks.chunks(); ++chunk) {
        TextureDesc desc = texture.desc;
        desc.grid = volume->chunks.grid_of(chunk);
        served->chunks.emplace_back(UpdateStream(served->history, desc, volume->chunk_probes[chunk],
                                                 PacketChain{state_->backend->id(), texture_id},
                                                 0));
      }
      volume->textures.push_back(std::move(served));
    }
    state_->volumes.push_back(std::move(volume));
    const bool remembered = std::exchange(state_->remembers, remembers);
    const Status status = guarded([&]() -> Status {
      for (auto& [client_id, client] : state_->clients) {
        const Status added = state_->add_volume_to(*client, *state_->volumes.back());
        if (added != Status::ok) return added;
      }
      return Status::ok;
    });
    if (status != Status::ok) {
      for (auto& [client_id, client] : state_->clients) state_->drop_last_volume_of(*client);
      state_->volumes.pop_back();
      state_->remembers = remembered;
      return status;
    }
    return id;
  });
}

Status Server::publish(std::uint16_t volume, std::uint8_t texture, ConstTextureView view) {
  if (volume >= state_->volumes.size() || texture >= state_->volumes[volume]->textures.size()) {
    return Status::invalid_argument;
  }
  BlockHistory& history = state_->volumes[volume]->textures[texture]->history;
  const auto checked = check_view(history.desc(), view);
  if (!checked) return checked.status();
  return guarded([&]() -> Status {
    history.publish(*checked);
    return Status::ok;
  });
}

Status Server::scroll(std::uint16_t volume, const Scroll& scroll) {
  if (volume >= state_->volumes.size()) return Status::invalid_argument;
  ServedVolume& served = *state_->volumes[volume];
  VolumeGeometry moved = served.geometry;
  moved.scroll = scroll;
  if (const Status status = validate(moved); status != Status::ok) return status;
  if (moved == served.geometry) return Status::ok;
  if (state_->remembers) return Status::unsupported_backend;
  return guarded([&]() -> Status {
    const auto probes = entering_probes(moved.grid, served.geometry.scroll, scroll);
    std::vector<std::vector<std::uint32_t>> by_chunk(served.chunks.chunks());
    for (std::uint32_t chunk = 0; chunk < by_chunk.size(); ++chunk) {
      const auto& of_chunk = served.chunk_probes[chunk];
      for (std::uint32_t i = 0; i < of_chunk.size(); ++i) {
        if (std::ranges::binary_search(probes, of_chunk[i])) by_chunk[chunk].push_back(i);
      }
    }
    // From here on nothing can fail.
    served.geometry = moved;
    for (const auto& texture : served.textures) {
      for (std::uint32_t chunk = 0; chunk < by_chunk.size(); ++chunk) {
        ChunkStream& shared = texture->chunks[chunk];
        shared.stream.set_moved(by_chunk[chunk]);
        for (Behind& behind : shared.behind) behind.state.set_moved(by_chunk[chunk]);
      }
    }
    for (const auto& [id, client] : state_->clients) {
      for (OwnStream& own : client->own) {
        if (own.volume == &served) own.stream.set_moved(probes);
      }
    }
    return Status::ok;
  });
}

Status Server::set_active(std::uint16_t volume, std::span<const std::uint8_t> active) {
  if (volume >= state_->volumes.size()) return Status::invalid_argument;
  ServedVolume& served = *state_->volumes[volume];
  if (!active.empty() && active.size() != probe_count(served.textures[0]->options.desc)) {
    return Status::invalid_argument;
  }
  return guarded([&]() -> Status {
    served.active.assign(active.begin(), active.end());
    return Status::ok;
  });
}

Status Server::update() {
  struct Job {
    ServedClient* client;  ///< or, if null, a chunk
    ServedVolume* volume;
    ServedTexture* texture;
    std::uint32_t chunk;
  };
  return guarded([&]() -> Status {
    State& state = *state_;
    std::vector<Job> jobs;
    for (const auto& [id, client] : state.clients) {
      if (client->suspended || client->delivery != Delivery::own) continue;
      jobs.push_back({client.get(), nullptr, nullptr, 0});
    }
    for (const auto& volume : state.volumes) {
      for (const auto& texture : volume->textures) {
        for (std::uint32_t chunk = 0; chunk < texture->chunks.size(); ++chunk) {
          jobs.push_back({nullptr, volume.get(), texture.get(), chunk});
        }
      }
    }
    std::vector<Status> results(jobs.size(), Status::ok);
    // From here on there is an update. Who cannot be served stays as he is, and is owed what
    // changed.
    ++state.updates;
    for (const auto& [id, client] : state.clients) {
      client->out.clear();
      client->held_back = false;
      client->written = 0;
    }
    state.gather_audiences();
    state.allot_extras();
    const Status made = guarded([&]() -> Status {
      for_each_item(state.options.threads, jobs.size(), [&](unsigned thread, std::size_t i) {
        const Job& job = jobs[i];
        results[i] = guarded([&]() -> Status {
          return job.client != nullptr
                     ? state.update_own(*job.client, thread)
                     : state.update_chunk(*job.volume, *job.texture, job.chunk, thread);
        });
      });
      return Status::ok;
    });
    Status first = made;
    const auto note = [&first](Status status) {
      if (first == Status::ok) first = status;
    };
    for (const Status result : results) note(result);
    for (const auto& [id, client] : state.clients) {
      if (client->delivery == Delivery::shared) note(state.hand_out_chunks(*client));
      for (const OutgoingPacket& packet : client->out) {
        client->totals.bytes_sent += packet.packet->size();
        client->totals.probes_sent += packet.probes;
        ++client->totals.packets_sent;
      }
    }
    state.forget_behind();
    return first;
  });
}

const ServerOptions& Server::options() const noexcept { return state_->options; }
std::uint64_t Server::updates() const noexcept { return state_->updates; }
void Server::set_extra_probes(std::uint32_t probes) noexcept { state_->extra_probes = probes; }

std::uint64_t Server::written() const noexcept {
  std::uint64_t probes = 0;
  for (const auto& [id, client] : state_->clients) probes += client->written;
  for (const auto& volume : state_->volumes) {
    for (const auto& texture : volume->textures) {
      for (const ChunkStream& chunk : texture->chunks) probes += chunk.written;
    }
  }
  return probes;
}

std::size_t Server::memory() const noexcept {
  std::size_t bytes = 0;
  for (const auto& volume : state_->volumes) {
    for (const auto& texture : volume->textures) {
      bytes += texture->history.memory();
      for (const ChunkStream& chunk : texture->chunks) {
        bytes += chunk.stream.memory();
        for (const Behind& behind : chunk.behind) bytes += sizeof behind + behind.state.memory();
      }
    }
  }
  for (const auto& of_thread : state_->workers) {
    for (const auto& worker : of_thread) bytes += worker->scratch.memory();
  }
  return bytes;
}

}  // namespace gicodec
