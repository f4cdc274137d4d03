#include "session/server.h"

#include <gicodec/error_bound.h>

#include "backend/find_backend.h"
#include "base/guard.h"
#include "base/parallel.h"
#include "payload/block_difference.h"
#include "session/region_size.h"
#include "session/server_state.h"
#include "texture/presence.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace gicodec {
namespace {

constexpr std::size_t kMaxVolumes = 1024;

}  // namespace

bool ServedTexture::outdated(const UpdateStream& stream, std::uint32_t block) const noexcept {
  if (!stream.differs(block)) return false;
  const BlockId held = stream.sent(block), now = stream.current(block);
  if (stream.moved(block) || held == kNothing) return true;
  const float threshold = rule == Threshold::exact ? 0 : options.threshold;
  const bool same = history.same_records(held, now);
  if (!same && !(threshold > 0)) return true;
  // A guard band that is or was stale, and another presence, count as changes of their own.
  const auto exists = history.presence(now), existed = history.presence(held);
  if (!history.stale_band(held).empty() || !history.stale_band(now).empty() ||
      !std::equal(exists.begin(), exists.end(), existed.begin())) {
    return true;
  }
  return !same &&
         differs_by_more(stream.desc(), history.records(now), history.records(held), threshold);
}

bool Lot::outdated(std::span<const UpdateStream> streams, std::uint32_t block) const noexcept {
  const std::uint32_t source = streams[0].source(block);
  if (std::any_of(textures.begin(), textures.end(),
                  [source](const auto& texture) { return texture->waits(source); })) {
    return false;
  }
  for (std::size_t i = 0; i < textures.size(); ++i) {
    if (textures[i]->outdated(streams[i], block)) return true;
  }
  return false;
}

Result<StreamWorker*> Server::State::worker(unsigned thread, const TextureDesc& desc) {
  auto& of_thread = workers[thread];
  for (const auto& known : of_thread) {
    if (known->desc == desc) return known.get();
  }
  auto encoder = backend->make_encoder(desc, options.settings);
  if (!encoder) return encoder.status();
  of_thread.push_back(std::make_unique<StreamWorker>(StreamWorker{desc, *std::move(encoder)}));
  return of_thread.back().get();
}

