#include "train/histograms.h"

#include <algorithm>
#include <bit>

namespace gicodec::train {

Subject subject_of(bool pairs, bool update, unsigned place) {
  if (place == native::kModePlace) return Subject(kModes + 2U * pairs + update);
  if (pairs && place == native::kRepeatPlace) return Subject(kRepeatTables + unsigned{update});
  return Subject(kResiduals + native::role_of(pairs, update, place));
}

void Counter::add(const native::Step* begin, const native::Step* end) {
  for (const auto* s = begin; s != end; ++s) {
    const bool repeats = pairs_ && s->place == native::kRepeatPlace;
    Counts* const counts = counts_.data() + std::size_t{s->place} * native::kContexts;
    for (std::uint32_t rest = s->active; rest != 0; rest &= rest - 1) {
      const auto l = static_cast<unsigned>(std::countr_zero(rest));
      ++counts[s->context[l]][repeats ? s->value[l] : native::bin_of(s->value[l])];
    }
  }
}

void Counter::finish(bool wide, std::array<std::vector<Histogram>, kSubjects>& out) const {
  for (unsigned place = 0; place < native::kPlaces; ++place) {
    Histogram h{wide, {}};
    for (unsigned c = 0; c < native::kContexts; ++c) {
      const Counts& counts = counts_[place * native::kContexts + c];
      if (std::ranges::any_of(counts, [](auto n) { return n > 0; })) {
        h.cells.push_back({static_cast<std::uint16_t>(c), counts});
      }
    }
    if (!h.cells.empty()) out[subject_of(pairs_, update_, place)].push_back(std::move(h));
  }
}

}  // namespace gicodec::train
