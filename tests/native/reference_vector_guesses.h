// Guesses of light for the reference decoder (docs/native.md, sections 9.5 and 9.6).
#pragma once

#include "native/reference_vector_values.h"

#include <vector>

namespace gicodec::reference {

struct Guess {
  Number d;
  std::array<Light, 6> lights{};
  Number unlike = 0, weight = 0;
  Number nearness = 0;  ///< if it does not follow from d
  [[nodiscard]] Number near() const { return nearness != 0 ? nearness : d == 0 ? 4096 : 4096 / d; }
};
/// What a change of a vertex around makes of the past.
[[nodiscard]] inline Light moved(const Light& past, const Light& now, const Light& old) {
  Light out;
  for (unsigned i = 0; i < 3; ++i) {
    out.direction[i] =
        brought_into(past.direction[i] + now.direction[i] - old.direction[i], -(1 << 24), 1 << 24);
    const Number v = past.color[i], to = now.color[i], by = old.color[i];
    out.color[i] = by == 0 ? std::min(v + to, kMost) : prop(v, std::min(to, 4 * by), by);
  }
  return out;
}

/// What a vertex may be like.
struct Guesses {
  std::vector<Guess> all;
  Number total = 0;  ///< of the weights

  template <class More>
  void weigh(More more, Number hemispheres) {
    Number greatest = 0;
    for (Guess& g : all) {
      const Number by = 32 + (g.unlike + more(g)) / std::max<Number>(hemispheres, 1);
      g.weight = (g.near() << 40) / (by * by);
      greatest = std::max(greatest, g.weight);
    }
    total = 0;
    for (Guess& g : all) total += g.weight >>= over(greatest, 12);
  }
  template <class Of>
  [[nodiscard]] Number mean(Of of) const {
    Number sum = 0;
    for (const Guess& g : all) sum += g.weight * of(g);
    return total == 0 ? 0 : sum / total;
  }
  /// Of those with light in that hemisphere.
  template <class Of>
  [[nodiscard]] Number mean_lit(unsigned h, Of of) const {
    Number sum = 0, weights = 0;
    for (const Guess& g : all) {
      if (g.lights[h].color == Three{}) continue;
      sum += g.weight * of(g);
      weights += g.weight;
    }
    return weights == 0 ? 0 : sum / weights;
  }
  [[nodiscard]] Three mean_color(unsigned h) const {
    Three out{};
    for (unsigned c = 0; c < 3; ++c) {
      out[c] = mean([&](const Guess& g) { return g.lights[h].color[c]; });
    }
    return out;
  }
};

}  // namespace gicodec::reference
