#include "session/server/priority.h"

#include "session/server/stratified_order.h"

#include <algorithm>
#include <set>
#include <tuple>

namespace gicodec {
namespace {

auto place(const Candidate& c) { return std::tuple(c.bundle, c.block); }

// Bundle and block break ties, so that the choice is deterministic.
bool older(const Candidate& a, const Candidate& b) {
  const auto tie = [](const Candidate& c) { return std::tuple(c.order, c.bundle, c.block); };
  return a.age != b.age ? a.age > b.age : tie(a) < tie(b);
}

/// The candidates chosen so far.
struct Choice {
  explicit Choice(const Missing& missing_in) : missing(missing_in) {}

  /// Takes the blocks that a candidate lacks, then the candidate, up to `most` blocks; false if not
  /// all have room.
  bool take(const Candidate& candidate, std::size_t most) {
    if (missing) {
      if (taken.contains(place(candidate))) return true;
      for (const Candidate& before : missing(candidate)) {
        if (!take(before, most)) return false;
      }
    }
    if (blocks > 0 && blocks + candidate.blocks > most) return false;
    if (missing) taken.insert(place(candidate));
    chosen.push_back(candidate);
    blocks += candidate.blocks;
    return true;
  }

  const Missing& missing;
  std::vector<Candidate> chosen = {};
  std::size_t blocks = 0;
  std::set<std::tuple<std::uint32_t, std::uint32_t>> taken = {};  ///< only if some may lack others
};

}  // namespace

std::uint32_t spread_order(const Grid& grid, std::uint32_t block) noexcept {
  constexpr std::uint32_t kGolden = 0x9E3779B1;
  const std::uint32_t x = block % grid.x, y = block / grid.x % grid.y, z = block / grid.x / grid.y;
  return (x + y + z) % 2 << 31 | block * kGolden >> 1;
}

std::vector<std::uint32_t> block_order(const TextureDesc& desc) {
  if (desc.model == Model::hemispheres) return stratified_order(desc.grid);
  std::vector<std::uint32_t> order(block_count(desc));
  for (std::uint32_t block = 0; block < order.size(); ++block) {
    order[block] = spread_order(desc.grid, block);
  }
  return order;
}

void keep_oldest(std::vector<Candidate>& candidates, std::size_t limit) {
  const auto first = std::partition(candidates.begin(), candidates.end(),
                                    [](const Candidate& c) { return c.ranked; });
  if (static_cast<std::size_t>(candidates.end() - first) <= limit) return;
  const auto end = first + static_cast<std::ptrdiff_t>(limit);
  std::nth_element(first, end, candidates.end(), older);
  candidates.erase(end, candidates.end());
}

std::size_t blocks_of(std::span<const Candidate> candidates) noexcept {
  std::size_t blocks = 0;
  for (const Candidate& candidate : candidates) blocks += candidate.blocks;
  return blocks;
}

void choose(std::vector<Candidate>& candidates, std::size_t limit, const Missing& missing) {
  if (blocks_of(candidates) > limit) {
    float least = 0;
    bool ranked = false;
    for (const Candidate& c : candidates) {
      least = std::max(least, kMinWeight * c.weight);
      ranked = ranked || c.ranked;
    }
    const auto heavier = [least](const Candidate& a, const Candidate& b) {
      const auto matters = [least](const Candidate& c) {
        return std::max(c.weight, least) * (1.0F + static_cast<float>(c.age));
      };
      const float x = matters(a), y = matters(b);
      return x != y ? x > y : older(a, b);
    };
    Choice choice(missing);
    auto end = candidates.begin();
    const auto take = [&](std::size_t most, const auto& before) {
      const std::size_t full = std::max<std::size_t>(most, 1);
      while (end != candidates.end() && choice.blocks < full) {
        // Each candidate is at least one block, so no more than `left` of the others have room.
        const auto left = static_cast<std::size_t>(candidates.end() - end);
        const auto last = end + static_cast<std::ptrdiff_t>(std::min(full - choice.blocks, left));
        std::nth_element(end, last, candidates.end(), before);
        std::sort(end, last, before);
        for (; end != last; ++end) {
          if (!choice.take(*end, most)) return;
        }
      }
    };
    if (!ranked) take((limit + 1) / 2, older);
    take(limit, heavier);
    candidates = std::move(choice.chosen);
  }
  std::sort(candidates.begin(), candidates.end(),
            [&](const Candidate& a, const Candidate& b) { return place(a) < place(b); });
}

}  // namespace gicodec
