#include "session/priority.h"

#include <algorithm>
#include <tuple>

namespace gicodec {
namespace {

auto place(const Candidate& c) { return std::tuple(c.stream, c.probe); }

// Ties are broken by what the candidate is, so that the choice depends on nothing else.
auto rank(const Candidate& c) { return std::tuple(c.order, c.stream, c.probe); }

bool older(const Candidate& a, const Candidate& b) {
  return a.age != b.age ? a.age > b.age : rank(a) < rank(b);
}

}  // namespace

std::uint32_t spread_order(const Grid& grid, std::uint32_t probe) noexcept {
  constexpr std::uint32_t kGolden = 0x9E3779B1;
  const std::uint32_t x = probe % grid.x, y = probe / grid.x % grid.y, z = probe / grid.x / grid.y;
  return (x + y + z) % 2 << 31 | probe * kGolden >> 1;
}

void keep_oldest(std::vector<Candidate>& candidates, std::size_t limit) {
  if (candidates.size() <= limit) return;
  std::nth_element(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(limit),
                   candidates.end(), older);
  candidates.resize(limit);
}

void choose(std::vector<Candidate>& candidates, std::size_t limit) {
  if (candidates.size() > limit) {
    const auto heavier = [](const Candidate& a, const Candidate& b) {
      const float x = a.change * (1.0F + static_cast<float>(a.age));
      const float y = b.change * (1.0F + static_cast<float>(b.age));
      return x != y ? x > y : rank(a) < rank(b);
    };
    const auto first = candidates.begin();
    const auto by_age = first + static_cast<std::ptrdiff_t>((limit + 1) / 2);
    const auto end = first + static_cast<std::ptrdiff_t>(limit);
    std::nth_element(first, by_age, candidates.end(), older);
    std::nth_element(by_age, end, candidates.end(), heavier);
    candidates.resize(limit);
  }
  std::sort(candidates.begin(), candidates.end(),
            [&](const Candidate& a, const Candidate& b) { return place(a) < place(b); });
}

}  // namespace gicodec
