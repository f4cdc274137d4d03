#include "native/mode_search.h"

#include <algorithm>
#include <array>
#include <utility>

namespace gicodec::native {
namespace {

const Mode& mode_of(const Update& u, unsigned kind, unsigned m) {
  if (u.layout.pairs) return kPairUpdateModes[kind][m];
  return u.update ? kPlaneUpdateModes[m] : kPlaneKeyModes[m];
}
unsigned kinds_of(const Update& u) { return u.layout.pairs ? 2 : 1; }

/// Neighbouring modes of the table may differ in their operator only.
bool same_reference(const Mode& a, const Mode& b) {
  return a.reference == b.reference && a.neighbours == b.neighbours;
}

/// What sends a mode costs on top, in 1/16 bits: enough to prefer the first among equals.
constexpr std::uint32_t kModeCost = 4;

/// Modes whose exact cost is looked at.
constexpr unsigned kExactTries = 4;

}  // namespace

void choose_modes(const Update& u, std::size_t g, Group& group, Workspace& w,
                  Estimates* estimates) {
  if (u.layout.pairs && !u.update) return;
  for (unsigned kind = 0; estimates != nullptr && kind < 2; ++kind) {
    for (auto& lane : estimates[kind]) lane.fill(UINT32_MAX);
  }
  Workspace::LaneBlocks references[2];
  for (auto& r : references) r.fill(w.zero_block());
  for (std::uint32_t b = w.chunk.group_begin[g]; b < w.chunk.group_begin[g + 1]; ++b) {
    const unsigned lane = b - w.chunk.group_begin[g];
    const Known known = w.known(u, b);
    for (unsigned kind = 0; kind < kinds_of(u); ++kind) {
      // Two rooms: the best so far keeps its own, the next try uses the other.
      std::uint16_t* rooms[2] = {w.lane_block(lane) + kind * u.texels(),
                                 w.lane_block(kLanes) + kind * u.texels()};
      const std::uint16_t* best = nullptr;
      bool best_in_spare = false;
      std::uint32_t least = UINT32_MAX;
      for (unsigned m = 0, end = 0; m < kModes; m = end) {
        const Mode& mode = mode_of(u, kind, m);
        for (end = m + 1; end < kModes && same_reference(mode, mode_of(u, kind, end));) ++end;
        if (!usable(mode, known)) continue;
        std::uint16_t* room = rooms[best != nullptr && best == rooms[0] ? 1 : 0];
        const std::uint16_t* reference = lane_reference(u, w, known, kind, m, room);
        const CostJob job{w.current(b) + kind * u.texels(),
                          reference,
                          u.desc.core,
                          u.layout.pairs ? 1 : w.planes(),
                          static_cast<unsigned>(u.texels()),
                          u.layout.plane[0].bits > 11,
                          &mode,
                          end - m,
                          w.cost_scratch()};
        std::uint32_t cost[kModes];
        u.kernels.cost(job, cost);
        for (unsigned k = m; k < end; ++k) {
          if (estimates != nullptr) estimates[kind][lane][k] = cost[k - m];
          if (cost[k - m] + kModeCost * k >= least) continue;
          least = cost[k - m] + kModeCost * k;
          best = reference;
          best_in_spare = reference == rooms[1];
          group.mode[kind][lane] = static_cast<std::uint16_t>(k);
        }
      }
      if (best_in_spare) {
        std::copy_n(best, u.layout.pairs ? u.texels() : w.planes() * u.texels(), rooms[0]);
        best = rooms[0];
      }
      references[kind][lane] = best;
    }
  }
  w.load_references(u, references);
}

void load_modes(const Update& u, std::size_t g, const Group& group, Workspace& w) {
  if (u.layout.pairs && !u.update) return;
  Workspace::LaneBlocks references[2];
  for (auto& r : references) r.fill(w.zero_block());
  for (std::uint32_t b = w.chunk.group_begin[g]; b < w.chunk.group_begin[g + 1]; ++b) {
    const unsigned lane = b - w.chunk.group_begin[g];
    const Known known = w.known(u, b);
    for (unsigned k = 0; k < kinds_of(u); ++k) {
      references[k][lane] =
          lane_reference(u, w, known, k, group.mode[k][lane], w.lane_block(lane) + k * u.texels());
    }
  }
  w.load_references(u, references);
}

void choose_modes_exactly(const Update& u, std::size_t g, const Tables& tables, Group& group,
                          Workspace& w) {
  if (u.layout.pairs && !u.update) return;
  Estimates estimates[2];
  choose_modes(u, g, group, w, estimates);
  // One kind after the other: the second plane's contexts see the first one's residuals.
  for (unsigned kind = 0; kind < kinds_of(u); ++kind) {
    std::array<std::array<std::uint16_t, kModes>, kLanes> ranking;
    for (unsigned l = 0; l < kLanes; ++l) {
      for (unsigned m = 0; m < kModes; ++m) ranking[l][m] = static_cast<std::uint16_t>(m);
      std::ranges::stable_sort(ranking[l], {}, [&](unsigned m) { return estimates[kind][l][m]; });
    }
    const unsigned context = mode_context(u.layout.pairs, u.update, kind);
    const unsigned first = u.layout.pairs ? pair_row(u.update, kind, 0) : 0;
    const unsigned last = u.layout.pairs ? first + kModes : kPlaneRows;
    std::array<std::uint32_t, kLanes> least;
    std::array<std::uint16_t, kLanes> best{};
    least.fill(UINT32_MAX);
    for (unsigned attempt = 0; attempt < kExactTries; ++attempt) {
      alignas(64) std::uint32_t cost[kLanes];
      for (unsigned l = 0; l < kLanes; ++l) {
        const std::uint16_t m = ranking[l][attempt];
        group.mode[kind][l] = m;
        cost[l] = distribution(tables, context).prices[m];
      }
      load_modes(u, g, group, w);
      Step* const begin = w.steps.data();
      const Step* end = u.layout.pairs ? u.kernels.model_pairs(group, begin)
                                       : u.kernels.model_planes(group, begin);
      u.kernels.price_steps(begin, end, first * kRowSize, last * kRowSize, tables, cost);
      for (unsigned l = 0; l < kLanes; ++l) {
        if (cost[l] < least[l]) {
          least[l] = cost[l];
          best[l] = group.mode[kind][l];
        }
      }
    }
    std::copy(best.begin(), best.end(), std::begin(group.mode[kind]));
  }
  load_modes(u, g, group, w);
}

}  // namespace gicodec::native
