#include "native/reference_voxels.h"

#include "native/reference_vector_guesses.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>

namespace gicodec::reference {
namespace {

using Three32 = std::array<std::uint32_t, 3>;

/// A brick as far as it is known, voxel by voxel.
struct Brick {
  std::uint64_t place = 0;
  std::vector<std::optional<Vertex>> now, past;
};
struct Voxel {
  const Vertex* now = nullptr;
  const Vertex* past = nullptr;
};

std::uint64_t place_in(const std::vector<std::byte>& presence) {
  std::uint64_t place = 0;
  for (unsigned i = 0; i < 8; ++i) {
    place |= std::to_integer<std::uint64_t>(presence[i]) << (8 * i);
  }
  return place;
}
/// Every third bit of a number, from one on, 18 of them; and the reverse.
std::uint32_t bits_from(std::uint64_t key, unsigned first) {
  std::uint32_t out = 0;
  for (unsigned i = 0; i < 18; ++i) {
    out |= static_cast<std::uint32_t>(key >> (3 * i + first) & 1) << i;
  }
  return out;
}
std::uint64_t key_of(const Three32& at) {
  std::uint64_t key = 0;
  for (unsigned i = 0; i < 18; ++i) {
    for (unsigned axis = 0; axis < 3; ++axis) {
      key |= std::uint64_t{at[axis] >> i & 1} << (3 * i + axis);
    }
  }
  return key;
}

class Voxels {
 public:
  Voxels(const TextureDesc& desc, Learner& learner)
      : side_(desc.block.y), record_(desc.record.bytes), scale_(desc.record), learn_(learner) {
    for (int z = -1; z <= 1; ++z) {
      for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) {
          if (x != 0 || y != 0 || z != 0) offsets_.push_back({x, y, z});
        }
      }
    }
    std::ranges::stable_sort(offsets_, {}, length);
  }

  void hold(const HeldBrick& brick) {
    const Brick held = brick_of(brick.presence, brick.records, {}, {});
    if (std::ranges::none_of(held.now, [](const auto& v) { return v.has_value(); })) return;
    held_.emplace(name_of(held.place), held);
  }

  std::vector<std::byte> block(const AdaptiveBlock& in) {
    here_ = brick_of(in.presence, {}, in.past_presence, in.past);
    find_around();
    std::vector<std::byte> out(side_ * side_ * side_ * 6 * record_);
    for (unsigned m = 0; m < side_ * side_ * side_; ++m) {
      const std::array<int, 3> at = place_of(m);
      const std::size_t number = number_of(at);
      if ((std::to_integer<unsigned>(in.presence[8 + number / 8]) >> number % 8 & 1) == 0) continue;
      const auto& past = here_.past[number];
      has_past_ = past.has_value() && *past != Vertex{};
      past_ = has_past_ ? *past : Vertex{};
      now_ = {};
      voxel(m, at, in.presence);
      here_.now[number] = now_;
      std::ranges::copy(scale_.bytes_of(now_),
                        out.begin() + static_cast<std::ptrdiff_t>(number * 6 * record_));
    }
    coded_.emplace(name_of(here_.place), here_);
    return out;
  }

  /// What the order goes by: the level from the highest on, then the key.
  [[nodiscard]] static std::pair<Number, std::uint64_t> order_of(
      const std::vector<std::byte>& presence) {
    const std::uint64_t place = place_in(presence);
    return {-static_cast<Number>(place >> 56), place & ((std::uint64_t{1} << 54) - 1)};
  }

 private:
  /// Level and key.
  using Name = std::pair<std::uint64_t, std::uint64_t>;
  static Name name_of(std::uint64_t place) {
    return {place >> 56, place & ((std::uint64_t{1} << 54) - 1)};
  }
  static int length(const std::array<int, 3>& p) { return p[0] * p[0] + p[1] * p[1] + p[2] * p[2]; }
  static std::array<int, 3> place_of(unsigned m) {
    return {static_cast<int>(bits_from(m, 0)), static_cast<int>(bits_from(m, 1)),
            static_cast<int>(bits_from(m, 2))};
  }
  [[nodiscard]] std::size_t number_of(const std::array<int, 3>& at) const {
    return static_cast<std::size_t>(at[0]) +
           side_ * (static_cast<std::size_t>(at[1]) + side_ * static_cast<std::size_t>(at[2]));
  }