Server::Server(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
Server::Server(Server&&) noexcept = default;
Server& Server::operator=(Server&&) noexcept = default;
Server::~Server() = default;

Result<Server> Server::create(const ServerOptions& options) {
  return guarded([&]() -> Result<Server> {
    const auto in_range = [](std::uint32_t side) { return side >= 1 && side <= kMaxGridSide; };
    const Grid& region = options.region;
    const bool cut =
        region == Grid{} || (in_range(region.x) && in_range(region.y) && in_range(region.z));
    if (!is_valid(options.threads) || !cut || !is_supported(options.settings.isa)) {
      return Status::invalid_argument;
    }
    auto state = std::make_unique<State>();
    state->options = options;
    state->backend = find_backend(options.backends, options.backend);
    if (state->backend == nullptr) return Status::unknown_backend;
    state->workers.resize(options.threads.count);
    return Server(std::move(state));
  });
}

/// True if all textures of a set that travels together, and of sets that name one another, are sent
/// in the same updates.
static bool in_step(const ServedVolume& volume, const Lot& lot, std::uint32_t interval) noexcept {
  const auto same = [&](const auto& texture) { return texture->options.interval == interval; };
  return std::all_of(volume.lots.begin(), volume.lots.end(), [&](const auto& other) {
    const bool linked = other.get() == &lot || lot.names(*other) ||
                        (other->set == lot.set && lot.set->names != BlockSet::kNone);
    return !linked || std::all_of(other->textures.begin(), other->textures.end(), same);
  });
}

/// Adds a texture of a set to its last lot, or to one of its own.
Status Server::State::add_texture(ServedVolume& volume, std::uint8_t set_id,
                                  const NamedTexture& texture, const StreamedTexture& streamed) {
  auto encoder = backend->make_encoder(texture.desc, options.settings);
  if (!encoder) return encoder.status();
  // What clients hold is known only if they hold what was published.
  if ((*encoder)->lossy()) return Status::unsupported_backend;
  if ((*encoder)->remembers() && any_shared()) return Status::unsupported_backend;
  remembers = (*encoder)->remembers();
  const BlockSet& set = volume.desc.sets[set_id];
  const Lot* const before = volume.lots.empty() ? nullptr : volume.lots.back().get();
  const bool first = before == nullptr || before->set_id != set_id;
  if (first || !set.together) {
    volume.lots.push_back(
        std::make_unique<Lot>(&set, set_id, regions_of(texture.desc, volume.cut_by)));
  }
  Lot& lot = *volume.lots.back();
  StreamedTexture own = streamed;
  // What says which records of others exist is exact.
  const bool exact = texture.threshold == Threshold::exact || (first && set.presence == 0);
  if (exact && valid_error(own.max_error)) own.max_error = 0;
  lot.textures.push_back(std::make_unique<ServedTexture>(texture, own, volume.textures++,
                                                         options.settings.isa, options.threads));
  BlockHistory& history = lot.textures.back()->history;
  lot.first = first ? &history : before->first;
  for (std::uint32_t region = 0; region < lot.cut.regions(); ++region) {
    lot.regions[region].streams.emplace_back(
        history, region_texture(texture.desc, volume.cut_by, region), lot.region_blocks[region],
        PacketChain{backend->id(), lot.textures.back()->id}, 0);
    lot.regions[region].bytes += lot.region_blocks[region].size() * block_bytes(texture.desc);
  }
  if (set.names != BlockSet::kNone) {
    volume.linked = true;
    volume.names.resize(volume.desc.sets.size());
    volume.names[set_id].resize(block_count(texture.desc));
    for (const auto& other : volume.lots) other->named = other->named || lot.names(*other);
  }
  const bool sound = streamed.threshold >= 0 && valid_error(streamed.max_error) &&
                     streamed.source_error >= 0 &&
                     (streamed.threshold == 0 || streamed.max_error == 0);
  if (!sound) return Status::invalid_bound;
  const bool in_time = streamed.interval > 0 && in_step(volume, lot, streamed.interval);
  return in_time ? Status::ok : Status::invalid_interval;
}

Result<std::vector<StreamedTexture>> by_texture(const VolumeDesc& volume,
                                                std::span<const StreamedTexture> textures) {
  std::vector<StreamedTexture> all;
  for (const BlockSet& set : volume.sets) {
    for (const NamedTexture& texture : set.textures) all.emplace_back().texture = texture.name;
  }
  std::vector<bool> known(all.size());
  for (const StreamedTexture& texture : textures) {
    const auto of_name = [&](const StreamedTexture& one) { return one.texture == texture.texture; };
    const auto it = std::find_if(all.begin(), all.end(), of_name);
    if (it == all.end()) return Status::unknown_texture;
    if (known[static_cast<std::size_t>(it - all.begin())]) return Status::invalid_name;
    known[static_cast<std::size_t>(it - all.begin())] = true;
    *it = texture;
  }
  return all;
}

Status Server::State::add_lots(ServedVolume& volume, std::span<const StreamedTexture> streamed) {
  for (std::uint8_t set = 0; set < volume.desc.sets.size(); ++set) {
    for (const NamedTexture& texture : volume.desc.sets[set].textures) {
      const Status status = add_texture(volume, set, texture, streamed[volume.textures]);
      if (status != Status::ok) return status;
    }
  }
  return Status::ok;
}

Result<std::uint16_t> Server::add_volume(const VolumeDesc& desc, const VolumeGeometry& geometry,
                                         std::span<const StreamedTexture> textures) {
  return guarded([&]() -> Result<std::uint16_t> {
    if (const Status status = validate(geometry); status != Status::ok) return status;
    if (const Status status = validate(desc); status != Status::ok) return status;
    if (!(desc.sets[0].textures[0].desc.grid == geometry.grid)) return Status::invalid_geometry;
    const auto streamed = by_texture(desc, textures);
    if (!streamed) return streamed.status();
    State& state = *state_;
    const auto is_free = [](const auto& one) { return one->removed; };
    auto place = std::find_if(state.volumes.begin(), state.volumes.end(), is_free);
    if (place == state.volumes.end()) {
      if (state.volumes.size() >= kMaxVolumes) return Status::limit_exceeded;
      auto room = std::make_unique<ServedVolume>();
      room->removed = true;
      state.volumes.push_back(std::move(room));
      place = state.volumes.end() - 1;
    }
    auto volume = std::make_unique<ServedVolume>();
    const auto id = static_cast<std::uint16_t>(place - state.volumes.begin());
    volume->id = id;
    volume->desc = desc;
    volume->geometry = geometry;
    volume->cut_by = region_for(desc, state.options.region);
    volume->active.resize(desc.sets.size());
    *place = std::move(volume);
    ServedVolume& added = **place;
    const bool remembered = state.remembers;
    const Status status = guarded([&]() -> Status {
      Status one = state.add_lots(added, *streamed);
      for (auto it = state.clients.begin(); one == Status::ok && it != state.clients.end();) {
        one = state.add_volume_to(*(it++)->second, added);
      }
      return one;
    });
    if (status != Status::ok) {
      state.drop_volume(added);
      state.remembers = remembered;
      return status;
    }
    return id;
  });
}

/// What holds its contents goes before them.
void Server::State::drop_volume(ServedVolume& volume) noexcept {
  for (const auto& entry : clients) drop_volume_of(*entry.second, volume);
  volume.lots.clear();
  volume.desc.sets.clear();
  volume.active.clear();
  volume.names.clear();
  volume.linked = false;
  volume.removed = true;
}

Status Server::remove_volume(std::uint16_t volume) {
  ServedVolume* const found = state_->find_volume(volume);
  if (found == nullptr) return Status::unknown_volume;
  state_->drop_volume(*found);
  if (volumes() == 0) state_->remembers = false;
  return Status::ok;
}

TexturePlace Server::State::find(std::uint16_t volume, std::uint8_t texture) const noexcept {
  if (volume >= volumes.size()) return {};
  const auto& lots = volumes[volume]->lots;
  for (std::size_t lot = 0; lot < lots.size(); ++lot) {
    const std::uint8_t first = lots[lot]->textures[0]->id;
    if (texture >= first && texture < first + lots[lot]->textures.size()) {
      return {lots[lot].get(), lot, static_cast<std::size_t>(texture - first)};
    }
  }
  return {};
}

Status Server::publish(std::uint16_t volume, std::uint8_t texture, ConstTextureView view) {
  return guarded([&]() -> Status {
    const TexturePlace at = state_->find(volume, texture);
    auto& all = state_->reading.all;
    all.resize(at.lot == nullptr ? 0 : block_count(at.lot->desc()));
    std::iota(all.begin(), all.end(), 0U);
    return publish(volume, texture, view, all);
  });
}

/// Ascending, with those that are to be read in any case.
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

Status Server::publish(std::uint16_t volume, std::uint8_t texture, ConstTextureView view,
                       std::span<const std::uint32_t> listed) {
  if (state_->find_volume(volume) == nullptr) return Status::unknown_volume;
  const TexturePlace at = state_->find(volume, texture);
  if (at.lot == nullptr) return Status::unknown_texture;
  ServedTexture& served = *at.lot->textures[at.place];
  BlockHistory& history = served.history;
  const auto checked = check_view(history.desc(), view);
  if (!checked) return checked.status();
  return guarded([&]() -> Status {
    auto& [all, blocks, read, seen, presence, before] = state_->reading;
    const Status chosen = state_->reading.choose(served.unread, listed);
    if (chosen != Status::ok) return chosen;
    presence.clear();
    if (history.desc().presence != Presence::all) {
      const BlockHistory& existing = at.lot->textures[0]->history;
      for (const BlockId id : existing.current()) {
        const auto records = existing.records(id);
        presence.insert(presence.end(), records.begin(), records.end());
      }
      if (!is_sound(history.desc(), presence)) return Status::presence_invalid;
    }
    ServedVolume& of = *state_->volumes[volume];
    const bool tells = at.lot->set->presence == at.place;
    before.clear();
    if (of.linked || tells) before.assign(history.current().begin(), history.current().end());
    if (of.linked) {
      const std::size_t ids = 1 + std::size_t{*std::max_element(before.begin(), before.end())};
      served.until.resize(std::max(served.until.size(), ids));
    }
    history.publish(*checked, blocks, presence);
    // From here on nothing can fail.
    for (std::uint32_t block = 0; block < before.size(); ++block) {
      if (history.current()[block] == before[block]) continue;
      if (of.linked) of.note_change(*at.lot, served, block, before[block], state_->updates);
      for (const auto& other : at.lot->textures) {
        if (tells && other->history.desc().presence != Presence::all) other->unread[block] = 1;
      }
    }
    served.published = true;
    served.presence_changed = false;
    for (const std::uint32_t block : blocks) served.unread[block] = 0;
    for (const auto& other : at.lot->textures) {
      if (tells && other->history.desc().presence != Presence::all) other->presence_changed = true;
    }
    return Status::ok;
  });
}

Status Server::scroll(std::uint16_t volume, const Scroll& scroll) {
  ServedVolume* const found = state_->find_volume(volume);
  if (found == nullptr) return Status::unknown_volume;
  ServedVolume& served = *found;
  VolumeGeometry moved = served.geometry;
  moved.scroll = scroll;
  if (const Status status = validate(moved); status != Status::ok) return status;
  if (moved == served.geometry) return Status::ok;
  if (state_->remembers) return Status::unsupported_backend;
  return guarded([&]() -> Status {
    const auto blocks = entering_blocks(moved.grid, served.geometry.scroll, scroll);
    const auto scrolls = [&](const Lot& lot) {
      return lot.desc().space == Space::grid && lot.desc().grid == moved.grid;
    };
    std::vector<std::pair<SharedRegion*, std::vector<std::uint32_t>>> entering;
    for (const auto& lot : served.lots) {
      if (!scrolls(*lot)) continue;
      for (std::uint32_t region = 0; region < lot->regions.size(); ++region) {
        std::vector<std::uint32_t> in_region;
        for (std::uint32_t i = 0; i < lot->region_blocks[region].size(); ++i) {
          const std::uint32_t block = lot->region_blocks[region][i];
          if (std::binary_search(blocks.begin(), blocks.end(), block)) in_region.push_back(i);
        }
        entering.emplace_back(&lot->regions[region], std::move(in_region));
      }
    }
    // From here on nothing can fail.
    served.geometry = moved;
    for (const auto& lot : served.lots) {
      if (!scrolls(*lot)) continue;
      lot->forget_held();
      for (const auto& texture : lot->textures) {
        for (const std::uint32_t block : blocks) texture->unread[block] = 1;
      }
    }
    for (const auto& [shared, places] : entering) {
      for (UpdateStream& stream : shared->streams) stream.set_moved(places);
      for (Behind& behind : shared->behind) {
        for (StreamState& state : behind.states) state.set_moved(places);
      }
    }
    for (const auto& [id, client] : state_->clients) {
      for (OwnLot& own : client->own) {
        if (own.volume != &served || !scrolls(*own.lot)) continue;
        for (UpdateStream& stream : own.streams) stream.set_moved(blocks);
      }
    }
    return Status::ok;
  });
}

std::size_t Server::volumes() const noexcept {
  return static_cast<std::size_t>(std::count_if(state_->volumes.begin(), state_->volumes.end(),
                                                [](const auto& one) { return !one->removed; }));
}

Result<VolumeGeometry> Server::geometry(std::uint16_t volume) const noexcept {
  const ServedVolume* const found = state_->find_volume(volume);
  if (found == nullptr) return Status::unknown_volume;
  return found->geometry;
}

Status Server::State::check_mask(std::uint16_t volume, std::uint8_t set,
                                 std::span<const std::uint8_t> mask) const noexcept {
  if (find_volume(volume) == nullptr) return Status::unknown_volume;
  const auto& sets = volumes[volume]->desc.sets;
  if (set >= sets.size()) return Status::unknown_set;
  const bool fits = mask.empty() || mask.size() == block_count(sets[set].textures[0].desc);
  return fits ? Status::ok : Status::mask_mismatch;
}

Status Server::set_active(std::uint16_t volume, std::span<const std::uint8_t> active,
                          std::uint8_t set) {
  const Status fits = state_->check_mask(volume, set, active);
  if (fits != Status::ok) return fits;
  ServedVolume& served = *state_->volumes[volume];
  return guarded([&]() -> Status {
    served.active[set].assign(active.begin(), active.end());
    state_->forget_wanted(served);
    for (const auto& lot : served.lots) {
      if (lot->set_id == set) lot->forget_held();
    }
    return Status::ok;
  });
}

Status Server::update() {
  struct Job {
    ServedClient* client;  ///< or, if null, a region
    ServedVolume* volume;
    Lot* lot;
    std::uint32_t region;
  };
  return guarded([&]() -> Status {
    State& state = *state_;
    for (const auto& [id, client] : state.clients) {
      client->out.clear();
      client->held_back = false;
      client->written = 0;
    }
    Status first = Status::ok;
    const auto note = [&first](Status status) {
      if (first == Status::ok) first = status;
    };
    std::vector<Job> jobs;
    for (const auto& [id, client] : state.clients) {
      if (client->suspended || client->delivery != Delivery::own) continue;
      jobs.push_back({client.get(), nullptr, nullptr, 0});
    }
    for (const auto& volume : state.volumes) {
      for (const auto& lot : volume->lots) {
        for (const auto& texture : lot->textures) {
          if (texture->presence_changed) note(Status::presence_missing);
        }
        for (std::uint32_t region = 0; region < lot->regions.size(); ++region) {
          jobs.push_back({nullptr, volume.get(), lot.get(), region});
        }
      }
    }
    state.refresh_names();
    state.refresh_wanted();
    std::vector<Status> results(jobs.size(), Status::ok);
    // From here on there is an update. Who cannot be served stays as he is, and is owed what
    // changed.
    ++state.updates;
    for (const auto& volume : state.volumes) volume->choose_due(state.updates);
    state.gather_audiences();
    state.allot_extras();
    note(guarded([&]() -> Status {
      for_each_item(state.options.threads, jobs.size(), [&](unsigned thread, std::size_t i) {
        const Job& job = jobs[i];
        results[i] = guarded([&]() -> Status {
          return job.client != nullptr
                     ? state.update_own(*job.client, thread)
                     : state.update_region(*job.volume, *job.lot, job.region, thread);
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
    state.forget_audiences();
    return first;
  });
}

const ServerOptions& Server::options() const noexcept { return state_->options; }
std::uint64_t Server::updates() const noexcept { return state_->updates; }
void Server::set_extra_blocks(std::uint32_t blocks) noexcept { state_->extra_blocks = blocks; }

WrittenBlocks Server::written() const noexcept {
  WrittenBlocks blocks;
  for (const auto& [id, client] : state_->clients) blocks.for_few += client->written;
  blocks.all = blocks.for_few;
  state_->for_each_region([&](const ServedVolume&, const Lot&, const SharedRegion& region) {
    blocks.all += region.written;
    blocks.for_few += region.extra;
  });
  return blocks;
}

std::size_t Server::memory() const noexcept {
  std::size_t bytes = 0;
  for (const auto& volume : state_->volumes) {
    for (const auto& lot : volume->lots) {
      for (const auto& texture : lot->textures) {
        bytes += texture->history.memory() + texture->until.capacity() * sizeof(std::uint32_t);
      }
    }
    for (const Names& names : volume->names) bytes += names.memory();
  }
  state_->for_each_region([&](const ServedVolume&, const Lot&, const SharedRegion& region) {
    for (const UpdateStream& stream : region.streams) bytes += stream.memory();
    for (const Behind& behind : region.behind) {
      for (const StreamState& state : behind.states) bytes += sizeof state + state.memory();
    }
  });
  for (const auto& of_thread : state_->workers) {
    for (const auto& worker : of_thread) bytes += sizeof *worker;
  }
  return bytes;
}

}  // namespace gicodec
