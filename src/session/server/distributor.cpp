// The calls of a Distributor: publish() takes contents, update() makes packets of what changed.
#include "session/server/distributor.h"

#include "backend/find_backend.h"
#include "base/guard.h"
#include "base/parallel.h"
#include "quantise/block_difference.h"
#include "session/server/distributor_state.h"
#include "texture/presence.h"

#include <gicodec/probes.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace gicodec {

bool ServedTexture::outdated(const UpdateStream& stream, std::uint32_t block) const noexcept {
  if (!stream.differs(block)) return false;
  const BlockId held = stream.sent(block), now = stream.current(block);
  if (stream.moved(block) || held == kNothing) return true;
  const float threshold = rule == Threshold::exact ? 0 : options.threshold;
  const bool same = history.same_records(held, now);
  if (!same && !(threshold > 0)) return true;
  // Stale guard bands, or another presence, count as changes whatever the threshold.
  const auto exists = history.presence(now), existed = history.presence(held);
  if (!history.stale_band(held).empty() || !history.stale_band(now).empty() ||
      !std::equal(exists.begin(), exists.end(), existed.begin())) {
    return true;
  }
  return !same &&
         differs_by_more(stream.desc(), history.records(now), history.records(held), threshold);
}

bool Bundle::outdated(std::span<const UpdateStream> streams, std::uint32_t block) const noexcept {
  const std::uint32_t source = streams[0].volume_block(block);
  if (std::any_of(textures.begin(), textures.end(),
                  [source](const auto& texture) { return texture->waits(source); })) {
    return false;
  }
  for (std::size_t i = 0; i < textures.size(); ++i) {
    if (textures[i]->outdated(streams[i], block)) return true;
  }
  return false;
}

Result<BackendEncoder*> Distributor::State::encoder(unsigned thread, const ServedTexture& texture,
                                                    const UpdateStream& stream, BackendEncoder* own,
                                                    std::size_t preset) {
  if (own != nullptr) return own;
  const ServedTexture* const of = texture.options.own_backend ? &texture : nullptr;
  auto& encoders = workers[thread].encoders;
  auto found = std::find_if(encoders.begin(), encoders.end(), [&](const auto& one) {
    return one.texture == of && one.desc == stream.desc();
  });
  if (found == encoders.end()) {
    auto made = texture.options.backend->make_encoder(stream.desc(), texture.options.settings);
    if (!made) return made.status();
    found = encoders.insert(encoders.end(), {of, stream.desc(), *std::move(made)});
  }
  if (texture.options.chooses_preset) {
    const Status status = found->encoder->set_preset(kPresets[preset]);
    if (status != Status::ok) return status;
  }
  return found->encoder.get();
}

/// Makes an encoder for each stream of a stateful texture; null for others.
Status Distributor::State::make_encoders(const Bundle& bundle,
                                         std::span<const UpdateStream> streams,
                                         std::vector<std::unique_ptr<BackendEncoder>>& out) const {
  std::vector<std::unique_ptr<BackendEncoder>> encoders(streams.size());
  for (std::size_t i = 0; i < streams.size(); ++i) {
    const ServedTexture& texture = *bundle.textures[i];
    if (!texture.options.is_stateful) continue;
    auto made = texture.options.backend->make_encoder(streams[i].desc(), texture.options.settings);
    if (!made) return made.status();
    encoders[i] = *std::move(made);
  }
  out = std::move(encoders);
  return Status::ok;
}

