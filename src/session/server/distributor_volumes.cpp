// The volumes of a Distributor: their textures and options, geometry, and active blocks.
#include <gicodec/error_bound.h>

#include "backend/find_backend.h"
#include "base/guard.h"
#include "session/server/distributor_state.h"
#include "session/server/region_size.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace gicodec {

constexpr float kUnknownError = std::numeric_limits<float>::infinity();

/// True if all textures of a bundled group, and of groups that depend on one another, are sent in
/// the same updates.
static bool in_step(const ServedVolume& volume, const Bundle& bundle,
                    std::uint32_t interval) noexcept {
  const auto same = [&](const auto& texture) { return texture->options.interval == interval; };
  return std::all_of(volume.bundles.begin(), volume.bundles.end(), [&](const auto& other) {
    const bool linked =
        other.get() == &bundle || bundle.depends_on(*other) ||
        (other->group == bundle.group && bundle.group->depends_on != TextureGroup::kNone);
    return !linked || std::all_of(other->textures.begin(), other->textures.end(), same);
  });
}

bool ServedVolume::is_stateful() const noexcept {
  return std::any_of(bundles.begin(), bundles.end(),
                     [](const auto& bundle) { return bundle->is_stateful; });
}

bool ServedVolume::is_lossy() const noexcept {
  return std::any_of(bundles.begin(), bundles.end(), [](const auto& bundle) {
    return std::any_of(bundle->textures.begin(), bundle->textures.end(),
                       [](const auto& texture) { return texture->options.is_lossy; });
  });
}

/// Adds a texture of a group to its last bundle, or to one of its own.
Status Distributor::State::add_texture(ServedVolume& volume, std::uint8_t group_id,
                                       const NamedTexture& texture, TextureOptions settings) {
  const TextureGroup& group = volume.desc.groups[group_id];
  const Bundle* const before = volume.bundles.empty() ? nullptr : volume.bundles.back().get();
  const bool first = before == nullptr || before->group_id != group_id;
  if (first || !group.bundled) {
    volume.bundles.push_back(std::make_unique<Bundle>(
        &group, group_id, regions_of(texture.desc, volume.described.region)));
  }
  Bundle& bundle = *volume.bundles.back();
  // A texture that holds the presence of others is exact.
  const bool exact = texture.threshold == Threshold::exact || (first && group.presence == 0);
  if (exact && valid_error(settings.max_error)) settings.max_error = 0;
  bundle.textures.push_back(std::make_unique<ServedTexture>(texture, settings, volume.textures++,
                                                            options.settings.isa, options.threads));
  bundle.is_stateful = bundle.is_stateful || settings.is_stateful;
  BlockHistory& history = bundle.textures.back()->history;
  bundle.first = first ? &history : before->first;
  for (std::uint32_t region = 0; region < bundle.cut.regions(); ++region) {
    bundle.regions[region].streams.emplace_back(
        history, region_texture(texture.desc, volume.described.region, region),
        bundle.region_blocks[region],
        PacketChain{settings.backend->id(), bundle.textures.back()->id}, 0);
    bundle.regions[region].bytes += bundle.region_blocks[region].size() * block_bytes(texture.desc);
  }
  if (group.depends_on != TextureGroup::kNone) {
    volume.linked = true;
    volume.dependencies.resize(volume.desc.groups.size());
    volume.dependencies[group_id].resize(block_count(texture.desc));
    for (const auto& other : volume.bundles)
      other->is_dependency = other->is_dependency || bundle.depends_on(*other);
  }
  const bool sound = settings.threshold >= 0 && valid_error(settings.max_error) &&
                     settings.source_error >= 0 &&
                     (settings.threshold == 0 || settings.max_error == 0);
  // The errors of a lossy backend and of these would add up.
  const bool bounded = settings.threshold > 0 || settings.max_error > 0;
  if (!sound || (settings.is_lossy && bounded)) return Status::invalid_bound;
  const bool in_time = settings.interval > 0 && in_step(volume, bundle, settings.interval);
  return in_time ? Status::ok : Status::invalid_interval;
}