  /// `past` counts only where it stood at the same place.
  [[nodiscard]] Brick brick_of(const std::vector<std::byte>& presence,
                               const std::vector<std::byte>& records,
                               const std::vector<std::byte>& past_presence,
                               const std::vector<std::byte>& past) const {
    const std::size_t voxels = std::size_t{side_} * side_ * side_;
    Brick brick{place_in(presence), std::vector<std::optional<Vertex>>(voxels),
                std::vector<std::optional<Vertex>>(voxels)};
    const auto fill = [&](const auto& mask, const auto& from, auto& to) {
      for (std::size_t v = 0; v < voxels && !from.empty(); ++v) {
        if ((std::to_integer<unsigned>(mask[8 + v / 8]) >> v % 8 & 1) == 0) continue;
        to[v] = scale_.vertex_of(from.data() + v * 6 * record_);
      }
    };
    fill(presence, records, brick.now);
    if (!past_presence.empty() && place_in(past_presence) == brick.place) {
      fill(past_presence, past, brick.past);
    }
    return brick;
  }

  const Brick* find(std::uint64_t level, const Three32& at) const {
    const Name name{level % 256, key_of(at)};
    if (const auto found = coded_.find(name); found != coded_.end()) return &found->second;
    const auto found = held_.find(name);
    return found == held_.end() ? nullptr : &found->second;
  }

  void find_around() {
    const auto [level, key] = name_of(here_.place);
    at_ = {bits_from(key, 0), bits_from(key, 1), bits_from(key, 2)};
    around_.clear();
    for (const auto& by : offsets_) {
      Three32 at{};
      bool inside = true;
      for (unsigned i = 0; i < 3; ++i) {
        const std::int64_t to = std::int64_t{at_[i]} + by[i];
        inside = inside && to >= 0 && to < 1 << 18;
        at[i] = static_cast<std::uint32_t>(to);
      }
      if (const Brick* brick = inside ? find(level, at) : nullptr) around_[by] = brick;
    }
    parent_ = find(level + 1, {at_[0] / 2, at_[1] / 2, at_[2] / 2});
  }

  [[nodiscard]] static Voxel in(const Brick* brick, std::size_t number) {
    if (brick == nullptr || !brick->now[number].has_value()) return {};
    const auto& past = brick->past[number];
    return {&*brick->now[number], past.has_value() ? &*past : nullptr};
  }

  void voxel(unsigned m, const std::array<int, 3>& at, const std::vector<std::byte>& presence) {
    look_around(at);
    family(m, at, presence);
    const auto n = static_cast<Number>(near_.size());
    Number n0 = 0, w0 = 0, w1 = 0;
    for (const auto& [d, other] : near_) {
      const bool zero = *other.now == Vertex{};
      n0 += zero ? 1 : 0;
      w0 += zero ? 4096 / d : 0;
      w1 += 4096 / d;
    }
    const Number has = has_past_ ? 1 : 0, p = n == 0 ? 9 : 8 * n0 / n, w = n == 0 ? 9 : 8 * w0 / w1;
    if (!learn_.flag(has, {{H({1, p, has}), w}, {H({2, w}), has}, {H({3, n, n0}), has}})) return;
    guess();
    hemispheres();
    last_ = now_;
    had_light_ = true;
  }

  void look_around(const std::array<int, 3>& at) {
    near_.clear();
    const auto side = static_cast<int>(side_);
    for (const auto& by : offsets_) {
      std::array<int, 3> to{}, brick{};
      for (unsigned i = 0; i < 3; ++i) {
        to[i] = at[i] + by[i];
        brick[i] = to[i] < 0 ? -1 : to[i] < side ? 0 : 1;
        to[i] -= side * brick[i];
      }
      const Brick* from = &here_;
      if (brick != std::array<int, 3>{}) {
        const auto found = around_.find(brick);
        from = found == around_.end() ? nullptr : found->second;
      }
      const Voxel other = in(from, number_of(to));
      if (other.now == nullptr || (has_past_ && other.past == nullptr)) continue;
      near_.emplace_back(length(by), other);
      if (near_.size() == 3) break;
    }
  }

