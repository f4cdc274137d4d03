#include "native/reference_vectors.h"

#include "native/reference_vector_guesses.h"

#include <algorithm>
#include <map>

namespace gicodec::reference {
namespace {

/// Distances of the places around a vertex.
std::vector<std::array<int, 3>> around() {
  std::vector<std::array<int, 3>> all;
  const auto length = [](const auto& p) { return p[0] * p[0] + p[1] * p[1] + p[2] * p[2]; };
  for (int z = -3; z <= 3; ++z) {
    for (int y = -3; y <= 3; ++y) {
      for (int x = -3; x <= 3; ++x) {
        const std::array p{x, y, z};
        if (length(p) >= 1 && length(p) <= 9) all.push_back(p);
      }
    }
  }
  std::ranges::stable_sort(all, {}, length);
  return all;
}

class Vectors {
 public:
  Vectors(const TextureDesc& desc, const HeldBlocks& held, Learner& learner)
      : scale_(desc.record), learn_(learner), around_(around()) {
    for (const auto& [place, bytes] : held) {
      known_[place] = {scale_.vertex_of(bytes.data()), {}, true};
    }
  }

  std::vector<std::byte> block(const AdaptiveBlock& in) {
    const Vertex past = in.past.empty() ? Vertex{} : scale_.vertex_of(in.past.data());
    has_past_ = past != Vertex{};
    now_ = {};
    if (look_around(in.place)) {
      guess(past);
      lights(past);
      last_ = now_;
      had_light_ = true;
    }
    known_[in.place] = {now_, past, false};
    return scale_.bytes_of(now_);
  }

 private:
  struct Known {
    Vertex now, before;
    bool held = false;  ///< outside the update
  };
  struct Near {
    Number d;
    const Known* vertex;
  };
  struct Residuals {
    std::array<Number, 2> across{};
    Number exponent = 0, green = 0;
  };

  /// Finds the vertices around and reads whether this one has light.
  bool look_around(const std::array<std::uint32_t, 3>& place) {
    near_.clear();
    for (const auto& by : around_) {
      std::array<std::uint32_t, 3> at{};
      for (unsigned i = 0; i < 3; ++i) at[i] = place[i] + static_cast<std::uint32_t>(by[i]);
      const auto found = known_.find(at);
      if (found == known_.end() || (found->second.held && has_past_)) continue;
      near_.push_back({by[0] * by[0] + by[1] * by[1] + by[2] * by[2], &found->second});
      if (near_.size() == 16) break;
    }
    const auto n = static_cast<Number>(near_.size());
    Number n0 = 0, w0 = 0, w1 = 0;
    for (const Near& near : near_) {
      const bool zero = near.vertex->now == Vertex{};
      n0 += zero ? 1 : 0;
      w0 += zero ? 4096 / near.d : 0;
      w1 += 4096 / near.d;
    }
    const Number has = has_past_ ? 1 : 0, p = n == 0 ? 9 : 8 * n0 / n, w = n == 0 ? 9 : 8 * w0 / w1;
    return learn_.flag(has, {{H({1, p, has}), w}, {H({2, w}), has}, {H({3, n, n0}), has}});
  }

  void guess(const Vertex& past) {
    std::vector<std::pair<Number, const Known*>> from;
    const Known self{past, past, false}, last{last_, {}, false};
    if (has_past_) from.emplace_back(0, &self);
    for (const Near& near : near_) {
      if (near.vertex->now == Vertex{} || (has_past_ && near.vertex->before == Vertex{})) continue;
      from.emplace_back(near.d, near.vertex);
    }
    if (from.empty() && had_light_) from.emplace_back(16, &last);
    Number top = 0;
    for (const auto& [d, known] : from) {
      for (const Codes& codes : known->now) top = std::max(top, scale_.top_of(codes));
    }
    scale_.set_top(top);
    guesses_.all.clear();
    for (const auto& [d, known] : from) {
      Guess one{d};
      for (std::size_t h = 0; h < 6; ++h) {
        one.lights[h] = scale_.light_of(known->now[h]);
        if (has_past_ && d != 0) {
          one.lights[h] =
              moved(scale_.light_of(past[h]), one.lights[h], scale_.light_of(known->before[h]));
        }
      }
      guesses_.all.push_back(one);
    }
  }
  void lights(const Vertex& past) {
    residuals_ = {};
    lights_ = {};
    Number m = 0;
    for (unsigned h = 0; h < 6; ++h) {
      const bool same =
          has_past_ &&
          learn_.flag(2, {{H({4, h}), m % 16}, {H({5, masks_, h}), 0}, {H({6, m, masks_ % 4}), h}});
      if (same) {
        m |= Number{1} << h;
        now_[h] = past[h];
      } else {
        closes_ = h == 3 || h == 5;
        direction(h);
        color(h);
      }
      lights_[h] = scale_.light_of(now_[h]);
      for (Guess& g : guesses_.all) {
        g.unlike += unlike_directions(g.lights[h].direction, lights_[h].direction) +
                    unlike_colors(g.lights[h].color, lights_[h].color);
      }
    }
    masks_ = m;
  }

