// Which blocks a client with packets of its own lacks, and how much each of them matters.
#include "payload/block_difference.h"
#include "session/server_state.h"

#include <algorithm>
#include <limits>

namespace gicodec {
namespace {

/// What a client wants of each lot of a volume where blocks name others: those that it sees, and
/// those that wanted ones name.
std::vector<BlockMask> wanted_of(const ServedClient& client) {
  std::vector<BlockMask> wanted(client.own.size());
  std::vector<std::uint32_t> room;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (!client.own[i].volume->linked) continue;
    wanted[i] = client.seen(client.own[i]);
    wanted[i].resize(client.own[i].owed_since.size());
  }
  for (std::size_t i = wanted.size(); i-- > 0;) {
    const OwnLot& own = client.own[i];
    for (std::size_t j = 0; j < i; ++j) {
      const OwnLot& other = client.own[j];
      if (other.volume != own.volume || !own.lot->names(*other.lot)) continue;
      for (std::uint32_t block = 0; block < wanted[i].size(); ++block) {
        if (wanted[i][block] == 0 || !own.volume->is_active(*own.lot, block)) continue;
        own.lot->for_each_named(own.lot->first->current()[block], wanted[j].size(), room,
                                [&](std::uint32_t name) { wanted[j][name] = 1; });
      }
    }
  }
  return wanted;
}

bool is_before(const Candidate& a, const Candidate& b) {
  return a.lot != b.lot ? a.lot < b.lot : a.block < b.block;
}

/// Calls visit(named) for what a candidate names and the client lacks: another of `candidates`,
/// which are sorted, or null.
template <typename Visit>
void for_each_lacking(const ServedClient& client, std::span<Candidate> candidates,
                      const Candidate& naming, std::vector<std::uint32_t>& room,
                      const Visit& visit) {
  const OwnLot& own = client.own[naming.lot];
  for (std::uint32_t i = 0; i < naming.lot; ++i) {
    const OwnLot& other = client.own[i];
    if (other.volume != own.volume || !own.lot->names(*other.lot)) continue;
    const BlockId now = own.lot->first->current()[naming.block];
    own.lot->for_each_named(now, other.owed_since.size(), room, [&](std::uint32_t block) {
      if (!other.volume->is_active(*other.lot, block) ||
          !other.lot->outdated(other.streams, block)) {
        return;
      }
      const auto found =
          std::lower_bound(candidates.begin(), candidates.end(), Candidate{i, block}, is_before);
      const bool there = found != candidates.end() && found->lot == i && found->block == block;
      visit(there ? &*found : nullptr);
    });
  }
}

/// Leaves out what names blocks that cannot come now.
void drop_early(const ServedClient& client, std::vector<Candidate>& candidates) {
  std::vector<std::uint32_t> room;
  std::size_t kept = 0;
  for (const Candidate candidate : candidates) {
    bool early = false;
    for_each_lacking(client, std::span(candidates).first(kept), candidate, room,
                     [&](const Candidate* named) { early = early || named == nullptr; });
    if (!early) candidates[kept++] = candidate;
  }
  candidates.resize(kept);
}

}  // namespace

Owed collect(ServedClient& client, std::uint64_t update, std::size_t most) {
  Owed owed;
  const auto now = static_cast<std::uint32_t>(update);
  const auto linked_wanted = wanted_of(client);
  // As older() has it.
  const auto age_of = [](const OwnLot& own, std::uint32_t block) {
    return std::uint64_t{own.owed_since[block]} << 32 | own.lot->order[block];
  };
  std::vector<std::uint64_t> ages;
  bool linked = false, ranked = false;
  for (std::size_t i = 0; i < client.own.size(); ++i) {
    OwnLot& own = client.own[i];
    if (!own.lot->due(update)) continue;
    linked = linked || own.volume->linked;
    ranked = ranked || own.lot->set->rank != nullptr;
    const std::size_t before = ages.size();
    ages.reserve(before + own.owed_since.size());
    const BlockMask& wanted = own.volume->linked ? linked_wanted[i] : client.seen(own);
    for (std::uint32_t block = 0; block < own.owed_since.size(); ++block) {
      std::uint32_t& since = own.owed_since[block];
      if (wanted.empty() || wanted[block] == 0 || !own.volume->is_active(*own.lot, block) ||
          !own.lot->outdated(own.streams, block)) {
        since = 0;
        continue;
      }
      if (since == 0) since = now;
      ages.push_back(age_of(own, block));
    }
    owed.blocks += (ages.size() - before) * own.streams.size();
  }
  // Where age does not decide alone, all are looked at.
  std::uint64_t last = UINT64_MAX;
  if (!linked && !ranked && most < ages.size()) {
    const auto place = ages.begin() + static_cast<std::ptrdiff_t>(most);
    std::nth_element(ages.begin(), place, ages.end());
    last = *place;
  }
  owed.candidates.reserve(std::min(most, ages.size()));
  for (std::uint32_t i = 0; i < client.own.size(); ++i) {
    const OwnLot& own = client.own[i];
    if (!own.lot->due(update)) continue;
    const auto blocks = static_cast<std::uint32_t>(own.streams.size());
    for (std::uint32_t block = 0; block < own.owed_since.size(); ++block) {
      if (own.owed_since[block] == 0 || age_of(own, block) > last) continue;
      owed.candidates.push_back({i, block, now - own.owed_since[block], 0, own.lot->order[block],
                                 own.lot->set->rank != nullptr, blocks});
    }
  }
  if (linked) {
    drop_early(client, owed.candidates);
    put_named_first(client, owed.candidates);
    owed.blocks = blocks_of(owed.candidates);
  }
  return owed;
}

void put_named_first(const ServedClient& client, std::span<Candidate> candidates) {
  std::vector<std::uint32_t> room;
  for (std::size_t i = candidates.size(); i-- > 0;) {
    const Candidate& naming = candidates[i];
    for_each_lacking(client, candidates, naming, room, [&](Candidate* named) {
      if (named == nullptr) return;
      named->age = std::max(named->age, naming.age + 1);
      named->weight = std::max(named->weight, naming.weight);
      named->ranked = named->ranked || naming.ranked;
    });
  }
}

void weigh(const ServedClient& client, std::span<Candidate> candidates) {
  bool linked = false;
  for (Candidate& candidate : candidates) {
    const OwnLot& own = client.own[candidate.lot];
    linked = linked || own.volume->linked;
    if (const auto rank = own.lot->set->rank; rank != nullptr) {
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
  if (!linked) return;
  std::sort(candidates.begin(), candidates.end(), is_before);
  put_named_first(client, candidates);
}

}  // namespace gicodec
