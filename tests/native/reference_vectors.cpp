#include "native/reference_vectors.h"

#include "native/reference_lights.h"

#include <algorithm>
#include <map>

namespace gicodec::reference {
namespace {

/// Distances of the places around a vertex.
std::vector<std::array<int, 3>> vertices_around() {
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

class Vectors : Lights {
 public:
  Vectors(const TextureDesc& desc, const HeldBlocks& held, BitModels& models)
      : Lights(desc.record, models), around_(vertices_around()) {
    for (const auto& [place, bytes] : held) {
      known_[place] = {scale_.vertex_of(bytes), {}, true, {}};
    }
  }

  std::vector<std::byte> block(const AdaptiveBlock& in) {
    const Vertex previous = in.previous.empty() ? Vertex{} : scale_.vertex_of(in.previous);
    has_previous_ = previous != Vertex{};
    now_ = {};
    if (find_neighbours(in.place)) {
      predict(previous, true, 0);
      lights(previous);
      last_ = now_;
      had_light_ = true;
    }
    known_[in.place] = {now_, previous, false, {}};
    return scale_.bytes_of(now_);
  }

 private:
  /// Finds the vertices around and reads whether this one has light.
  bool find_neighbours(const std::array<std::uint32_t, 3>& place) {
    near_.clear();
    for (const auto& by : around_) {
      std::array<std::uint32_t, 3> at{};
      for (unsigned i = 0; i < 3; ++i) at[i] = place[i] + static_cast<std::uint32_t>(by[i]);
      const auto found = known_.find(at);
      if (found == known_.end() || (found->second.held && has_previous_)) continue;
      near_.push_back({by[0] * by[0] + by[1] * by[1] + by[2] * by[2], &found->second});
      if (near_.size() == 16) break;
    }
    return has_light();
  }

  void lights(const Vertex& previous) {
    residuals_ = {};
    lights_ = {};
    Number m = 0;
    for (unsigned h = 0; h < 6; ++h) {
      const bool same =
          has_previous_ &&
          models_.flag(2,
                       {{H({4, h}), m % 16}, {H({5, masks_, h}), 0}, {H({6, m, masks_ % 4}), h}});
      if (same) {
        m |= Number{1} << h;
        now_[h] = previous[h];
      } else {
        closes_ = h == 3 || h == 5;
        direction(h);
        color(h);
      }
      lights_[h] = scale_.light_of(now_[h]);
      compare(h);
    }
    masks_ = m;
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
    z_ = std::min(unit.length >> 16, 3 * kMax);
    b_ = half(z_ == 0 ? 1000000 : std::min<Number>(4 * all / z_, 1000000));
  }

  void direction(unsigned h) {
    const unsigned a = h / 2;
    const Number k = closes_ ? 1 : 0, sigma = h % 2 == 1 ? -1 : 1;
    predictors_.weigh([](const Predictor&) { return Number{0}; }, h);
    Number greatest = 0;
    for (const Predictor& g : predictors_.all)
      greatest = std::max(greatest, sum_of(g.lights[h].color));
    Three q{};
    for (const Predictor& g : predictors_.all) {
      for (unsigned i = 0; i < 3; ++i) {
        q[i] += g.weight * (g.lights[h].direction[i] >> 10) *
                (sum_of(g.lights[h].color) >> over(greatest, 24));
      }
    }
    const Three near = unit_of(q, h).v;
    const unsigned across[2] = {(a + 1) % 3, (a + 2) % 3};
    const Number spread = predictors_.mean([&](const Predictor& g) {
      const Three& d = g.lights[h].direction;
      return std::abs(d[across[0]] - near[across[0]]) + std::abs(d[across[1]] - near[across[1]]);
    });
    const Number s = predictors_.total == 0 ? 0 : half((127 * spread) >> 22);
    spread_of_predictors(h);
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
      const auto n = static_cast<Number>(std::min<std::size_t>(predictors_.all.size(), 9));
      const auto next = scale_.next_coordinate(x[c]);
      here.across[i] = models_.number(
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
        models_.number(4,
                       {H({30, g}), H({31, e, quarter}), H({32, f / 4, quarter}),
                        H({33, std::min<Number>(e, 4), alpha}), H({34, g, alpha})},
                       {{H({212, quarter}), 0}, {H({213, alpha}), 0}, {H({214, g, alpha}), 0}});
    now.direction[a] = scale_.coordinate_code(sigma > 0 ? sum : scale_.floats() ? -1 - sum : -sum);
    rho_ = half(std::abs(here.across[0]) + std::abs(here.across[1]));
  }

  std::vector<std::array<int, 3>> around_;
  std::map<std::array<std::uint32_t, 3>, Known> known_;
  Number masks_ = 0;  ///< m of the last vertex
};

}  // namespace

std::vector<std::vector<std::byte>> decode_vectors(const TextureDesc& desc,
                                                   const std::vector<AdaptiveBlock>& blocks,
                                                   const HeldBlocks& held, BitModels& models) {
  Vectors vectors(desc, held, models);
  std::vector<std::vector<std::byte>> out;
  for (const AdaptiveBlock& block : blocks) {
    out.push_back(vectors.block(block));
    if (models.source().missing()) return {};
  }
  return out;
}

}  // namespace gicodec::reference