  /// γ, of some residual.
  template <class Of>
  [[nodiscard]] Number before(unsigned h, Of of) const {
    Number sum = 0;
    for (unsigned i = 0; i < h; ++i) sum += std::abs(of(residuals_[i]));
    return h == 0 ? 20 : half(2 * sum / h);
  }

  void close(unsigned h) {
    std::array<Three, 6> t{};
    Number all = 0;
    for (unsigned g = 0; g < h; ++g) {
      all += sum_of(lights_[g].color);
      for (unsigned i = 0; i < 3; ++i) {
        t[g][i] = lights_[g].direction[i] * (sum_of(lights_[g].color) >> 8);
      }
    }
    Three rest{};
    for (unsigned i = 0; i < 3; ++i) {
      rest[i] = h == 3 ? t[0][i] + t[1][i] - t[2][i]
                       : ((t[0][i] + t[1][i] + t[2][i] + t[3][i]) >> 1) - t[4][i];
    }
    const Unit unit = unit_of(rest, h);
    z_unit_ = unit.v;
    z_ = std::min(unit.length >> 16, 3 * kMost);
    b_ = half(z_ == 0 ? 1000000 : std::min<Number>(4 * all / z_, 1000000));
  }

  void direction(unsigned h) {
    const unsigned a = h / 2;
    const Number k = closes_ ? 1 : 0, sigma = h % 2 == 1 ? -1 : 1;
    guesses_.weigh([](const Guess&) { return Number{0}; }, h);
    Number greatest = 0, green = 0;
    for (const Guess& g : guesses_.all) greatest = std::max(greatest, sum_of(g.lights[h].color));
    Three q{};
    for (const Guess& g : guesses_.all) {
      for (unsigned i = 0; i < 3; ++i) {
        q[i] += g.weight * (g.lights[h].direction[i] >> 10) *
                (sum_of(g.lights[h].color) >> over(greatest, 24));
      }
    }
    const Three near = unit_of(q, h).v;
    const unsigned across[2] = {(a + 1) % 3, (a + 2) % 3};
    green = guesses_.mean([&](const Guess& g) { return g.lights[h].color[1]; });
    const Number off = guesses_.mean([&](const Guess& g) {
      const Three& d = g.lights[h].direction;
      return std::abs(d[across[0]] - near[across[0]]) + std::abs(d[across[1]] - near[across[1]]);
    });
    const Number varies =
        guesses_.mean([&](const Guess& g) { return std::abs(g.lights[h].color[1] - green); });
    const Number s = guesses_.total == 0 ? 0 : half((127 * off) >> 22);
    v_ = guesses_.total == 0
             ? 0
             : half(green == 0 ? 999 : std::min<Number>(64 * varies / green, 1000000));
    n_ = guesses_.all.empty() ? 9 : std::min<Number>(guesses_.all.front().d, 9);
    b_ = 0;
    if (closes_) close(h);
    const Three& x = closes_ ? z_unit_ : near;

    Codes& now = now_[h];
    Residuals& here = residuals_[h];
    Three values{};
    for (unsigned i = 0; i < 2; ++i) {
      const unsigned c = across[i];
      const Number q2 = 2 * k + i, r0 = here.across[0], r = i == 0 ? 0 : width_of(r0);
      const Number alpha = closes_ ? brought((254 * (near[c] - z_unit_[c]) + (1 << 23)) >> 24) : 0;
      const Number place = (127 * std::abs(x[c])) >> 28, high = (127 * std::abs(x[a])) >> 28;
      const Number beta = closes_ ? b_ : h % 2 == 1 ? half(residuals_[h - 1].across[i]) : 20;
      const Number gamma = before(
          h, [](const Residuals& of) { return std::abs(of.across[0]) + std::abs(of.across[1]); });
      const auto n = static_cast<Number>(std::min<std::size_t>(guesses_.all.size(), 9));
      const auto next = scale_.next_coordinate(x[c]);
      here.across[i] = learn_.number(
          static_cast<unsigned>(q2),
          {H({10 + q2, s, r}), H({14 + q2, beta, r, h}), H({18 + q2, n_, place, high}),
           H({22 + q2, s, beta, n}), H({26 + q2, closes_ ? alpha : gamma, b_, r})},
          {{H({200 + q2, 32 * sign(r0) + alpha}), 0},
           {H({204 + q2, next.quarter}), sign(r0)},
           {H({208 + q2, h, alpha}), 0}});
      now.direction[c] = scale_.coordinate_code(next.code + here.across[i]);
      values[c] = scale_.coordinate_value(now.direction[c]);
    }
    const Number u = values[across[0]], v = values[across[1]];
    const Number l = root_of(std::max<Number>((Number{1} << 48) - u * u - v * v, 0));
    const Number f = (127 * l + (1 << 23)) >> 24, g = std::min<Number>(f, 40);
    const Number e = (std::abs(u) + std::abs(v)) / std::max<Number>(l, (1 << 24) / 127);
    const Number alpha = brought((((sigma * x[a] - l) * 254 + (1 << 23)) >> 24) >> 1);
    const auto next = scale_.next_coordinate(l);
    const Number quarter = next.quarter;
    const Number sum =
        next.code +
        learn_.number(4,
                      {H({30, g}), H({31, e, quarter}), H({32, f / 4, quarter}),
                       H({33, std::min<Number>(e, 4), alpha}), H({34, g, alpha})},
                      {{H({212, quarter}), 0}, {H({213, alpha}), 0}, {H({214, g, alpha}), 0}});
    now.direction[a] = scale_.coordinate_code(sigma > 0 ? sum : scale_.floats() ? -1 - sum : -sum);
    rho_ = half(std::abs(here.across[0]) + std::abs(here.across[1]));
  }

