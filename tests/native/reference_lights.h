// What the models of vertices and voxels share in the reference decoder (docs/native/light.md):
// whether there is light, predictors, colors.
#pragma once

#include "native/reference_light_predictors.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

namespace gicodec::reference {

class Lights {
 protected:
  Lights(const Record& record, BitModels& models) : scale_(record), models_(models) {}

  struct Known {
    Vertex now, before;
    bool held = false;  ///< outside the update
    std::optional<bool> occupancy_zero;
    [[nodiscard]] bool zero() const { return occupancy_zero.value_or(now == Vertex{}); }
  };
  struct Near {
    Number d;
    const Known* vertex;
  };
  struct Residuals {
    std::array<Number, 2> across{};
    Number exponent = 0, green = 0;
  };

  /// Whether this vertex has light, by those around.
  bool has_light() {
    const auto n = static_cast<Number>(near_.size());
    Number n0 = 0, w0 = 0, w1 = 0;
    for (const Near& near : near_) {
      const bool zero = near.vertex->zero();
      n0 += zero ? 1 : 0;
      w0 += zero ? 4096 / near.d : 0;
      w1 += 4096 / near.d;
    }
    const Number has = has_previous_ ? 1 : 0, p = n == 0 ? 9 : 8 * n0 / n,
                 w = n == 0 ? 9 : 8 * w0 / w1;
    return models_.flag(has, {{H({1, p, has}), w}, {H({2, w}), has}, {H({3, n, n0}), has}});
  }
  /// Predictors: the previous light, those around, and the last one with light, if it may be one.
  void predict(const Vertex& previous, bool may_be_last, Number more_top) {
    std::vector<std::pair<Number, const Known*>> from;
    const Known self{previous, previous, false, {}}, last{last_, {}, false, {}};
    if (has_previous_) from.emplace_back(0, &self);
    for (const Near& near : near_) {
      if (near.vertex->zero() || (has_previous_ && near.vertex->before == Vertex{})) continue;
      from.emplace_back(near.d, near.vertex);
    }
    if (from.empty() && had_light_ && may_be_last) from.emplace_back(16, &last);
    Number top = more_top;
    for (const auto& [d, known] : from) {
      top = std::max(top, scale_.top_of(known->now));
    }
    scale_.set_top(top);
    predictors_.all.clear();
    for (const auto& [d, known] : from) {
      Predictor one{d};
      for (std::size_t h = 0; h < 6; ++h) {
        one.lights[h] = scale_.light_of(known->now[h]);
        if (has_previous_ && d != 0) {
          one.lights[h] =
              moved(scale_.light_of(previous[h]), one.lights[h], scale_.light_of(known->before[h]));
        }
      }
      predictors_.all.push_back(one);
    }
  }

  /// V and N, by the weights that there are.
  void spread_of_predictors(unsigned h) {
    const Number green = predictors_.mean_of_colors(h, [](const Three& of) { return of[1]; });
    const Number varies =
        predictors_.mean_of_colors(h, [&](const Three& of) { return std::abs(of[1] - green); });
    const Number lit = predictors_.weight_of_colors(h);
    v_ = lit == 0 ? 0 : half(green == 0 ? 999 : std::min<Number>(64 * varies / green, 1000000));
    n_ = predictors_.all.empty() ? 9 : std::min<Number>(predictors_.all.front().d, 9);
  }
  /// Updates the dissimilarity of the predictors by a hemisphere that was coded.
  void compare(unsigned h) {
    for (Predictor& g : predictors_.all) {
      g.dissimilarity += direction_distance(g.lights[h].direction, lights_[h].direction) +
                         color_distance(g.lights[h].color, lights_[h].color);
    }
  }

  /// γ, of some residual.
  template <class Of>
  [[nodiscard]] Number before(unsigned h, Of of) const {
    Number sum = 0;
    for (unsigned i = 0; i < h; ++i) sum += std::abs(of(residuals_[i]));
    return h == 0 ? 20 : half(2 * sum / h);
  }

