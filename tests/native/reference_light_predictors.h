// Predictors of light for the reference decoder (docs/native/light.md).
#pragma once

#include "native/reference_vector_values.h"

#include <vector>

namespace gicodec::reference {

struct Predictor {
  Number d;
  std::array<Light, 6> lights{};
  Number dissimilarity = 0, weight = 0;
  Number nearness = d == 0 ? 4096 : 4096 / d;
};
/// The previous light plus the change of a light around.
[[nodiscard]] inline Light moved(const Light& previous, const Light& now, const Light& old) {
  Light out;
  for (unsigned i = 0; i < 3; ++i) {
    out.direction[i] = brought_into(previous.direction[i] + now.direction[i] - old.direction[i],
                                    -(1 << 24), 1 << 24);
    const Number v = previous.color[i], to = now.color[i], by = old.color[i];
    out.color[i] = by == 0 ? std::min(v + to, kMax) : prop(v, std::min(to, 4 * by), by);
  }
  return out;
}

/// The predictors of a vertex.
struct Predictors {
  std::vector<Predictor> all;
  bool dark_too = true;  ///< statistics of colors include predictors without any
  Number total = 0;      ///< of the weights

  template <class More>
  void weigh(More more, Number hemispheres) {
    Number greatest = 0;
    for (Predictor& g : all) {
      const Number by = 32 + (g.dissimilarity + more(g)) / std::max<Number>(hemispheres, 1);
      g.weight = (g.nearness << 40) / (by * by);
      greatest = std::max(greatest, g.weight);
    }
    total = 0;
    for (Predictor& g : all) total += g.weight >>= over(greatest, 12);
  }
  template <class Of>
  [[nodiscard]] Number mean(Of of) const {
    Number sum = 0;
    for (const Predictor& g : all) sum += g.weight * of(g);
    return total == 0 ? 0 : sum / total;
  }
  /// A mean over colors.
  template <class Of>
  [[nodiscard]] Number mean_of_colors(unsigned h, Of of) const {
    Number sum = 0;
    for (const Predictor& g : all) {
      if (tells_of_colors(g, h)) sum += g.weight * of(g.lights[h].color);
    }
    const Number weights = weight_of_colors(h);
    return weights == 0 ? 0 : sum / weights;
  }
  [[nodiscard]] Number weight_of_colors(unsigned h) const {
    Number weights = 0;
    for (const Predictor& g : all) weights += tells_of_colors(g, h) ? g.weight : 0;
    return weights;
  }
  [[nodiscard]] bool tells_of_colors(const Predictor& g, unsigned h) const {
    return dark_too || g.lights[h].color != Three{};
  }
  [[nodiscard]] Three mean_color(unsigned h) const {
    Three out{};
    for (unsigned c = 0; c < 3; ++c) {
      out[c] = mean_of_colors(h, [&](const Three& of) { return of[c]; });
    }
    return out;
  }
};

}  // namespace gicodec::reference