Result<std::vector<StreamedTexture>> by_texture(const VolumeDesc& volume,
                                                std::span<const StreamedTexture> textures) {
  std::vector<StreamedTexture> all;
  for (const TextureGroup& group : volume.groups) {
    for (const NamedTexture& texture : group.textures) all.emplace_back().texture = texture.name;
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

Result<std::vector<TextureOptions>> Distributor::State::texture_options(
    const VolumeDesc& volume, std::span<const StreamedTexture> streamed) const {
  const auto sorted = by_texture(volume, streamed);
  if (!sorted) return sorted.status();
  std::vector<TextureOptions> all;
  for (const TextureGroup& group : volume.groups) {
    for (const NamedTexture& texture : group.textures) {
      TextureOptions& one = all.emplace_back(TextureOptions{(*sorted)[all.size()]});
      one.own_backend = one.backend != nullptr;
      if (!one.own_backend) {
        one.backend = backend;
        one.settings = options.settings;
      }
      const auto encoder = one.backend->make_encoder(texture.desc, one.settings);
      if (!encoder) return encoder.status();
      one.is_stateful = (*encoder)->is_stateful();
      one.is_lossy = (*encoder)->lossy();
      one.chooses_preset =
          one.backend == find_backend(kBackendNative) && one.settings.preset.empty();
      // Unicast clients would each hold other contents.
      if (one.is_lossy && any_unicast()) return Status::unsupported_backend;
    }
  }
  return all;
}

Status Distributor::State::add_bundles(ServedVolume& volume,
                                       std::span<const TextureOptions> textures) {
  for (std::uint8_t group = 0; group < volume.desc.groups.size(); ++group) {
    for (const NamedTexture& texture : volume.desc.groups[group].textures) {
      const Status status = add_texture(volume, group, texture, textures[volume.textures]);
      if (status != Status::ok) return status;
    }
  }
  for (const auto& bundle : volume.bundles) {
    for (SharedRegion& region : bundle->regions) {
      const Status status = make_encoders(*bundle, region.streams, region.encoders);
      if (status != Status::ok) return status;
    }
  }
  return Status::ok;
}

/// All of it or nothing: the volume is complete before it gets its place in the table.
Result<std::uint16_t> Distributor::add_volume(const VolumeDesc& desc,
                                              const VolumeGeometry& geometry,
                                              std::span<const StreamedTexture> textures,
                                              DescribedVolume described) {
  return guarded([&]() -> Result<std::uint16_t> {
    if (const Status status = validate(geometry); status != Status::ok) return status;
    if (const Status status = validate(desc); status != Status::ok) return status;
    if (!(desc.groups[0].textures[0].desc.grid == geometry.grid)) return Status::invalid_geometry;
    State& state = *state_;
    const auto options = state.texture_options(desc, textures);
    if (!options) return options.status();
    const bool stateful = std::any_of(options->begin(), options->end(),
                                      [](const TextureOptions& one) { return one.is_stateful; });
    const auto is_free = [](const auto& one) { return one->removed(); };
    const auto place = std::find_if(state.volumes.begin(), state.volumes.end(), is_free);
    const auto id = static_cast<std::uint16_t>(place - state.volumes.begin());
    if (id >= kMaxVolumes) return Status::limit_exceeded;
    state.volumes.reserve(std::size_t{id} + 1);
    auto volume = std::make_unique<ServedVolume>();
    volume->described = std::move(described);
    for (std::size_t i = 0; i < volume->described.textures.size(); ++i) {
      if ((*options)[i].is_lossy) volume->described.textures[i].largest_error = kUnknownError;
    }
    volume->described.id = id;
    volume->described.geometry = geometry;
    volume->described.region = !(state.options.region == Grid{}) ? state.options.region
                               : stateful                        ? whole_region(desc)
                                                                 : usual_region(desc);
    volume->changed_in = volume->described.added;
    volume->desc = desc;
    volume->active.resize(desc.groups.size());
    const Status status = guarded([&]() -> Status {
      Status one = state.add_bundles(*volume, *options);
      for (auto it = state.clients.begin(); one == Status::ok && it != state.clients.end();) {
        one = state.add_volume_to(*(it++)->second, *volume);
      }
      return one;
    });
    if (status != Status::ok) {
      for (const auto& entry : state.clients) State::drop_volume_of(*entry.second, *volume);
      return status;
    }
    // From here on nothing can fail.
    if (id == state.volumes.size()) state.volumes.emplace_back();
    state.volumes[id] = std::move(volume);
    return id;
  });
}

Status Distributor::remove_volume(std::uint16_t volume, std::uint32_t generation) {
  ServedVolume* const found = state_->find_volume(volume);
  if (found == nullptr) return Status::unknown_volume;
  // Clients' streams refer to its contents, so they go first.
  for (const auto& entry : state_->clients) State::drop_volume_of(*entry.second, *found);
  for (StreamWorker& worker : state_->workers) worker.encoders.clear();
  *found = ServedVolume();
  found->changed_in = generation;
  return Status::ok;
}

std::span<const std::unique_ptr<ServedVolume>> Distributor::table() const noexcept {
  return state_->volumes;
}

Status Distributor::scroll(std::uint16_t volume, const Scroll& scroll) {
  ServedVolume* const found = state_->find_volume(volume);
  if (found == nullptr) return Status::unknown_volume;
  ServedVolume& served = *found;
  VolumeGeometry moved = served.described.geometry;
  moved.scroll = scroll;
  if (const Status status = validate(moved); status != Status::ok) return status;
  if (moved == served.described.geometry) return Status::ok;
  if (served.is_stateful()) return Status::unsupported_backend;
  return guarded([&]() -> Status {
    const auto blocks = entering_blocks(moved.grid, served.described.geometry.scroll, scroll);
    const auto scrolls = [&](const Bundle& bundle) {
      return bundle.desc().space == Space::grid && bundle.desc().grid == moved.grid;
    };
    std::vector<std::pair<SharedRegion*, std::vector<std::uint32_t>>> entering;
    for (const auto& bundle : served.bundles) {
      if (!scrolls(*bundle)) continue;
      for (std::uint32_t region = 0; region < bundle->regions.size(); ++region) {
        std::vector<std::uint32_t> in_region;
        for (std::uint32_t i = 0; i < bundle->region_blocks[region].size(); ++i) {
          const std::uint32_t block = bundle->region_blocks[region][i];
          if (std::binary_search(blocks.begin(), blocks.end(), block)) in_region.push_back(i);
        }
        entering.emplace_back(&bundle->regions[region], std::move(in_region));
      }
    }
    // From here on nothing can fail.
    served.described.geometry = moved;
    for (const auto& bundle : served.bundles) {
      if (!scrolls(*bundle)) continue;
      bundle->forget_held();
      for (const auto& texture : bundle->textures) {
        for (const std::uint32_t block : blocks) texture->unread[block] = 1;
      }
    }
    for (const auto& [shared, places] : entering) {
      for (UpdateStream& stream : shared->streams) stream.set_moved(places);
      for (Lagging& lagging : shared->lagging) {
        for (StreamState& state : lagging.states) state.set_moved(places);
      }
    }
    for (const auto& [id, client] : state_->clients) {
      for (UnicastBundle& unicast : client->unicast) {
        if (unicast.volume != &served || !scrolls(*unicast.bundle)) continue;
        for (UpdateStream& stream : unicast.streams) stream.set_moved(blocks);
      }
    }
    return Status::ok;
  });
}

std::size_t Distributor::volumes() const noexcept {
  return static_cast<std::size_t>(std::count_if(state_->volumes.begin(), state_->volumes.end(),
                                                [](const auto& one) { return !one->removed(); }));
}

Result<VolumeGeometry> Distributor::geometry(std::uint16_t volume) const noexcept {
  const ServedVolume* const found = state_->find_volume(volume);
  if (found == nullptr) return Status::unknown_volume;
  return found->described.geometry;
}

Status Distributor::State::check_mask(std::uint16_t volume, std::uint8_t group,
                                      std::span<const std::uint8_t> mask) const noexcept {
  if (find_volume(volume) == nullptr) return Status::unknown_volume;
  const auto& groups = volumes[volume]->desc.groups;
  if (group >= groups.size()) return Status::unknown_group;
  const bool fits = mask.empty() || mask.size() == block_count(groups[group].textures[0].desc);
  return fits ? Status::ok : Status::mask_mismatch;
}

Status Distributor::set_active(std::uint16_t volume, std::span<const std::uint8_t> active,
                               std::uint8_t group) {
  const Status fits = state_->check_mask(volume, group, active);
  if (fits != Status::ok) return fits;
  ServedVolume& served = *state_->volumes[volume];
  return guarded([&]() -> Status {
    served.active[group].assign(active.begin(), active.end());
    state_->forget_interest(served);
    for (const auto& bundle : served.bundles) {
      if (bundle->group_id == group) bundle->forget_held();
    }
    return Status::ok;
  });
}

}  // namespace gicodec