  void family(unsigned m, const std::array<int, 3>& at, const std::vector<std::byte>& presence) {
    siblings_.clear();
    children_ = 0;
    std::array<int, 3> above{};
    for (unsigned i = 0; i < 3; ++i) {
      above[i] = (static_cast<int>(at_[i] % 2) * static_cast<int>(side_) + at[i]) / 2;
    }
    above_ = in(parent_, number_of(above));
    for (unsigned child = m / 8 * 8; child < m / 8 * 8 + 8; ++child) {
      const std::size_t number = number_of(place_of(child));
      if ((std::to_integer<unsigned>(presence[8 + number / 8]) >> number % 8 & 1) == 0) continue;
      ++children_;
      if (child < m) siblings_.push_back(in(&here_, number));
    }
  }

  void guess() {
    std::vector<std::pair<Number, Voxel>> from;
    if (has_past_) from.push_back({0, {&past_, &past_}});
    for (const auto& [d, other] : near_) {
      if (*other.now == Vertex{} || (has_past_ && *other.past == Vertex{})) continue;
      from.emplace_back(d, other);
    }
    if (from.empty() && above_.now == nullptr && had_light_)
      from.push_back({16, {&last_, nullptr}});
    Number top = 0;
    const auto raise = [&](const Vertex& by) {
      for (const Codes& codes : by) top = std::max(top, scale_.top_of(codes));
    };
    for (const auto& [d, other] : from) raise(*other.now);
    if (above_.now != nullptr) raise(*above_.now);
    scale_.set_top(top);
    guesses_.all.clear();
    for (const auto& [d, other] : from) {
      Guess one{d};
      for (std::size_t h = 0; h < 6; ++h) {
        one.lights[h] = scale_.light_of((*other.now)[h]);
        if (has_past_ && d != 0) {
          one.lights[h] =
              moved(scale_.light_of(past_[h]), one.lights[h], scale_.light_of((*other.past)[h]));
        }
      }
      guesses_.all.push_back(one);
    }
    if (above_.now != nullptr) rest();
  }
  void rest() {
    const auto left = static_cast<Number>(children_ - siblings_.size());
    const auto of = [&](const Vertex& parent, auto sibling, std::size_t h) {
      const Three p = scale_.light_of(parent[h]).color;
      Light light;
      for (unsigned c = 0; c < 3; ++c) light.color[c] = left * p[c];
      for (const Voxel& one : siblings_) {
        const Three q = scale_.light_of(sibling(one)[h]).color;
        for (unsigned c = 0; c < 3 && q != Three{}; ++c) light.color[c] += p[c] - q[c];
      }
      for (Number& c : light.color) c = brought_into(c / left, 0, kMost);
      return light;
    };
    const bool moves =
        has_past_ && above_.past != nullptr &&
        std::ranges::all_of(siblings_, [](const Voxel& one) { return one.past != nullptr; });
    Guess one{left};
    one.nearness = left == 1 ? 1 << 18 : 1 << 14;
    for (std::size_t h = 0; h < 6; ++h) {
      one.lights[h] = of(
          *above_.now, [](const Voxel& v) -> const Vertex& { return *v.now; }, h);
      if (!moves) continue;
      const Light old = of(
          *above_.past, [](const Voxel& v) -> const Vertex& { return *v.past; }, h);
      one.lights[h] = moved(scale_.light_of(past_[h]), one.lights[h], old);
    }
    guesses_.all.push_back(one);
  }

  void hemispheres() {
    exponents_ = {};
    greens_ = {};
    Number same = 0, dark = 0;
    for (unsigned h = 0; h < 6; ++h) {
      const bool as_before = has_past_ && is_same(h, same);
      if (as_before) {
        same |= Number{1} << h;
        now_[h] = past_[h];
      } else {
        if (!is_dark(h, dark)) color(h);
        if (scale_.halves()) alpha(h);
      }
      if (now_[h].color == Three{}) dark |= Number{1} << h;
      const Three light = scale_.light_of(now_[h]).color;
      for (Guess& g : guesses_.all) g.unlike += unlike_colors(g.lights[h].color, light);
    }
    masks_ = same;
  }