Distributor::Distributor(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
Distributor::Distributor(Distributor&&) noexcept = default;
Distributor& Distributor::operator=(Distributor&&) noexcept = default;
Distributor::~Distributor() = default;

Result<Distributor> Distributor::create(const DistributorOptions& options) {
  return guarded([&]() -> Result<Distributor> {
    const auto in_range = [](std::uint32_t side) { return side >= 1 && side <= kMaxGridSide; };
    const Grid& region = options.region;
    const bool cut =
        region == Grid{} || (in_range(region.x) && in_range(region.y) && in_range(region.z));
    if (!is_valid(options.threads) || !is_supported(options.settings.isa)) {
      return Status::invalid_settings;
    }
    if (!cut) return Status::invalid_argument;
    auto state = std::make_unique<State>();
    state->options = options;
    state->backend = find_backend(options.backends, options.backend);
    if (state->backend == nullptr) return Status::unknown_backend;
    // Settings that no texture takes are said here, not by every add_volume().
    const TextureDesc usual = ddgi_irradiance({1, 1, 1}, Format::A2B10G10R10_UNORM_PACK32);
    const auto encoder = state->backend->make_encoder(usual, options.settings);
    if (!encoder && (encoder.status() == Status::invalid_settings ||
                     encoder.status() == Status::out_of_memory)) {
      return encoder.status();
    }
    state->workers.resize(options.threads.count);
    return Distributor(std::move(state));
  });
}

TexturePlace Distributor::State::find(std::uint16_t volume, std::uint8_t texture) const noexcept {
  if (volume >= volumes.size()) return {};
  const auto& bundles = volumes[volume]->bundles;
  for (std::size_t bundle = 0; bundle < bundles.size(); ++bundle) {
    const std::uint8_t first = bundles[bundle]->textures[0]->id;
    if (texture >= first && texture < first + bundles[bundle]->textures.size()) {
      return {bundles[bundle].get(), bundle, static_cast<std::size_t>(texture - first)};
    }
  }
  return {};
}

Status Distributor::publish(std::uint16_t volume, std::uint8_t texture, ConstTextureView view) {
  return guarded([&]() -> Status {
    const TexturePlace at = state_->find(volume, texture);
    auto& all = state_->reading.all;
    all.resize(at.bundle == nullptr ? 0 : block_count(at.bundle->desc()));
    std::iota(all.begin(), all.end(), 0U);
    return publish(volume, texture, view, all);
  });
}

/// Lists the blocks to read, ascending: `listed`, and the unread ones.
Status Reading::choose(const BlockMask& unread, std::span<const std::uint32_t> listed) {
  read = unread;
  seen.assign(unread.size(), 0);
  blocks.clear();
  for (const std::uint32_t block : listed) {
    if (block >= read.size()) return Status::block_out_of_range;
    if (seen[block] != 0) return Status::block_repeated;
    read[block] = seen[block] = 1;
  }
  for (std::uint32_t block = 0; block < read.size(); ++block) {
    if (read[block] != 0) blocks.push_back(block);
  }
  return Status::ok;
}

Status Distributor::publish(std::uint16_t volume, std::uint8_t texture, ConstTextureView view,
                            std::span<const std::uint32_t> listed) {
  if (state_->find_volume(volume) == nullptr) return Status::unknown_volume;
  const TexturePlace at = state_->find(volume, texture);
  if (at.bundle == nullptr) return Status::unknown_texture;
  ServedTexture& served = *at.bundle->textures[at.place];
  BlockHistory& history = served.history;
  const auto checked = check_view(history.desc(), view);
  if (!checked) return checked.status();
  return guarded([&]() -> Status {
    auto& [all, blocks, read, seen, presence, before] = state_->reading;
    const Status chosen = state_->reading.choose(served.unread, listed);
    if (chosen != Status::ok) return chosen;
    presence.clear();
    if (history.desc().presence != Presence::all) {
      const BlockHistory& existing = at.bundle->textures[0]->history;
      for (const BlockId id : existing.current()) {
        const auto records = existing.records(id);
        presence.insert(presence.end(), records.begin(), records.end());
      }
      if (!is_sound(history.desc(), presence)) return Status::presence_invalid;
    }
    ServedVolume& of = *state_->volumes[volume];
    const bool is_presence = at.bundle->group->presence == at.place;
    before.clear();
    if (of.linked || is_presence) before.assign(history.current().begin(), history.current().end());
    if (of.linked) {
      const std::size_t ids = 1 + std::size_t{*std::max_element(before.begin(), before.end())};
      served.last_current.resize(std::max(served.last_current.size(), ids));
    }
    history.publish(*checked, blocks, presence);
    // From here on nothing can fail.
    const std::size_t records = blocks.size() * block_bytes(history.desc());
    state_->published_seconds += static_cast<double>(records) * PresetCosts::kPublished;
    for (std::uint32_t block = 0; block < before.size(); ++block) {
      if (history.current()[block] == before[block]) continue;
      if (of.linked) of.note_change(*at.bundle, served, block, before[block], state_->updates);
      for (const auto& other : at.bundle->textures) {
        if (is_presence && other->history.desc().presence != Presence::all)
          other->unread[block] = 1;
      }
    }
    served.published = true;
    served.presence_changed = false;
    for (const std::uint32_t block : blocks) served.unread[block] = 0;
    for (const auto& other : at.bundle->textures) {
      if (is_presence && other->history.desc().presence != Presence::all)
        other->presence_changed = true;
    }
    return Status::ok;
  });
}

Status Distributor::update() {
  struct Job {
    ServedClient* client;  ///< null: the job is a region
    ServedVolume* volume;
    Bundle* bundle;
    std::uint32_t region;
  };
  return guarded([&]() -> Status {
    State& state = *state_;
    for (const auto& [id, client] : state.clients) {
      client->out.clear();
      client->held_back = false;
      client->written = client->examined = 0;
    }
    state.choose_presets();
    Status first = Status::ok;
    const auto note = [&first](Status status) {
      if (first == Status::ok) first = status;
    };
    std::vector<Job> jobs;
    for (const auto& [id, client] : state.clients) {
      if (client->suspended || client->delivery != Delivery::unicast) continue;
      jobs.push_back({client.get(), nullptr, nullptr, 0});
    }
    for (const auto& volume : state.volumes) {
      for (const auto& bundle : volume->bundles) {
        for (const auto& texture : bundle->textures) {
          if (texture->presence_changed) note(Status::presence_missing);
        }
        for (std::uint32_t region = 0; region < bundle->regions.size(); ++region) {
          jobs.push_back({nullptr, volume.get(), bundle.get(), region});
        }
      }
    }
    state.refresh_dependencies();
    state.refresh_interest();
    std::vector<Status> results(jobs.size(), Status::ok);
    // From here on there is an update. Clients that cannot be served hold what they held; their
    // blocks stay pending.
    ++state.updates;
    for (const auto& volume : state.volumes) volume->choose_due(state.updates);
    state.gather_subscribers();
    state.allot_catch_ups();
    note(guarded([&]() -> Status {
      for_each_item(state.options.threads, jobs.size(), [&](unsigned thread, std::size_t i) {
        const Job& job = jobs[i];
        results[i] = guarded([&]() -> Status {
          return job.client != nullptr
                     ? state.update_unicast(*job.client, thread)
                     : state.update_region(*job.volume, *job.bundle, job.region, thread);
        });
      });
      return Status::ok;
    }));
    for (const Status result : results) note(result);
    for (const auto& [id, client] : state.clients) {
      if (client->delivery == Delivery::shared) note(state.hand_out_regions(*client));
      for (const OutgoingPacket& packet : client->out) {
        client->totals.bytes_sent += packet.packet->size();
        client->totals.blocks_sent += packet.blocks;
        ++client->totals.packets_sent;
      }
    }
    state.forget_subscribers();
    return first;
  });
}

const DistributorOptions& Distributor::options() const noexcept { return state_->options; }
std::uint64_t Distributor::updates() const noexcept { return state_->updates; }
void Distributor::set_limit_for_few(std::uint32_t blocks) noexcept {
  state_->limit_for_few = blocks;
}

WrittenBlocks Distributor::written() const noexcept {
  WrittenBlocks blocks;
  for (const auto& [id, client] : state_->clients) {
    blocks.for_few += client->written;
    blocks.examined += client->examined;
  }
  blocks.all = blocks.for_few;
  state_->for_each_region([&](const ServedVolume&, const Bundle&, const SharedRegion& region) {
    blocks.all += region.written;
    blocks.for_few += region.written_for_few;
  });
  return blocks;
}

std::size_t Distributor::memory() const noexcept {
  std::size_t bytes = 0;
  for (const auto& volume : state_->volumes) {
    for (const auto& bundle : volume->bundles) {
      for (const auto& texture : bundle->textures) {
        bytes +=
            texture->history.memory() + texture->last_current.capacity() * sizeof(std::uint32_t);
      }
    }
    for (const Dependencies& dependencies : volume->dependencies) bytes += dependencies.memory();
  }
  state_->for_each_region([&](const ServedVolume&, const Bundle&, const SharedRegion& region) {
    for (const UpdateStream& stream : region.streams) bytes += stream.memory();
    for (const Lagging& lagging : region.lagging) {
      for (const StreamState& state : lagging.states) bytes += sizeof state + state.memory();
    }
  });
  for (const StreamWorker& worker : state_->workers) {
    bytes += sizeof worker + worker.encoders.capacity() * sizeof worker.encoders[0];
  }
  return bytes;
}

}  // namespace gicodec
