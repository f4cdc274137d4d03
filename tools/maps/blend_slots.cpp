#include "blend_slots.h"

namespace gicodec::maps {
namespace {

/// What is left of a blend, and what has found its slot.
struct Alignment {
  Blend left, placed;

  void place(std::size_t from, std::size_t to) {
    placed.basis[to] = left.basis[from];
    placed.weight[to] = left.weight[from];
    left.weight[from] = 0;
  }
  void follow(const Blend& neighbour) {
    for (std::size_t from = 0; from < kMapBlends; ++from) {
      for (std::size_t to = 0; to < kMapBlends && left.weight[from] != 0; ++to) {
        const bool same = neighbour.weight[to] != 0 && neighbour.basis[to] == left.basis[from];
        if (same && placed.weight[to] == 0) place(from, to);
      }
    }
  }
  /// Rather where the neighbour has nothing.
  void place_rest(const Blend& neighbour) {
    for (std::size_t from = 0; from < kMapBlends; ++from) {
      if (left.weight[from] == 0) continue;
      std::size_t to = kMapBlends;
      for (std::size_t slot = kMapBlends; slot-- > 0;) {
        if (placed.weight[slot] == 0 &&
            (to == kMapBlends || neighbour.weight[slot] == 0 || neighbour.weight[to] != 0)) {
          to = slot;
        }
      }
      place(from, to);
    }
    for (std::size_t slot = 0; slot < kMapBlends; ++slot) {
      if (placed.weight[slot] == 0) placed.basis[slot] = neighbour.basis[slot];
    }
  }
};

}  // namespace

void align_slots(std::span<const MapTexel> texels, std::uint32_t width, std::span<Blend> blends) {
  constexpr std::uint32_t kNone = ~0U;
  std::vector<std::uint32_t> above(width, kNone);  // the last texel of each column
  for (std::uint32_t i = 0; i < texels.size(); ++i) {
    const std::uint32_t place = texels[i].place;
    std::uint32_t& up = above[place % width];
    const bool has_left = i > 0 && place % width != 0 && texels[i - 1].place + 1 == place;
    const bool has_up = up != kNone && texels[up].place + width == place;
    Alignment alignment{blends[i], {}};
    if (has_left) alignment.follow(blends[i - 1]);
    if (has_up) alignment.follow(blends[up]);
    alignment.place_rest(has_left ? blends[i - 1] : has_up ? blends[up] : Blend{});
    blends[i] = alignment.placed;
    up = i;
  }
}

}  // namespace gicodec::maps