  void color(unsigned h) {
    Codes& now = now_[h];
    Residuals& here = residuals_[h];
    Three way{};
    for (unsigned i = 0; i < 3; ++i) way[i] = scale_.coordinate_value(now.direction[i]);
    const auto off = [&](const Guess& g) { return unlike_directions(g.lights[h].direction, way); };
    guesses_.weigh(off, h + 1);
    const Three m = guesses_.mean_color(h);
    Three y = m;
    Number sum = 0;
    if (closes_) {
      Number o = 0, p = 0;
      for (unsigned i = 0; i < 3; ++i) {
        o += z_unit_[i] * way[i];
        p += way[i] * way[i];
      }
      const Number ratio =
          o > 0 ? std::min<Number>(256 * o / std::max<Number>(p >> 20, 1), 1 << 29) : 0;
      sum = std::min(((z_ >> 10) * ratio) >> 18, 3 * kMost);
      for (Number& c : y) c = sum_of(m) == 0 ? std::min(sum / 3, kMost) : prop(c, sum, sum_of(m));
    }
    const Number alpha = !closes_ ? 0 : brought(y[1] == 0 ? 0 : 32 * (m[1] - y[1]) / y[1]);
    const Number delta = h == 0 ? 0 : 2 + brought_into(residuals_[h - 1].exponent, -2, 2);
    const Number gamma = before(h, [](const Residuals& of) { return of.green; });
    const Number b = b_, v = v_, rho = rho_, k = closes_ ? 1 : 0;

    if (!scale_.floats()) {
      const Number most = std::max<Number>(std::ranges::max(y), 1);
      Number e = 0;
      while (e < 31 && steps(most, e - scale_.top() + 27) > 511) ++e;
      const Number mu = scale_.next_color(most, e) / 32;
      const Number by = learn_.number(
          static_cast<unsigned>(5 + k),
          {H({40 + k, mu, v}), H({42 + k, mu, n_}), H({44 + k, mu, rho}),
           H({46 + k, mu, closes_ ? b : delta}), H({48 + k, mu, alpha, h})},
          {{H({216 + k, mu}), 0}, {H({218 + k, delta, mu}), 0}, {H({220 + k, alpha, mu}), 0}});
      now.exponent = (e + by) & 31;
      here.exponent = now.exponent - e;
    }
    const Number epsilon = 2 + brought_into(here.exponent, -2, 2);

    const Number green = scale_.next_color(y[1], now.exponent), nu = half(green);
    const Number past_green = h == 0 ? 0 : residuals_[h - 1].green;
    const Number eta = h == 0 ? 20 : half(past_green);
    here.green = learn_.number(
        static_cast<unsigned>(7 + k),
        {H({60 + k, nu, v}), H({62 + k, nu, n_, epsilon}), H({64 + k, nu, rho, gamma}),
         H({66 + k, closes_ ? b : eta, nu, epsilon}), H({68 + k, closes_ ? alpha : gamma, nu, h})},
        {{H({222 + k, epsilon, delta}), sign(past_green)},
         {H({224 + k, nu, epsilon}), 0},
         {H({226 + k, alpha, h}), 0}});
    now.color[1] = scale_.color_code(green + here.green);
    const Three alone{0, scale_.color_value(now.color[1], now.exponent), 0};
    guesses_.weigh(
        [&](const Guess& g) {
          return off(g) + unlike_colors({0, g.lights[h].color[1], 0}, alone);
        },
        h + 1);
    red_and_blue(h, y, sum, gamma, alone[1]);
  }