  bool is_same(unsigned h, Number m) {
    Number equal = 0;
    for (const auto& [d, other] : near_) equal += (*other.now)[h] == (*other.past)[h] ? 1 : 0;
    const auto v = static_cast<Number>(near_.size());
    const Number y = v == 0 ? 9 : 8 * equal / v;
    const bool known = above_.now != nullptr && above_.past != nullptr;
    const Number a = !known ? 2 : (*above_.now)[h] == (*above_.past)[h] ? 1 : 0;
    return learn_.flag(2,
                       {{H({4, y, a}), h}, {H({5, m, h, a}), y}, {H({6, y, masks_ >> h & 1}), a}});
  }

  bool is_dark(unsigned h, Number m) {
    const auto black = [&](const Guess& g) { return g.lights[h].color == Three{} ? 1 : 0; };
    const auto g = static_cast<Number>(guesses_.all.size());
    Number b = 0, f = 2;
    for (const Guess& guess : guesses_.all) b += black(guess);
    if (g > 0) f = 3 * f + black(guesses_.all.front());
    if (g > 1) f = 3 * f + black(guesses_.all.back());
    const Number y = g == 0 ? 9 : 8 * b / g;
    return learn_.flag(has_past_ ? 5 : 4,
                       {{H({7, y, f}), h}, {H({8, m, h}), y}, {H({9, f, m != 0 ? 1 : 0}), g}});
  }

  void alpha(unsigned h) {
    const Number a = h % 2 == 1 ? now_[h - 1].alpha : has_past_ ? past_[h].alpha : last_[h].alpha;
    const Number o = h == 0 ? last_[5].alpha : now_[h - 1].alpha, s = h % 2;
    const auto word = [](Number x) { return x & 0xFFFFFFFF; };
    const Number by = learn_.number(13,
                                    {H({20, s, word(a)}), H({21, s, word(o), h}), H({22, s}),
                                     H({23, h, word(a) >> 6}), H({24, word(a), word(o)})},
                                    {{H({240, s}), 0}, {H({241, word(a)}), s}, {H({242, h}), 0}});
    now_[h].alpha = with_sign(a + by, 16);
  }

  void color(unsigned h) {
    Codes& now = now_[h];
    guesses_.weigh([](const Guess&) { return Number{0}; }, h);
    const Number g = guesses_.mean_lit(h, [&](const Guess& of) { return of.lights[h].color[1]; });
    const Number varies =
        guesses_.mean_lit(h, [&](const Guess& of) { return std::abs(of.lights[h].color[1] - g); });
    Number weights = 0;
    for (const Guess& of : guesses_.all) {
      if (of.lights[h].color != Three{}) weights += of.weight;
    }
    const Number v =
        weights == 0 ? 0 : half(g == 0 ? 999 : std::min<Number>(64 * varies / g, 1000000));
    const Number n = guesses_.all.empty() ? 9 : std::min<Number>(guesses_.all.front().d, 9);
    guesses_.weigh([](const Guess&) { return Number{0}; }, h + 1);
    const Three y = mean(h);
    const Number delta = h == 0 ? 0 : 2 + brought_into(exponents_[h - 1], -2, 2);
    Number sum = 0;
    for (unsigned i = 0; i < h; ++i) sum += std::abs(greens_[i]);
    const Number gamma = h == 0 ? 20 : half(2 * sum / h);

    if (scale_.has_exponent()) {
      const Number most = std::max<Number>(std::ranges::max(y), 1);
      Number e = 0;
      while (e < 31 && steps(most, e - scale_.top() + 27) > 511) ++e;
      const Number mu = scale_.next_color(most, e) / 32;
      const Number by = learn_.number(
          5,
          {H({40, mu, v}), H({42, mu, n}), H({44, mu, 0}), H({46, mu, delta}), H({48, mu, 0, h})},
          {{H({216, mu}), 0}, {H({218, delta, mu}), 0}, {H({220, 0, mu}), 0}});
      now.exponent = (e + by) & 31;
      exponents_[h] = now.exponent - e;
    }
    const Number epsilon = 2 + brought_into(exponents_[h], -2, 2);

    const Number green = scale_.next_color(y[1], now.exponent), nu = half(green);
    const Number past_green = h == 0 ? 0 : greens_[h - 1];
    const Number eta = h == 0 ? 20 : half(past_green);
    greens_[h] = learn_.number(7,
                               {H({60, nu, v}), H({62, nu, n, epsilon}), H({64, nu, 0, gamma}),
                                H({66, eta, nu, epsilon}), H({68, gamma, nu, h})},
                               {{H({222, epsilon, delta}), sign(past_green)},
                                {H({224, nu, epsilon}), 0},
                                {H({226, 0, h}), 0}});
    now.color[1] = scale_.color_code(green + greens_[h]);
    const Number value = scale_.color_value(now.color[1], now.exponent);
    guesses_.weigh(
        [&](const Guess& of) {
          return unlike_colors({0, of.lights[h].color[1], 0}, {0, value, 0});
        },
        h + 1);
    red_and_blue(h, y, gamma, n, value);
  }
  [[nodiscard]] Three mean(unsigned h) const {
    Three out{};
    for (unsigned c = 0; c < 3; ++c) {
      out[c] = guesses_.mean_lit(h, [&](const Guess& g) { return g.lights[h].color[c]; });
    }
    return out;
  }

