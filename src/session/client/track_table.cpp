#include "session/client/track_table.h"

#include "bitstream/description.h"
#include "session/client/client_limits.h"
#include "texture/cells.h"

#include <algorithm>
#include <cmath>

namespace gicodec {
namespace {

/// A unit is dropped at this multiple of the reach, so that none comes and goes at its edge.
constexpr float kFar = 1.25F;

/// The distance along an axis between `eye` and what blocks `first`..`first` + `count` - 1 light:
/// they are mixed with their neighbours up to these.
float distance_along(const VolumeGeometry& geometry, std::size_t axis, std::uint32_t first,
                     std::uint32_t count, float eye) noexcept {
  const float origin = geometry.origin[axis], spacing = geometry.spacing[axis];
  const auto distance = [&](std::int64_t from, std::int64_t to) {
    const float least = origin + static_cast<float>(from - 1) * spacing;
    const float most = origin + static_cast<float>(to + 1) * spacing;
    return std::max({least - eye, eye - most, 0.0F});
  };
  const std::int64_t lowest = geometry.scroll[axis], side = sides(geometry.grid)[axis];
  const std::int64_t from = cell_at(first, geometry.scroll[axis], sides(geometry.grid)[axis]);
  const std::int64_t to = from + count - 1, highest = lowest + side - 1;
  if (to <= highest) return distance(from, to);
  return std::min(distance(from, highest), distance(lowest, to - side));  // scrolled
}

}  // namespace

Result<TrackTable> TrackTable::create(TrackList list, const TrackReceiverOptions& options) {
  TrackTable table;
  table.list_ = std::move(list);
  for (std::uint16_t v = 0; v < table.list_.volumes.size(); ++v) {
    const DescribedVolume& said = table.list_.volumes[v];
    auto desc = volume_desc_of(said, options.kinds);
    if (!desc) return desc.status();
    table.volumes_.push_back(*std::move(desc));
    const Status added = table.add_volume(v, options.max_tracks);
    if (added != Status::ok) return added;
  }
  for (std::uint32_t u = 0; u < table.units_.size(); ++u) {
    const auto& tracks = table.units_[u].tracks;
    for (std::uint32_t t = 0; t < tracks.size(); ++t) table.places_[tracks[t].stream] = {u, t};
  }
  if (!table.has_tracks_of(table.list_)) return Status::corrupt;
  table.take_snapshots();
  return table;
}

/// Adds the units of a volume.
Status TrackTable::add_volume(std::uint16_t v, std::uint32_t max_tracks) {
  const DescribedVolume& said = list_.volumes[v];
  const VolumeDesc& desc = volumes_[v];
  const bool linked = std::any_of(desc.groups.begin(), desc.groups.end(), [](const auto& group) {
    return group.depends_on != TextureGroup::kNone;
  });
  std::uint64_t all = 0;
  for (const TrackUnit& unit : units_) all += unit.tracks.size();
  if (linked) units_.push_back({.volume = v, .whole = true});
  std::uint8_t id = 0;
  for (std::uint8_t group = 0; group < desc.groups.size(); ++group) {
    const std::size_t begin = units_.size();
    const auto& textures = desc.groups[group].textures;
    for (std::size_t t = 0; t < textures.size(); ++t, ++id) {
      const std::uint32_t regions = regions_of(textures[t].desc, said.region).regions();
      all += regions;
      if (all > max_tracks) return Status::limit_exceeded;
      const bool joins = desc.groups[group].bundled && t > 0;
      for (std::uint32_t region = 0; region < regions; ++region) {
        if (!linked && !joins) units_.push_back({.volume = v, .group = group, .region = region});
        TrackUnit& unit = !linked && joins ? units_[begin + region] : units_.back();
        unit.tracks.emplace_back().stream = {said.id, id, region};
      }
    }
  }
  return Status::ok;
}

Status TrackTable::take(TrackList list) {
  if (!has_tracks_of(list)) return Status::corrupt;
  list.volumes = std::move(list_.volumes);
  list_ = std::move(list);
  take_snapshots();
  return Status::ok;
}

bool TrackTable::has_tracks_of(const TrackList& list) const noexcept {
  return std::all_of(list.snapshots.begin(), list.snapshots.end(), [&](const TrackRun& run) {
    StreamId last = run.first;
    last.region += run.count - 1;
    return places_.count(run.first) != 0 && places_.count(last) != 0;
  });
}

/// Notes the snapshots of the list.
void TrackTable::take_snapshots() noexcept {
  for (const TrackRun& run : list_.snapshots) {
    auto it = places_.find(run.first);
    for (std::uint32_t i = 0; i < run.count; ++i, ++it)
      units_[it->second.first].tracks[it->second.second].snapshot = list_.update - run.age;
  }
}

std::pair<TrackUnit*, Track*> TrackTable::find(StreamId stream) noexcept {
  const auto found = places_.find(stream);
  if (found == places_.end()) return {nullptr, nullptr};
  TrackUnit& unit = units_[found->second.first];
  return {&unit, &unit.tracks[found->second.second]};
}

std::optional<std::size_t> TrackTable::volume(std::uint16_t id) const noexcept {
  const auto same = [&](const DescribedVolume& one) { return one.id == id; };
  const auto it = std::find_if(list_.volumes.begin(), list_.volumes.end(), same);
  if (it == list_.volumes.end()) return std::nullopt;
  return static_cast<std::size_t>(it - list_.volumes.begin());
}

std::uint32_t TrackTable::blocks(std::size_t volume, std::uint8_t group) const noexcept {
  return block_count(volumes_[volume].groups[group].textures.front().desc);
}

std::optional<TrackName> TrackTable::name(StreamId stream) const noexcept {
  const auto v = volume(stream.volume);
  if (!v || places_.count(stream) == 0) return std::nullopt;
  const DescribedVolume& said = list_.volumes[*v];
  const auto [group, first] = group_of(volumes_[*v], stream.texture);
  const NamedTexture& texture = group->textures[stream.texture - first];
  return TrackName{said.name, texture.name,
                   regions_of(texture.desc, said.region).place_of(stream.region)};
}

std::optional<std::uint32_t> TrackTable::presence_of(StreamId stream) const noexcept {
  const auto v = volume(stream.volume);
  if (!v) return std::nullopt;
  const auto [group, first] = group_of(volumes_[*v], stream.texture);
  if (group->presence == TextureGroup::kNone) return std::nullopt;
  const auto presence = static_cast<std::uint8_t>(first + group->presence);
  if (presence == stream.texture) return std::nullopt;
  const auto found = places_.find({stream.volume, presence, stream.region});
  if (found == places_.end()) return std::nullopt;
  return found->second.second;
}

void TrackTable::scroll(std::span<const Scroll> scrolls) noexcept {
  for (std::size_t v = 0; v < std::min(scrolls.size(), list_.volumes.size()); ++v)
    list_.volumes[v].geometry.scroll = scrolls[v];
}

/// From what the unit's region lights. 0 in pools, which have no places.
float TrackTable::distance(const TrackUnit& unit, const Position& eye) const noexcept {
  const VolumeGeometry& geometry = list_.volumes[unit.volume].geometry;
  const TextureDesc& desc = volumes_[unit.volume].groups[unit.group].textures.front().desc;
  if (unit.whole || desc.space != Space::grid || !(desc.grid == geometry.grid)) return 0;
  const RegionGrid cut = regions_of(desc, list_.volumes[unit.volume].region);
  const Grid first = cut.first_of(unit.region), size = cut.grid_of(unit.region);
  return std::hypot(distance_along(geometry, 0, first.x, size.x, eye[0]),
                    distance_along(geometry, 1, first.y, size.y, eye[1]),
                    distance_along(geometry, 2, first.z, size.z, eye[2]));
}

/// By the client's choice of blocks, or by distance. Needs unit.distance.
bool TrackTable::is_chosen(const TrackUnit& unit, const TrackInterest& interest) const {
  const std::uint16_t id = list_.volumes[unit.volume].id;
  if (unit.whole) {
    bool any = false, all_chosen = true;
    for (std::uint8_t group = 0; group < groups(unit.volume); ++group) {
      const auto mask = interest.blocks.find({id, group});
      all_chosen = all_chosen && mask != interest.blocks.end();
      any = any || (mask != interest.blocks.end() &&
                    std::any_of(mask->second.begin(), mask->second.end(),
                                [](std::uint8_t block) { return block != 0; }));
    }
    return any || (!all_chosen && !interest.subscribed_only);
  }
  const auto mask = interest.blocks.find({id, unit.group});
  if (mask != interest.blocks.end()) {
    const TextureDesc& desc = volumes_[unit.volume].groups[unit.group].textures.front().desc;
    const auto blocks = regions_of(desc, list_.volumes[unit.volume].region).blocks_of(unit.region);
    return std::any_of(blocks.begin(), blocks.end(), [&](std::uint32_t block) {
      return block < mask->second.size() && mask->second[block] != 0;
    });
  }
  if (interest.subscribed_only) return false;
  if (interest.reach <= 0) return true;
  return interest.viewpoint && unit.distance <= interest.reach * (unit.wanted ? kFar : 1);
}

bool TrackTable::choose(const TrackInterest& interest) {
  std::vector<const TrackUnit*> chosen;
  std::vector<StreamId> streams;
  chosen.reserve(units_.size());
  streams.reserve(places_.size());
  // From here on nothing can fail.
  bool changed = false;
  for (TrackUnit& unit : units_) {
    unit.distance = interest.viewpoint ? distance(unit, interest.viewpoint->eye) : 0;
    const bool wanted = is_chosen(unit, interest);
    if (wanted) chosen.push_back(&unit);
    if (wanted == unit.wanted) continue;
    changed = true;
    unit.wanted = wanted;
    unit.behind = 0;
    for (Track& track : unit.tracks) {
      track.forget_held();
      track.forget_waiting();
      track.asks = wanted;
    }
  }
  if (!changed) return false;
  std::sort(chosen.begin(), chosen.end(), [](const TrackUnit* a, const TrackUnit* b) {
    return std::pair(a->distance, a) < std::pair(b->distance, b);
  });
  for (const TrackUnit* const unit : chosen) {
    for (const Track& track : unit->tracks) streams.push_back(track.stream);
  }
  wanted_ = std::move(streams);
  return true;
}

}  // namespace gicodec
