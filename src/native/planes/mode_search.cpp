#include "native/planes/mode_search.h"

#include <algorithm>
#include <array>

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

/// Texels that an estimate samples, in whole rows, where it decides.
constexpr unsigned kSampled = 24;
/// Where it ranks modes for the exact search: those texels, and the number of modes.
struct Search {
  unsigned sampled, tries;
};
constexpr Search kPlaneSearch = {32, 3}, kPairSearch = {kMaxSampled, 2};
const Search& search_of(const Update& u) { return u.layout.pairs ? kPairSearch : kPlaneSearch; }

using LaneKnown = std::array<Known, kLanes>;

LaneKnown known_in_lanes(const Update& u, std::size_t g, const Workspace& w) {
  LaneKnown known;
  const std::uint32_t first = w.chunk.group_begin[g];
  for (std::uint32_t b = first; b < w.chunk.group_begin[g + 1]; ++b)
    known[b - first] = w.known(u, b);
  return known;
}

/// What modes [first, end), which share a reference, cost in every lane of a group.
void estimate(const Update& u, unsigned sampled, unsigned kind, unsigned first, unsigned end,
              const LaneKnown& known, const Group& group, Workspace& w,
              std::uint16_t (*cost)[kLanes]) {
  const Mode& mode = mode_of(u, kind, first);
  const unsigned width = u.width(), planes = u.layout.pairs ? 1 : w.planes();
  const unsigned rows = std::clamp(sampled / width, 1U, u.rows());
  // Counted records are the first ones.
  const unsigned first_row = u.desc.presence == Presence::count ? 0 : (u.rows() - rows + 1) / 2;
  // The row above is read too.
  const std::size_t from = first_row == 0 ? 0 : (first_row - 1) * width;
  const std::size_t part = (first_row + rows) * width - from;
  // Planes in one go where little lies between their parts.
  const unsigned goes = 2 * part < u.texels() ? planes : std::min(planes, 1U);
  const std::size_t count = part + (planes - goes) * u.texels();
  std::uint32_t tried = 0;
  for (unsigned l = 0; l < kLanes; ++l) {
    if ((group.active >> l & 1) != 0 && usable(mode, known[l])) tried |= 1U << l;
  }
  if (tried != 0) {
    for (unsigned p = 0; p < goes; ++p) {
      Workspace::LaneBlocks blocks;
      for (unsigned l = 0; l < kLanes; ++l) {
        blocks[l] = (tried >> l & 1) == 0
                        ? w.zero_block()
                        : lane_reference(u, w, known[l], mode, (kind + p) * u.texels() + from,
                                         count, w.lane_block(l));
      }
      w.load_reference_part(u, blocks, p * u.texels() + from, count);
    }
    const bool scaled = u.layout.shared && planes == u.layout.planes;
    u.kernels.cost({group.current + kind * u.texels() * kLanes, group.reference, group.present,
                    u.texels(), width, planes, first_row, rows, scaled, u.layout.plane[0].bits > 11,
                    &mode, end - first, w.cost_scratch()},
                   cost);
  }
  for (unsigned l = 0; l < kLanes; ++l) {
    if ((tried >> l & 1) != 0) continue;
    for (unsigned m = 0; m < end - first; ++m) cost[m][l] = UINT16_MAX;
  }
}

void load_modes(const Update& u, const LaneKnown& known, const Group& group, Workspace& w) {
  const std::size_t count = u.layout.pairs ? u.texels() : w.planes() * u.texels();
  Workspace::LaneBlocks references[2];
  for (auto& r : references) r.fill(w.zero_block());
  for (unsigned l = 0; l < kLanes; ++l) {
    if ((group.active >> l & 1) == 0) continue;
    for (unsigned k = 0; k < kinds_of(u); ++k) {
      const std::size_t at = k * u.texels();
      references[k][l] = lane_reference(u, w, known[l], mode_of(u, k, group.mode[k][l]), at, count,
                                        w.lane_block(l) + at);
    }
  }
  w.load_references(u, references);
}

}  // namespace

void choose_modes(const Update& u, std::size_t g, Group& group, Workspace& w,
                  Estimates* estimates) {
  if (u.layout.pairs && !u.update) return;
  const LaneKnown known = known_in_lanes(u, g, w);
  // Where not all exist, as few again.
  const unsigned sampled = group.present != nullptr ? kMaxSampled
                           : estimates != nullptr   ? search_of(u).sampled
                                                    : kSampled;
  Estimates own;
  for (unsigned kind = 0; kind < kinds_of(u); ++kind) {
    auto& cost = (estimates != nullptr ? estimates[kind] : own).cost;
    for (unsigned m = 0, end = 0; m < kModes; m = end) {
      for (end = m + 1; end < kModes && same_reference(mode_of(u, kind, m), mode_of(u, kind, end));)
        ++end;
      estimate(u, sampled, kind, m, end, known, group, w, cost + m);
    }
    for (unsigned l = 0; l < kLanes; ++l) {
      std::uint32_t least = UINT32_MAX;
      for (unsigned m = 0; m < kModes; ++m) {
        const std::uint32_t c = cost[m][l] + kModeCost * m;
        if (c >= least) continue;
        least = c;
        group.mode[kind][l] = static_cast<std::uint16_t>(m);
      }
    }
  }
  load_modes(u, known, group, w);
}

void load_modes(const Update& u, std::size_t g, const Group& group, Workspace& w) {
  if (u.layout.pairs && !u.update) return;
  load_modes(u, known_in_lanes(u, g, w), group, w);
}

void choose_modes_exactly(const Update& u, std::size_t g, const Tables& tables, Group& group,
                          Workspace& w) {
  if (u.layout.pairs && !u.update) return;
  Estimates estimates[2];
  choose_modes(u, g, group, w, estimates);
  // One kind after the other: the second plane's contexts depend on the first one's residuals.
  for (unsigned kind = 0; kind < kinds_of(u); ++kind) {
    std::array<std::array<std::uint16_t, kModes>, kLanes> ranking;
    for (unsigned l = 0; l < kLanes; ++l) {
      // By insertion: the first among equals stays the first.
      for (unsigned m = 0; m < kModes; ++m) {
        const auto dearer = [&](unsigned n) {
          return estimates[kind].cost[n][l] > estimates[kind].cost[m][l];
        };
        unsigned at = m;
        for (; at > 0 && dearer(ranking[l][at - 1]); --at) ranking[l][at] = ranking[l][at - 1];
        ranking[l][at] = static_cast<std::uint16_t>(m);
      }
    }
    const unsigned context = mode_context(u.layout.pairs, u.update, kind);
    const RoleTables& modes = *tables.role[kModePlace];
    std::array<std::uint32_t, kLanes> least;
    std::array<std::uint16_t, kLanes> best{};
    least.fill(UINT32_MAX);
    for (unsigned attempt = 0; attempt < search_of(u).tries; ++attempt) {
      alignas(64) std::uint32_t cost[kLanes];
      for (unsigned l = 0; l < kLanes; ++l) {
        const std::uint16_t m = ranking[l][attempt];
        group.mode[kind][l] = m;
        cost[l] = static_cast<std::uint32_t>(modes.price[modes.map[context]][bin_of(m)]);
      }
      load_modes(u, g, group, w);
      Step* const begin = w.steps.data();
      const Step* end = u.layout.pairs ? u.kernels.model_pairs(group, begin)
                                       : u.kernels.model_planes(group, begin);
      const unsigned places = u.layout.pairs ? kind + 1 : residual_places(false);
      for (unsigned place = kind; place < places; ++place) {
        u.kernels.price_steps(begin, end, place, *tables.role[place], cost);
      }
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
