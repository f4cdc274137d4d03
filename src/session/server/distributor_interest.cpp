// What blocks name, and since when receivers may lack it; which blocks a client with packets of its
// own lacks, and how much each of them matters.
#include "quantise/block_difference.h"
#include "session/server/distributor_state.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

namespace gicodec {
namespace {

/// What a client sees of a volume, and what blocks that it sees name.
Masks with_named(const ServedVolume& volume, Masks wanted) {
  for (std::size_t group = wanted.size(); group-- > 0;) {
    const TextureGroup& of = volume.desc.groups[group];
    if (of.depends_on == TextureGroup::kNone) continue;
    BlockMask& named = wanted[of.depends_on];
    named.resize(block_count(volume.desc.groups[of.depends_on].textures[0].desc));
    for (std::uint32_t block = 0; block < wanted[group].size(); ++block) {
      if (wanted[group][block] == 0 || !volume.is_active(group, block)) continue;
      for (const std::uint32_t name : volume.names[group][block]) named[name] = 1;
    }
  }
  return wanted;
}

}  // namespace

bool Names::stale() const noexcept {
  return std::find(stale_.begin(), stale_.end(), 1) != stale_.end();
}

void Names::refresh(const TextureGroup& group, const BlockHistory& first, std::uint32_t named) {
  constexpr std::uint32_t kFew = 16;  // Room for more is made where it is needed.
  std::vector<std::size_t> begin;
  std::vector<std::uint32_t> names, room(kFew);
  begin.reserve(begin_.size());
  names.reserve(names_.size());
  for (std::uint32_t block = 0; block < stale_.size(); ++block) {
    begin.push_back(names.size());
    const auto before = (*this)[block];
    if (stale_[block] == 0) {
      names.insert(names.end(), before.begin(), before.end());
      continue;
    }
    const auto records = first.records(first.current()[block]);
    std::size_t count = group.dependencies(records, room);
    if (count > room.size() && room.size() < named) {
      room.resize(std::min<std::size_t>(count, named));
      count = group.dependencies(records, room);
    }
    const auto end = room.begin() + static_cast<std::ptrdiff_t>(std::min(count, room.size()));
    std::copy_if(room.begin(), end, std::back_inserter(names),
                 [named](std::uint32_t name) { return name < named; });
  }
  begin.push_back(names.size());
  // From here on nothing can fail.
  begin_ = std::move(begin);
  names_ = std::move(names);
  std::fill(stale_.begin(), stale_.end(), std::uint8_t{0});
}

std::vector<std::uint32_t> Names::regions(std::span<const std::uint32_t> blocks,
                                          const RegionGrid& cut) const {
  std::vector<std::uint32_t> regions;
  for (const std::uint32_t block : blocks) {
    for (const std::uint32_t name : (*this)[block]) {
      const std::uint32_t region = cut.region_of(name);
      if (regions.empty() || regions.back() != region) regions.push_back(region);
    }
  }
  std::sort(regions.begin(), regions.end());
  regions.erase(std::unique(regions.begin(), regions.end()), regions.end());
  return regions;
}

std::size_t Names::memory() const noexcept {
  return begin_.capacity() * sizeof begin_[0] + names_.capacity() * sizeof names_[0] +
         stale_.capacity();
}

void Lot::forget_held() noexcept {
  if (!named) return;
  for (SharedRegion& shared : regions) {
    shared.changed = 1;
    for (Behind& behind : shared.behind) behind.until = 0;
  }
}

/// In order: what blocks name comes before them.
void ServedVolume::choose_due(std::uint64_t update) noexcept {
  for (const auto& lot : lots) {
    lot->due = update % lot->textures[0]->options.interval == 0 &&
               std::all_of(lot->textures.begin(), lot->textures.end(), [](const auto& texture) {
                 return texture->published && !texture->presence_changed;
               });
    for (const auto& other : lots) {
      if (lot->names(*other)) lot->due = lot->due && other->due;
    }
  }
}

/// Where blocks name others: one of a texture is no longer what was current `before`.
void ServedVolume::note_change(Lot& lot, ServedTexture& texture, std::uint32_t block,
                               BlockId before, std::uint64_t update) noexcept {
  const auto last = static_cast<std::uint32_t>(update);
  const std::uint32_t region = lot.cut.region_of(block);
  SharedRegion& shared = lot.regions[region];
  texture.until[before] = last;
  if (shared.changed == 0) shared.changed = last + 1;
  if (lot.group->depends_on == TextureGroup::kNone || lot.first != &texture.history) return;
  names[lot.group_id].set_stale(block);
  for (const auto& other : lots) {
    if (other->group_id == lot.group_id) other->regions[region].renamed = true;
  }
}

/// What own clients want of a volume is to be found anew.
void Distributor::State::forget_wanted(const ServedVolume& volume) noexcept {
  for (const auto& [id, client] : clients) client->wanted[volume.id()].reset();
}

/// Before an update: what the blocks name that were published since the last one.
void Distributor::State::refresh_names() {
  for (const auto& volume : volumes) {
    for (const auto& lot : volume->lots) {
      if (lot->group->depends_on == TextureGroup::kNone || !volume->names[lot->group_id].stale())
        continue;
      const TextureDesc& named = volume->desc.groups[lot->group->depends_on].textures[0].desc;
      volume->names[lot->group_id].refresh(*lot->group, *lot->first, block_count(named));
      forget_wanted(*volume);
    }
  }
}

/// Then what own clients want of volumes where blocks name others: who sees the same, the same.
void Distributor::State::refresh_wanted() {
  const auto less = [](const Masks* a, const Masks* b) { return *a < *b; };
  for (const auto& volume : volumes) {
    if (!volume->linked) continue;
    std::map<const Masks*, std::shared_ptr<const Masks>, decltype(less)> known(less);
    for (const auto& [id, client] : clients) {
      auto& wanted = client->wanted[volume->id()];
      if (client->delivery != Delivery::unicast || wanted != nullptr) continue;
      const Masks& visible = client->visible[volume->id()];
      auto& same = known[&visible];
      if (same == nullptr) same = std::make_shared<const Masks>(with_named(*volume, visible));
      wanted = same;
    }
  }
}

std::uint32_t OwnLot::until(std::uint32_t block, std::uint64_t update) const noexcept {
  auto until = static_cast<std::uint32_t>(update);
  for (std::size_t i = 0; i < streams.size(); ++i) {
    const BlockId held = streams[i].sent(block);
    if (held == kNothing || streams[i].moved(block)) return 0;
    if (held != streams[i].current(block)) until = std::min(until, lot->textures[i]->until[held]);
  }
  return until;
}

static Candidate candidate(const ServedClient& client, std::uint32_t lot, std::uint32_t block,
                           std::uint32_t now) {
  const OwnLot& own = client.own[lot];
  const auto blocks = static_cast<std::uint32_t>(own.streams.size());
  const bool ranked = own.lot->group->rank != nullptr;
  return {lot, block, now - own.owed_since[block], 0, own.lot->order[block], ranked, blocks};
}

bool is_owed(const OwnLot& own, const BlockMask& wanted, std::uint32_t block) noexcept {
  return !wanted.empty() && wanted[block] != 0 && own.volume->is_active(own.lot->group_id, block) &&
         own.lot->outdated(own.streams, block);
}

/// Since when the client is owed a block, which is noted; 0: it is not.
static std::uint32_t note_owed(ServedClient& client, OwnLot& own, const BlockMask& wanted,
                               std::uint32_t block, std::uint32_t now) noexcept {
  ++client.looked_at;
  std::uint32_t& since = own.owed_since[block];
  since = !is_owed(own, wanted, block) ? 0 : since == 0 ? now : since;
  return since;
}

static BlockMask due_lots(const ServedClient& client) {
  BlockMask due;
  due.reserve(client.own.size());
  for (const OwnLot& own : client.own) due.push_back(own.lot->due ? 1 : 0);
  return due;
}

/// What is left of the backlog; nothing if that is too little, or age does not decide alone.
static std::optional<Owed> collect_backlog(ServedClient& client, std::uint32_t now,
                                           std::size_t most) {
  Backlog& backlog = client.backlog;
  if (backlog.oldest.size() < most || backlog.due != due_lots(client)) return std::nullopt;
  Owed owed;
  owed.candidates.reserve(backlog.oldest.size());
  const auto done = [&](const Backlog::Place& at) {
    OwnLot& own = client.own[at.lot];
    const std::uint32_t since = note_owed(client, own, client.wants(own), at.block, now);
    // What was sent meanwhile and is owed again is for the next look at all.
    if (since == 0 || since > backlog.update) return true;
    owed.candidates.push_back(candidate(client, at.lot, at.block, now));
    return false;
  };
  auto& oldest = backlog.oldest;
  oldest.erase(std::remove_if(oldest.begin(), oldest.end(), done), oldest.end());
  if (oldest.size() < most) return std::nullopt;
  owed.blocks = backlog.others + blocks_of(owed.candidates);
  return owed;
}

Owed collect(ServedClient& client, std::uint64_t update, std::size_t most) {
  // So that all blocks are looked at once in several updates.
  constexpr std::size_t kAhead = 3;
  const auto now = static_cast<std::uint32_t>(update);
  if (auto owed = collect_backlog(client, now, most)) return *std::move(owed);
  client.backlog = {};
  Owed owed;
  // As older() has it.
  const auto age_of = [](const OwnLot& own, std::uint32_t block) {
    return std::uint64_t{own.owed_since[block]} << 32 | own.lot->order[block];
  };
  std::vector<std::uint64_t> ages;
  bool ranked = false;
  for (OwnLot& own : client.own) {
    if (!own.lot->due) continue;
    ranked = ranked || own.lot->group->rank != nullptr;
    const BlockMask& wanted = client.wants(own);
    const std::size_t before = ages.size();
    ages.reserve(before + own.owed_since.size());
    for (std::uint32_t block = 0; block < own.owed_since.size(); ++block) {
      if (note_owed(client, own, wanted, block, now) != 0) ages.push_back(age_of(own, block));
    }
    owed.blocks += (ages.size() - before) * own.streams.size();
  }
  // Where age does not decide alone, all are looked at.
  const std::size_t ahead = times(most, kAhead);
  std::uint64_t last = UINT64_MAX;
  if (!ranked && ahead < ages.size()) {
    const auto place = ages.begin() + static_cast<std::ptrdiff_t>(ahead);
    std::nth_element(ages.begin(), place, ages.end());
    last = *place;
  }
  owed.candidates.reserve(std::min(ahead, ages.size()));
  for (std::uint32_t i = 0; i < client.own.size(); ++i) {
    const OwnLot& own = client.own[i];
    if (!own.lot->due) continue;
    for (std::uint32_t block = 0; block < own.owed_since.size(); ++block) {
      if (own.owed_since[block] == 0 || age_of(own, block) > last) continue;
      owed.candidates.push_back(candidate(client, i, block, now));
    }
  }
  if (ranked || most >= owed.candidates.size()) return owed;
  Backlog backlog{update, due_lots(client), {}, owed.blocks - blocks_of(owed.candidates)};
  backlog.oldest.reserve(owed.candidates.size());
  for (const Candidate& one : owed.candidates) backlog.oldest.push_back({one.lot, one.block});
  client.backlog = std::move(backlog);
  return owed;
}

std::vector<Candidate> lacking(ServedClient& client, const Candidate& naming,
                               std::uint64_t update) {
  std::vector<Candidate> named;
  const OwnLot& own = client.own[naming.lot];
  const auto now = static_cast<std::uint32_t>(update);
  for (std::uint32_t i = 0; i < naming.lot; ++i) {
    OwnLot& other = client.own[i];
    if (other.volume != own.volume || !own.lot->names(*other.lot)) continue;
    for (const std::uint32_t block : own.volume->names[own.lot->group_id][naming.block]) {
      // What is not owed is there, or not active.
      if (note_owed(client, other, client.wants(other), block, now) != 0 &&
          other.until(block, update) < own.owed_since[naming.block]) {
        named.push_back(candidate(client, i, block, now));
      }
    }
  }
  return named;
}

void weigh(const ServedClient& client, std::span<Candidate> candidates) {
  for (Candidate& candidate : candidates) {
    const OwnLot& own = client.own[candidate.lot];
    if (const auto rank = own.lot->group->rank; rank != nullptr) {
      const float value = rank(own.lot->first->records(own.lot->first->current()[candidate.block]));
      // What is no number, or negative, is the least.
      candidate.weight = value > 0 ? std::min(value, std::numeric_limits<float>::max()) : 0;
      continue;
    }
    candidate.weight = 0;
    for (std::size_t i = 0; i < own.streams.size(); ++i) {
      const UpdateStream& stream = own.streams[i];
      const BlockHistory& history = own.lot->textures[i]->history;
      const BlockId sent = stream.sent(candidate.block);
      const float share = stream.moved(candidate.block) || sent == kNothing
                              ? 1
                              : changed_share(stream.desc(), history.records(sent),
                                              history.records(stream.current(candidate.block)));
      candidate.weight = std::max(candidate.weight, share);
    }
  }
}

}  // namespace gicodec