  void red_and_blue(unsigned h, const Three& y, Number gamma, Number n, Number green) {
    Codes& now = now_[h];
    const Three m = mean(h);
    const Number g = greens_[h];
    Number r = 0;
    for (unsigned i = 0; i < 2; ++i) {
      const unsigned c = 2 * i;
      const Number p = m[1] == 0 ? y[c] : prop(m[c], green, m[1]);
      const Number kappa = half(guesses_.mean_lit(h, [&](const Guess& guess) {
        const Three& of = guess.lights[h].color;
        return of[1] == 0 ? 0 : std::abs(ratio_of(of, c) - ratio_of(m, c));
      }) >> 4);
      const Number code = scale_.next_color(p, now.exponent), nu = half(code);
      const Number by = learn_.number(9 + i,
                                      {H({80 + i, nu, kappa}), H({84 + i, nu, half(g), 0}),
                                       H({88 + i, half(r), kappa, std::min<Number>(half(g), 8)}),
                                       H({92 + i, n, nu, half(r)}), H({96 + i, nu, gamma, 0})},
                                      {{H({228 + i, 3 * sign(g) + sign(r), 0}), 0},
                                       {H({232 + i, nu, sign(r)}), 0},
                                       {H({236 + i, sign(g), half(g)}), 0}});
      now.color[c] = scale_.color_code(code + by);
      r = by;
    }
  }

  unsigned side_;
  std::size_t record_;
  Scale scale_;
  Learner& learn_;
  std::vector<std::array<int, 3>> offsets_;
  std::map<Name, Brick> coded_, held_;
  Vertex last_{};
  bool had_light_ = false;
  Number masks_ = 0;  ///< m of the last voxel with light

  // Of a brick.
  Brick here_;
  Three32 at_{};
  std::map<std::array<int, 3>, const Brick*> around_;
  const Brick* parent_ = nullptr;

  // Of a voxel.
  bool has_past_ = false;
  Vertex past_{}, now_{};
  std::vector<std::pair<Number, Voxel>> near_;
  Voxel above_;
  std::vector<Voxel> siblings_;
  std::size_t children_ = 0;
  Guesses guesses_;
  std::array<Number, 6> exponents_{}, greens_{};  ///< residuals
};

}  // namespace

std::vector<std::vector<std::byte>> decode_voxels(const TextureDesc& desc,
                                                  const std::vector<AdaptiveBlock>& blocks,
                                                  const std::vector<HeldBrick>& held,
                                                  Learner& learner) {
  Voxels voxels(desc, learner);
  for (const HeldBrick& brick : held) voxels.hold(brick);
  std::vector<std::size_t> order(blocks.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {},
                           [&](std::size_t i) { return Voxels::order_of(blocks[i].presence); });
  std::vector<std::vector<std::byte>> out(blocks.size());
  for (const std::size_t i : order) {
    out[i] = voxels.block(blocks[i]);
    if (learner.source().missing()) return {};
  }
  return out;
}

}  // namespace gicodec::reference
