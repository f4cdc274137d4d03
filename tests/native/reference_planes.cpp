#include "native/reference_context.h"

namespace gicodec::reference {
namespace {

constexpr Mode kPlaneUpdate[8] = {
    {kPrevious, "", 4, 2, 0, 2, 3, 0}, {kPrevious, "", 2, 2, 0, 0, 0, 1},
    {kPrevious, "", 4, 2, 0, 2, 0, 1}, {kPrevious, "", 6, 6, -4, 0, 4, 2},
    {kPrevious, "", 0, 0, 0, 0, 0, 3}, {kPrevious, "", 4, 0, 0, 4, 4, 0},
    {kPrevious, "", 2, 2, 0, 0, 4, 0}, {kPreviousChange, "XZ", 0, 0, 0, 0, 0, 3}};
constexpr Mode kPlaneKey[8] = {
    {kConstant, "", 8, 8, -8, 0, 4, 0},  {kAverage, "XZ", 6, 6, -4, 0, 4, 2},
    {kAverage, "Y", 6, 6, -4, 0, 4, 1},  {kAverage, "X", 6, 6, -4, 0, 4, 1},
    {kAverage, "Z", 6, 6, -4, 0, 4, 1},  {kAverage, "XYZ", 6, 6, -4, 0, 4, 3},
    {kAverage, "XY", 6, 6, -4, 0, 4, 2}, {kAverage, "YZ", 6, 6, -4, 0, 4, 2}};

/// s(E') of section 7.1.
int scale(int other, int own) {
  const int above = sign(other - own);
  return above < -6 ? 0 : 1 << (6 + std::min(above, 1));
}
/// The operator of mantissas.
int operate_scaled(const Mode& m, const std::vector<int>& d, const std::vector<int>& exponents,
                   const Around& a, int own) {
  const int weights[4] = {m.w, m.n, m.nw, m.ne}, texels[4] = {a.w, a.n, a.nw, a.ne};
  int sum = 4;
  for (int k = 0; k < 4; ++k) {
    sum += rounded(32 * at(d, texels[k]), 16 * weights[k] * scale(at(exponents, texels[k]), own));
  }
  return sign(sum) >> 3;
}

int sgn(int x) { return (x > 0) - (x < 0); }
/// What the texels of a block repeat.
struct Repeats {
  explicit Repeats(std::size_t texels) : taken(texels), equal_to(texels) {}
  std::vector<const Values*> taken;  ///< null: none
  std::vector<std::array<bool, 4>> equal_to;
};

/// The repeat step of texel t.
bool read_repeats(const Head& head, const std::vector<Surroundings>& blocks, std::size_t t,
                  std::vector<Repeats>& repeats, Lanes& coder) {
  static const Values kZero(32, std::vector<int>(32768));
  const int columns = static_cast<int>(head.columns);
  const Around a = around(columns, static_cast<int>(t) % columns, static_cast<int>(t) / columns);
  std::vector<std::array<const Values*, 4>> candidate(blocks.size());
  std::vector<std::array<std::size_t, 2>> ranked(blocks.size());
  std::vector<int> context;
  const auto equal_to = [&](const Values* x, const Values* y) {
    for (std::size_t p = 0; p < head.bits.size(); ++p) {
      if (head.coded[p] && (*x)[p][t] != (*y)[p][t]) return false;
    }
    return true;
  };
  for (std::size_t l = 0; l < blocks.size(); ++l) {
    const Surroundings& s = blocks[l];
    candidate[l] = {s.previous ? &*s.previous : &kZero, s.now[0] ? &*s.now[0] : &kZero,
                    s.now[1] ? &*s.now[1] : &kZero, s.now[2] ? &*s.now[2] : &kZero};
    int score[4] = {};
    for (std::size_t k = 0; k < 4 && a.w >= 0; ++k) {
      const auto m = [&](int u) {
        return repeats[l].equal_to[static_cast<std::size_t>(u)][k] ? 1 : 0;
      };
      score[k] = 4 * m(a.w) + 3 * m(a.n) + 2 * m(a.ne) + m(a.nw);
    }
    const auto best = static_cast<std::size_t>(std::max_element(score, score + 4) - score);
    ranked[l] = {best, best};
    int votes = -1, second = -1;
    for (std::size_t k = 0; k < 4; ++k) {
      if (equal_to(candidate[l][k], candidate[l][best])) {
        ++votes;
      } else if (score[k] > second) {
        second = score[k];
        ranked[l][1] = k;
      }
    }
    context.push_back(5 * score[best] + votes);
  }
  const auto symbol = coder.repeats(head.tables.repeats, context);
  if (!coder.valid()) return false;
  for (std::size_t l = 0; l < blocks.size(); ++l) {
    if (symbol[l] == 2) continue;
    const Values* taken = candidate[l][ranked[l][symbol[l]]];
    repeats[l].taken[t] = taken;
    for (std::size_t k = 0; k < 4; ++k)
      repeats[l].equal_to[t][k] = equal_to(candidate[l][k], taken);
  }
  return true;
}

}  // namespace

std::size_t Head::place(std::size_t plane) const {
  if (plane == 0) return 0;
  if (std::ranges::find(low, true) != low.end()) return low[plane] ? 1 : 2;
  return std::min<std::size_t>(plane, 2);
}

std::optional<std::vector<Values>> decode_planes(const Head& head,
                                                 const std::vector<Surroundings>& blocks,
                                                 Lanes& coder) {
  const std::size_t lanes = blocks.size(), planes = head.bits.size();
  const std::size_t texels = std::size_t{head.columns} * head.rows;
  const auto modes = read_modes(head, blocks, head.update ? 1 : 0, coder);
  if (!modes) return {};
  const std::vector<Values> zero(lanes, Values(planes, std::vector<int>(texels)));
  auto value = zero, d = zero, e = zero;
  const auto second = static_cast<std::size_t>(
      std::find(head.low.begin() + 1, head.low.end(), false) - head.low.begin());
  const auto first_low =
      static_cast<std::size_t>(std::ranges::find(head.low, true) - head.low.begin());
  std::vector<Repeats> repeats(lanes, Repeats(texels));
  std::vector<std::vector<int>> existing;
  std::vector<std::size_t> first;
  for (const Surroundings& block : blocks) {
    existing.push_back(last_existing(block.exists));
    first.push_back(first_record(block));
  }
  const std::size_t last = planes - 1;
  const bool scaled = head.mantissas && head.coded[last];
  for (std::size_t turn = 0; turn < texels + planes; ++turn) {
    if (head.repeats && turn < texels && !read_repeats(head, blocks, turn, repeats, coder))
      return {};
    for (std::size_t k = 0; k < planes; ++k) {
      const std::size_t p = head.mantissas ? (k + last) % planes : k;
      if (!head.coded[p] || turn < k || turn - k >= texels) continue;
      const std::size_t t = turn - k;
      const bool exponent = head.mantissas && p == last, mantissa = scaled && !exponent;
      const int i = static_cast<int>(t % head.columns), j = static_cast<int>(t / head.columns);
      const bool deep = head.bits[p] > 11;
      std::vector<int> context, prediction, reference;
      std::vector<bool> flip;
      for (std::size_t l = 0; l < lanes; ++l) {
        const Mode& m = head.update ? kPlaneUpdate[(*modes)[l]] : kPlaneKey[(*modes)[l]];
        const int half = head.mantissas && !exponent ? 0 : 1 << (head.bits[p] - 1);
        const Around a =
            around(static_cast<int>(head.columns), i, j, blocks[l].exists, existing[l]);
        reference.push_back(source(m, blocks[l], p, t, half, half));
        int op = mantissa ? 0 : operate(m, d[l][p], a, deep);
        if (mantissa) {
          const int own = value[l][last][t], middle = 1 << (head.bits[last] - 1);
          const int other = source(m, blocks[l], last, t, middle, middle);
          reference[l] = rounded(32 * reference[l], 16 * scale(other, own));
          op = operate_scaled(m, d[l][p], value[l][last], a, own);
        }
        Local local = local_context(e[l][p], a);
        int sign_part = 16 * local.sign;
        const bool at_first = t == first[l];
        int size = 15;
        if (p == 0 || exponent) {
          if (!at_first) size = magnitude(local.energy, deep);
        } else if (head.low[p]) {
          const int energy = local.energy >> 4, h = std::min(std::abs(e[l][p - 1][t]), 3);
          const int f = p == first_low ? 0 : std::abs(e[l][first_low][t]);
          if (!at_first)
            size = magnitude(capped(energy - (energy >> 2) + 1024 * h + (f >> 3)), deep);
        } else {
          const int e0 = e[l][0][t], e1 = p == second ? 0 : e[l][second][t];
          op += sign(m.a * e0 + 2) >> 2;
          const int c =
              p == second ? std::abs(e0) : capped(capped(std::abs(e0) + std::abs(e1)) + 1) >> 1;
          const int energy = at_first ? capped(capped(2 * c) * 2) : local.energy;
          size = magnitude(capped(energy - (energy >> 2) + capped(2 * c)), deep);
          if (head.update && m.context_class == 3) {
            const int votes = p == second ? 2 * sgn(e0) : sgn(e0) + sgn(e1);
            const int both = 3 * votes + sgn(sign(at(e[l][p], a.w) + at(e[l][p], a.n)));
            local.flip = both < 0;
            sign_part = 8 * std::abs(both);
            size = std::min(size, 7);
          }
        }
        const int sum = reference[l] + op;
        prediction.push_back(mantissa ? std::clamp(sign(sum), 0, (1 << head.bits[p]) - 1) : sum);
        flip.push_back(local.flip);
        const bool coded = blocks[l].exists[t] && repeats[l].taken[t] == nullptr;
        context.push_back(coded ? 64 * m.context_class + sign_part + size : Lanes::kInactive);
      }
      const auto u = coder.tokens(head.tables.planes[head.place(p)], context);
      if (!coder.valid()) return {};
      for (std::size_t l = 0; l < lanes; ++l) {
        const int modulus = 1 << head.bits[p];
        int r = residual(u[l], flip[l]) & (modulus - 1);
        if (const Values* taken = repeats[l].taken[t]; taken != nullptr) {
          r = ((*taken)[p][t] - prediction[l]) & (modulus - 1);
        }
        if (r >= modulus / 2) r -= modulus;
        e[l][p][t] = r;
        const int v = (prediction[l] + r) & (modulus - 1);
        value[l][p][t] = blocks[l].exists[t] ? v : 0;
        d[l][p][t] = sign(v - reference[l]);
      }
    }
  }
  for (std::size_t p = 0; p < planes; ++p) {
    if (head.coded[p]) continue;
    for (std::size_t l = 0; l < lanes; ++l) {
      for (std::size_t t = 0; t < texels; ++t) {
        value[l][p][t] = blocks[l].exists[t] ? head.constant[p] : 0;
      }
    }
  }
  return value;
}

}  // namespace gicodec::reference