  void red_and_blue(unsigned h, const Three& y, Number sum, Number gamma, Number green) {
    Codes& now = now_[h];
    const Three m = guesses_.mean_color(h);
    const Number g = residuals_[h].green, b = b_;
    Number r = 0;
    for (unsigned i = 0; i < 2; ++i) {
      const unsigned c = 2 * i;
      const Number p = m[1] == 0 ? y[c] : prop(m[c], green, m[1]);
      Number p2 = p;
      if (i == 1 && closes_) {
        p2 = brought_into(sum - green - scale_.color_value(now.color[0], now.exponent), 0, kMost);
      }
      const Number kappa = half(guesses_.mean([&](const Guess& guess) {
        const Three& of = guess.lights[h].color;
        return of[1] == 0 ? 0 : std::abs(ratio_of(of, c) - ratio_of(m, c));
      }) >> 4);
      const Number code = scale_.next_color(p2, now.exponent), nu = half(code);
      const Number tau = i == 1 && closes_ ? brought(scale_.next_color(p, now.exponent) - code) : 0;
      const Number q = (closes_ ? 2 : 0) + i;
      const Number by = learn_.number(static_cast<unsigned>(9 + q),
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
  Learner& learn_;
  std::vector<std::array<int, 3>> around_;
  std::map<std::array<std::uint32_t, 3>, Known> known_;
  Vertex last_{};
  bool had_light_ = false;
  Number masks_ = 0;  ///< m of the last vertex

  // Of a vertex.
  bool has_past_ = false;
  std::vector<Near> near_;
  Guesses guesses_;
  Vertex now_{};
  std::array<Light, 6> lights_{};
  std::array<Residuals, 6> residuals_{};

  // Of a hemisphere.
  bool closes_ = false;
  Three z_unit_{};
  Number z_ = 0, b_ = 0, v_ = 0, n_ = 0, rho_ = 0;
};

}  // namespace

std::vector<std::vector<std::byte>> decode_vectors(const TextureDesc& desc,
                                                   const std::vector<AdaptiveBlock>& blocks,
                                                   const HeldBlocks& held, Learner& learner) {
  Vectors vectors(desc, held, learner);
  std::vector<std::vector<std::byte>> out;
  for (const AdaptiveBlock& block : blocks) {
    out.push_back(vectors.block(block));
    if (learner.source().missing()) return {};
  }
  return out;
}

}  // namespace gicodec::reference