  void color(unsigned h) {
    Codes& now = now_[h];
    Residuals& here = residuals_[h];
    Three direction{};
    for (unsigned i = 0; i < 3; ++i) direction[i] = scale_.coordinate_value(now.direction[i]);
    const auto distance = [&](const Predictor& g) {
      return direction_distance(g.lights[h].direction, direction);
    };
    predictors_.weigh(distance, h + 1);
    const Three m = predictors_.mean_color(h);
    Three y = m;
    Number sum = 0;
    if (completed_) {
      y = completed_->color;
    } else if (closes_) {
      Number o = 0, p = 0;
      for (unsigned i = 0; i < 3; ++i) {
        o += z_unit_[i] * direction[i];
        p += direction[i] * direction[i];
      }
      const Number ratio =
          o > 0 ? std::min<Number>(256 * o / std::max<Number>(p >> 20, 1), 1 << 29) : 0;
      sum = std::min(((z_ >> 10) * ratio) >> 18, 3 * kMax);
      for (Number& c : y) c = sum_of(m) == 0 ? std::min(sum / 3, kMax) : prop(c, sum, sum_of(m));
    }
    const Number alpha = completed_ ? completed_->siblings
                         : !closes_ ? 0
                                    : brought(y[1] == 0 ? 0 : 32 * (m[1] - y[1]) / y[1]);
    const Number delta = h == 0 ? 0 : 2 + brought_into(residuals_[h - 1].exponent, -2, 2);
    const Number gamma = before(h, [](const Residuals& of) { return of.green; });
    const Number v = v_, rho = rho_, k = closes_ ? 1 : 0;

    if (!scale_.floats()) {
      const Number most = std::max<Number>(std::ranges::max(y), 1);
      Number e = 0;
      while (e < 31 && steps(most, e - scale_.top() + 27) > 511) ++e;
      const Number mu = scale_.next_color(most, e) / 32;
      if (completed_) b_ = rounding({{}, {}, e, 0});
      const Number by = models_.number(
          static_cast<unsigned>(5 + k),
          {H({40 + k, mu, v}), H({42 + k, mu, n_}), H({44 + k, mu, rho}),
           H({46 + k, mu, closes_ ? b_ : delta}), H({48 + k, mu, alpha, h})},
          {{H({216 + k, mu}), 0}, {H({218 + k, delta, mu}), 0}, {H({220 + k, alpha, mu}), 0}});
      now.exponent = (e + by) & 31;
      here.exponent = now.exponent - e;
    }
    const Number epsilon = 2 + brought_into(here.exponent, -2, 2);

    const Number green = scale_.next_color(y[1], now.exponent), nu = half(green);
    if (completed_) b_ = rounding({{0, green, 0}, {}, now.exponent, 0});
    const Number last_green = h == 0 ? 0 : residuals_[h - 1].green;
    const Number eta = h == 0 ? 20 : half(last_green);
    here.green = models_.number(
        static_cast<unsigned>(7 + k),
        {H({60 + k, nu, v}), H({62 + k, nu, n_, epsilon}), H({64 + k, nu, rho, gamma}),
         H({66 + k, closes_ ? b_ : eta, nu, epsilon}), H({68 + k, closes_ ? alpha : gamma, nu, h})},
        {{H({222 + k, epsilon, delta}), sign(last_green)},
         {H({224 + k, nu, epsilon}), 0},
         {H({226 + k, alpha, h}), 0}});
    now.color[1] = scale_.color_code(green + here.green);
    const Three alone{0, scale_.color_value(now.color[1], now.exponent), 0};
    predictors_.weigh(
        [&](const Predictor& g) {
          return distance(g) + color_distance({0, g.lights[h].color[1], 0}, alone);
        },
        h + 1);
    red_and_blue(h, y, sum, gamma, alone[1]);
  }

  /// B of what is completed, by the codes that the step is of.
  [[nodiscard]] Number rounding(const Codes& codes) const {
    const Number u = scale_.step_of(codes);
    return half(std::min<Number>(
        4 * completed_->siblings * completed_->unit / std::max<Number>(u, 1), 1000000));
  }

  void red_and_blue(unsigned h, const Three& y, Number sum, Number gamma, Number green) {
    Codes& now = now_[h];
    const Three m = predictors_.mean_color(h);
    const Number g = residuals_[h].green, b = b_;
    Number r = 0;
    for (unsigned i = 0; i < 2; ++i) {
      const unsigned c = 2 * i;
      const Number p = m[1] == 0 || completed_ ? y[c] : prop(m[c], green, m[1]);
      Number p2 = p;
      if (i == 1 && closes_ && !completed_) {
        p2 = brought_into(sum - green - scale_.color_value(now.color[0], now.exponent), 0, kMax);
      }
      const Number kappa = half(predictors_.mean_of_colors(h, [&](const Three& of) {
        return of[1] == 0 ? 0 : std::abs(ratio_of(of, c) - ratio_of(m, c));
      }) >> 4);
      const Number code = scale_.next_color(p2, now.exponent), nu = half(code);
      const Number tau =
          i == 1 && closes_ && !completed_ ? brought(scale_.next_color(p, now.exponent) - code) : 0;
      const Number q = (closes_ ? 2 : 0) + i;
      const Number by = models_.number(static_cast<unsigned>(9 + q),
                                       {H({80 + q, nu, kappa}), H({84 + q, nu, half(g), b}),
                                        H({88 + q, half(r), kappa, std::min<Number>(half(g), 8)}),
                                        H({92 + q, closes_ ? b : n_, nu, half(r)}),
                                        H({96 + q, nu, closes_ ? tau : gamma, rho_})},
                                       {{H({228 + q, 3 * sign(g) + sign(r), tau}), 0},
                                        {H({232 + q, nu, sign(r)}), 0},
                                        {H({236 + q, sign(g), half(g)}), 0}});
      now.color[c] = scale_.color_code(code + by);
      r = by;
    }
  }

  Scale scale_;
  BitModels& models_;
  Vertex last_{};
  bool had_light_ = false;

  // Of a vertex.
  bool has_previous_ = false;
  std::vector<Near> near_;
  Predictors predictors_;
  Vertex now_{};
  std::array<Light, 6> lights_{};
  std::array<Residuals, 6> residuals_{};

  // Of a hemisphere.
  bool closes_ = false;
  struct Completed {
    Three color;
    Number siblings, unit;
  };
  std::optional<Completed> completed_;
  Three z_unit_{};
  Number z_ = 0, b_ = 0, v_ = 0, n_ = 0, rho_ = 0;
};

}  // namespace gicodec::reference
