// The dependencies of blocks, and since when clients may lack them; the pending blocks of a unicast
// client, and their weights.
#include "quantise/block_difference.h"
#include "session/server/distributor_state.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

namespace gicodec {
namespace {

/// Adds the blocks that visible blocks depend on.
Masks with_dependencies(const ServedVolume& volume, Masks interest) {
  for (std::size_t group = interest.size(); group-- > 0;) {
    const TextureGroup& of = volume.desc.groups[group];
    if (of.depends_on == TextureGroup::kNone) continue;
    BlockMask& needed = interest[of.depends_on];
    needed.resize(block_count(volume.desc.groups[of.depends_on].textures[0].desc));
    for (std::uint32_t block = 0; block < interest[group].size(); ++block) {
      if (interest[group][block] == 0 || !volume.is_active(group, block)) continue;
      for (const std::uint32_t one : volume.dependencies[group][block]) needed[one] = 1;
    }
  }
  return interest;
}

}  // namespace

bool Dependencies::stale() const noexcept {
  return std::find(stale_.begin(), stale_.end(), 1) != stale_.end();
}

void Dependencies::refresh(const TextureGroup& group, const BlockHistory& first,
                           std::uint32_t limit) {
  constexpr std::uint32_t kFew = 16;  // Grows where a block has more.
  std::vector<std::size_t> begin;
  std::vector<std::uint32_t> blocks, room(kFew);
  begin.reserve(begin_.size());
  blocks.reserve(blocks_.size());
  for (std::uint32_t block = 0; block < stale_.size(); ++block) {
    begin.push_back(blocks.size());
    const auto before = (*this)[block];
    if (stale_[block] == 0) {
      blocks.insert(blocks.end(), before.begin(), before.end());
      continue;
    }
    const auto records = first.records(first.current()[block]);
    std::size_t count = group.dependencies(records, room);
    if (count > room.size() && room.size() < limit) {
      room.resize(std::min<std::size_t>(count, limit));
      count = group.dependencies(records, room);
    }
    const auto end = room.begin() + static_cast<std::ptrdiff_t>(std::min(count, room.size()));
    std::copy_if(room.begin(), end, std::back_inserter(blocks),
                 [limit](std::uint32_t one) { return one < limit; });
  }
  begin.push_back(blocks.size());
  // From here on nothing can fail.
  begin_ = std::move(begin);
  blocks_ = std::move(blocks);
  std::fill(stale_.begin(), stale_.end(), std::uint8_t{0});
}

std::vector<std::uint32_t> Dependencies::regions(std::span<const std::uint32_t> blocks,
                                                 const RegionGrid& cut) const {
  std::vector<std::uint32_t> regions;
  for (const std::uint32_t block : blocks) {
    for (const std::uint32_t one : (*this)[block]) {
      const std::uint32_t region = cut.region_of(one);
      if (regions.empty() || regions.back() != region) regions.push_back(region);
    }
  }
  std::sort(regions.begin(), regions.end());
  regions.erase(std::unique(regions.begin(), regions.end()), regions.end());
  return regions;
}

std::size_t Dependencies::memory() const noexcept {
  return begin_.capacity() * sizeof begin_[0] + blocks_.capacity() * sizeof blocks_[0] +
         stale_.capacity();
}

void Bundle::forget_held() noexcept {
  if (!is_dependency) return;
  for (SharedRegion& shared : regions) {
    shared.changed = 1;
    for (Lagging& lagging : shared.lagging) lagging.last_current = 0;
  }
}

/// Dependencies come before the bundles that depend on them.
void ServedVolume::choose_due(std::uint64_t update) noexcept {
  for (const auto& bundle : bundles) {
    bundle->due =
        update % bundle->textures[0]->options.interval == 0 &&
        std::all_of(bundle->textures.begin(), bundle->textures.end(), [](const auto& texture) {
          return texture->published && !texture->presence_changed;
        });
    for (const auto& other : bundles) {
      if (bundle->depends_on(*other)) bundle->due = bundle->due && other->due;
    }
  }
}

/// Where blocks depend on others: notes that `before` is no longer the current version of a block.
void ServedVolume::note_change(Bundle& bundle, ServedTexture& texture, std::uint32_t block,
                               BlockId before, std::uint64_t update) noexcept {
  const auto last = static_cast<std::uint32_t>(update);
  const std::uint32_t region = bundle.cut.region_of(block);
  SharedRegion& shared = bundle.regions[region];
  texture.last_current[before] = last;
  if (shared.changed == 0) shared.changed = last + 1;
  if (bundle.group->depends_on == TextureGroup::kNone || bundle.first != &texture.history) return;
  dependencies[bundle.group_id].set_stale(block);
  for (const auto& other : bundles) {
    if (other->group_id == bundle.group_id) other->regions[region].dependencies_changed = true;
  }
}

/// Discards the interest of unicast clients in a volume, which refresh_interest() finds anew.
void Distributor::State::forget_interest(const ServedVolume& volume) noexcept {
  for (const auto& [id, client] : clients) client->interest[volume.id()].reset();
}

/// Before an update: reads the dependencies of the blocks published since the last one.
void Distributor::State::refresh_dependencies() {
  for (const auto& volume : volumes) {
    for (const auto& bundle : volume->bundles) {
      if (bundle->group->depends_on == TextureGroup::kNone ||
          !volume->dependencies[bundle->group_id].stale())
        continue;
      const TextureDesc& needed = volume->desc.groups[bundle->group->depends_on].textures[0].desc;
      volume->dependencies[bundle->group_id].refresh(*bundle->group, *bundle->first,
                                                     block_count(needed));
      forget_interest(*volume);
    }
  }
}

/// After refresh_dependencies(): finds the interest of unicast clients in volumes where blocks
/// depend on others. Clients that see the same blocks share it.
void Distributor::State::refresh_interest() {
  const auto less = [](const Masks* a, const Masks* b) { return *a < *b; };
  for (const auto& volume : volumes) {
    if (!volume->linked) continue;
    std::map<const Masks*, std::shared_ptr<const Masks>, decltype(less)> known(less);
    for (const auto& [id, client] : clients) {
      auto& interest = client->interest[volume->id()];
      if (client->delivery != Delivery::unicast || interest != nullptr) continue;
      const Masks& visible = client->visible[volume->id()];
      auto& same = known[&visible];
      if (same == nullptr)
        same = std::make_shared<const Masks>(with_dependencies(*volume, visible));
      interest = same;
    }
  }
}

std::uint32_t UnicastBundle::last_current(std::uint32_t block,
                                          std::uint64_t update) const noexcept {
  auto last_current = static_cast<std::uint32_t>(update);
  for (std::size_t i = 0; i < streams.size(); ++i) {
    const BlockId held = streams[i].sent(block);
    if (held == kNothing || streams[i].moved(block)) return 0;
    if (held != streams[i].current(block))
      last_current = std::min(last_current, bundle->textures[i]->last_current[held]);
  }
  return last_current;
}

static Candidate candidate(const ServedClient& client, std::uint32_t bundle, std::uint32_t block,
                           std::uint32_t now) {
  const UnicastBundle& unicast = client.unicast[bundle];
  const auto blocks = static_cast<std::uint32_t>(unicast.streams.size());
  const bool ranked = unicast.bundle->group->rank != nullptr;
  return {bundle, block, now - unicast.pending_since[block], 0, unicast.bundle->order[block],
          ranked, blocks};
}

bool is_pending(const UnicastBundle& unicast, const BlockMask& interest,
                std::uint32_t block) noexcept {
  return !interest.empty() && interest[block] != 0 &&
         unicast.volume->is_active(unicast.bundle->group_id, block) &&
         unicast.bundle->outdated(unicast.streams, block);
}

/// Notes and returns the update since which a block is pending for the client; 0: it is not.
static std::uint32_t note_pending(ServedClient& client, UnicastBundle& unicast,
                                  const BlockMask& interest, std::uint32_t block,
                                  std::uint32_t now) noexcept {
  ++client.examined;
  std::uint32_t& since = unicast.pending_since[block];
  since = !is_pending(unicast, interest, block) ? 0 : since == 0 ? now : since;
  return since;
}

static BlockMask due_bundles(const ServedClient& client) {
  BlockMask due;
  due.reserve(client.unicast.size());
  for (const UnicastBundle& unicast : client.unicast) due.push_back(unicast.bundle->due ? 1 : 0);
  return due;
}

/// The rest of the backlog; nullopt if fewer than `most` blocks are left or other bundles are due.
static std::optional<PendingBlocks> collect_backlog(ServedClient& client, std::uint32_t now,
                                                    std::size_t most) {
  Backlog& backlog = client.backlog;
  if (backlog.oldest.size() < most || backlog.due != due_bundles(client)) return std::nullopt;
  PendingBlocks pending;
  pending.candidates.reserve(backlog.oldest.size());
  const auto done = [&](const Backlog::Place& at) {
    UnicastBundle& unicast = client.unicast[at.bundle];
    const std::uint32_t since =
        note_pending(client, unicast, client.interest_in(unicast), at.block, now);
    // A block that was sent and is pending again waits until all blocks are examined.
    if (since == 0 || since > backlog.update) return true;
    pending.candidates.push_back(candidate(client, at.bundle, at.block, now));
    return false;
  };
  auto& oldest = backlog.oldest;
  oldest.erase(std::remove_if(oldest.begin(), oldest.end(), done), oldest.end());
  if (oldest.size() < most) return std::nullopt;
  pending.blocks = backlog.others + blocks_of(pending.candidates);
  return pending;
}

PendingBlocks collect(ServedClient& client, std::uint64_t update, std::size_t most) {
  // With so many times `most` blocks, the backlog lasts for several updates.
  constexpr std::size_t kAhead = 3;
  const auto now = static_cast<std::uint32_t>(update);
  if (auto pending = collect_backlog(client, now, most)) return *std::move(pending);
  client.backlog = {};
  PendingBlocks pending;
  // The order of older().
  const auto age_of = [](const UnicastBundle& unicast, std::uint32_t block) {
    return std::uint64_t{unicast.pending_since[block]} << 32 | unicast.bundle->order[block];
  };
  std::vector<std::uint64_t> ages;
  bool ranked = false;
  for (UnicastBundle& unicast : client.unicast) {
    if (!unicast.bundle->due) continue;
    ranked = ranked || unicast.bundle->group->rank != nullptr;
    const BlockMask& interest = client.interest_in(unicast);
    const std::size_t before = ages.size();
    ages.reserve(before + unicast.pending_since.size());
    for (std::uint32_t block = 0; block < unicast.pending_since.size(); ++block) {
      if (note_pending(client, unicast, interest, block, now) != 0)
        ages.push_back(age_of(unicast, block));
    }
    pending.blocks += (ages.size() - before) * unicast.streams.size();
  }
  // With ranks, age alone does not decide, so all blocks are candidates.
  const std::size_t ahead = times(most, kAhead);
  std::uint64_t last = UINT64_MAX;
  if (!ranked && ahead < ages.size()) {
    const auto place = ages.begin() + static_cast<std::ptrdiff_t>(ahead);
    std::nth_element(ages.begin(), place, ages.end());
    last = *place;
  }
  pending.candidates.reserve(std::min(ahead, ages.size()));
  for (std::uint32_t i = 0; i < client.unicast.size(); ++i) {
    const UnicastBundle& unicast = client.unicast[i];
    if (!unicast.bundle->due) continue;
    for (std::uint32_t block = 0; block < unicast.pending_since.size(); ++block) {
      if (unicast.pending_since[block] == 0 || age_of(unicast, block) > last) continue;
      pending.candidates.push_back(candidate(client, i, block, now));
    }
  }
  if (ranked || most >= pending.candidates.size()) return pending;
  Backlog backlog{update, due_bundles(client), {}, pending.blocks - blocks_of(pending.candidates)};
  backlog.oldest.reserve(pending.candidates.size());
  for (const Candidate& one : pending.candidates) backlog.oldest.push_back({one.bundle, one.block});
  client.backlog = std::move(backlog);
  return pending;
}

std::vector<Candidate> missing_dependencies(ServedClient& client, const Candidate& dependent,
                                            std::uint64_t update) {
  std::vector<Candidate> missing;
  const UnicastBundle& unicast = client.unicast[dependent.bundle];
  const auto now = static_cast<std::uint32_t>(update);
  for (std::uint32_t i = 0; i < dependent.bundle; ++i) {
    UnicastBundle& other = client.unicast[i];
    if (other.volume != unicast.volume || !unicast.bundle->depends_on(*other.bundle)) continue;
    for (const std::uint32_t block :
         unicast.volume->dependencies[unicast.bundle->group_id][dependent.block]) {
      // A block that is not pending is at the client already, or is not active.
      if (note_pending(client, other, client.interest_in(other), block, now) != 0 &&
          other.last_current(block, update) < unicast.pending_since[dependent.block]) {
        missing.push_back(candidate(client, i, block, now));
      }
    }
  }
  return missing;
}

void weigh(const ServedClient& client, std::span<Candidate> candidates) {
  for (Candidate& candidate : candidates) {
    const UnicastBundle& unicast = client.unicast[candidate.bundle];
    if (const auto rank = unicast.bundle->group->rank; rank != nullptr) {
      const float value =
          rank(unicast.bundle->first->records(unicast.bundle->first->current()[candidate.block]));
      // NaN and negative ranks count as 0.
      candidate.weight = value > 0 ? std::min(value, std::numeric_limits<float>::max()) : 0;
      continue;
    }
    candidate.weight = 0;
    for (std::size_t i = 0; i < unicast.streams.size(); ++i) {
      const UpdateStream& stream = unicast.streams[i];
      const BlockHistory& history = unicast.bundle->textures[i]->history;
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
