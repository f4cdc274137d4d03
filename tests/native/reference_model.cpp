#include "native/reference_model.h"

#include <algorithm>
#include <cstdlib>

namespace gicodec::reference {
namespace {

enum From { kConstant, kCap, kPast, kAverage, kPastChange };
struct Mode {
  From from;
  const char* neighbours;
  int w, n, nw, ne, a, klass;
};
constexpr Mode kPlaneUpdate[8] = {
    {kPast, "", 4, 2, 0, 2, 3, 0}, {kPast, "", 2, 2, 0, 0, 0, 1},
    {kPast, "", 4, 2, 0, 2, 0, 1}, {kPast, "", 6, 6, -4, 0, 4, 2},
    {kPast, "", 0, 0, 0, 0, 0, 3}, {kPast, "", 4, 0, 0, 4, 4, 0},
    {kPast, "", 2, 2, 0, 0, 4, 0}, {kPastChange, "XZ", 0, 0, 0, 0, 0, 3}};
constexpr Mode kPlaneKey[8] = {
    {kConstant, "", 8, 8, -8, 0, 4, 0},  {kAverage, "XZ", 6, 6, -4, 0, 4, 2},
    {kAverage, "Y", 6, 6, -4, 0, 4, 1},  {kAverage, "X", 6, 6, -4, 0, 4, 1},
    {kAverage, "Z", 6, 6, -4, 0, 4, 1},  {kAverage, "XYZ", 6, 6, -4, 0, 4, 3},
    {kAverage, "XY", 6, 6, -4, 0, 4, 2}, {kAverage, "YZ", 6, 6, -4, 0, 4, 2}};
constexpr Mode kPairUpdate[2][8] = {{{kPast, "", 2, 2, 0, 0, 0, 0},
                                     {kPast, "", 6, 6, -4, 0, 0, 1},
                                     {kPast, "", 0, 0, 0, 0, 0, 2},
                                     {kPast, "", 4, 2, 0, 2, 0, 0},
                                     {kPastChange, "X", 2, 1, 0, 1, 0, 3},
                                     {kPastChange, "Y", 2, 1, 0, 1, 0, 3},
                                     {kPastChange, "Z", 2, 1, 0, 1, 0, 3},
                                     {kCap, "", 6, 6, -4, 0, 0, 1}},
                                    {{kPast, "", 2, 1, 0, 1, 0, 0},
                                     {kPast, "", 0, 0, 0, 0, 0, 1},
                                     {kPast, "", 4, 2, 0, 2, 0, 0},
                                     {kPast, "", 2, 2, 0, 0, 0, 0},
                                     {kConstant, "", 2, 2, 0, 0, 0, 2},
                                     {kPastChange, "XYZ", 0, 0, 0, 0, 0, 3},
                                     {kPastChange, "Y", 0, 0, 0, 0, 0, 3},
                                     {kAverage, "Z", 2, 2, 0, 0, 0, 2}}};
constexpr Mode kPairKey[2][8] = {{{kCap, "", 6, 6, -4, 0, 0, 0},
                                  {kAverage, "X", 6, 6, -4, 0, 0, 0},
                                  {kAverage, "Y", 6, 6, -4, 0, 0, 0},
                                  {kAverage, "Z", 6, 6, -4, 0, 0, 0},
                                  {kAverage, "X", 2, 2, 0, 0, 0, 0},
                                  {kAverage, "Y", 2, 2, 0, 0, 0, 0},
                                  {kAverage, "Z", 2, 2, 0, 0, 0, 0},
                                  {kCap, "", 2, 1, 0, 1, 0, 0}},
                                 {{kConstant, "", 2, 1, 0, 1, 0, 0},
                                  {kConstant, "", 8, 8, -8, 0, 0, 0},
                                  {kConstant, "", 2, 2, 0, 0, 0, 0},
                                  {kAverage, "X", 2, 2, 0, 0, 0, 0},
                                  {kAverage, "Y", 2, 2, 0, 0, 0, 0},
                                  {kAverage, "Z", 2, 2, 0, 0, 0, 0},
                                  {kAverage, "X", 2, 1, 0, 1, 0, 0},
                                  {kAverage, "Y", 2, 1, 0, 1, 0, 0}}};

int word(int v) { return v & 0xFFFF; }
int sign(int v) { return ((v & 0xFFFF) ^ 0x8000) - 0x8000; }
int capped(int v) { return std::min(v, 65535); }

/// Texels around, by index; -1 where everything reads 0.
struct Around {
  int w = -1, n = -1, nw = -1, ne = -1;
};
Around around(int columns, int i, int j) {
  const int at = j * columns + i;
  if (j == 0) {
    if (i == 0) return {};
    return {at - 1, at - 1, at - 1, at - 1};
  }
  const int n = at - columns;
  return {i > 0 ? at - 1 : n, n, i > 0 ? n - 1 : n, i + 1 < columns ? n + 1 : n};
}
/// Neighbours that do not exist are the last record before that does.
Around around(int columns, int i, int j, const std::vector<bool>& exists) {
  Around a = around(columns, i, j);
  int last = j * columns + i - 1;
  while (last >= 0 && !exists[static_cast<std::size_t>(last)]) --last;
  for (int* t : {&a.w, &a.n, &a.nw, &a.ne}) {
    if (*t >= 0 && !exists[static_cast<std::size_t>(*t)]) *t = last;
  }
  return a;
}
int at(const std::vector<int>& v, int t) { return t < 0 ? 0 : v[static_cast<std::size_t>(t)]; }

int operate(const Mode& m, const std::vector<int>& d, const Around& a, bool deep) {
  const int weights[4] = {m.w, m.n, m.nw, m.ne};
  const int values[4] = {at(d, a.w), at(d, a.n), at(d, a.nw), at(d, a.ne)};
  int sum = 0;
  for (int k = 0; k < 4; ++k) {
    if (deep) {
      const int b = weights[k] == 8 ? 32767 : 4096 * weights[k];
      sum += (values[k] * b + 16384) >> 15;
    } else {
      sum += values[k] * weights[k];
    }
  }
  return deep ? sign(sum) : sign(sum + 4) >> 3;
}

/// round() of section 7.
int rounded(int a, int b) { return (sign(a) * sign(b) + 16384) >> 15; }
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

struct Look {
  int energy = 0, sign = 0;
  bool flip = false;
};
Look look(const std::vector<int>& e, const Around& a) {
  const int w = at(e, a.w), n = at(e, a.n);
  const int near = capped(std::abs(w) + std::abs(n));
  Look l;
  l.energy = capped(capped(near + near) + capped(std::abs(at(e, a.nw)) + std::abs(at(e, a.ne))));
  l.flip = w < 0 || (w == 0 && n < 0);
  if ((w != 0) != (n != 0)) l.sign = 1;
  if (w != 0 && n != 0) l.sign = (w < 0) == (n < 0) ? 2 : 3;
  return l;
}
int magnitude(int s, bool deep) {
  constexpr int kShallow[15] = {1, 3, 5, 8, 11, 16, 24, 36, 48, 64, 96, 144, 208, 256, 512};
  constexpr int kDeep[15] = {1, 4, 8, 16, 32, 48, 64, 96, 144, 208, 256, 512, 1024, 2048, 3072};
  return static_cast<int>(std::ranges::count_if(deep ? kDeep : kShallow,
                                                [&](int threshold) { return threshold <= s; }));
}
int residual(unsigned u, bool flip) {
  const int f = (u & 1) != 0 ? -static_cast<int>(u / 2) - 1 : static_cast<int>(u / 2);
  return sign(flip ? -f : f);
}

/// What a mode predicts from, at one texel.
int source(const Mode& m, const Surroundings& s, std::size_t p, std::size_t t, int constant,
           int cap) {
  const auto known = [&](char axis) -> int { return axis - 'X'; };
  int count = 0, mean = 0;
  for (const char* axis = m.neighbours; *axis != 0; ++axis) {
    const auto& now = s.now[known(*axis)];
    if (!now) continue;
    int v = (*now)[p][t];
    if (m.from == kPastChange) v = sign(v - (*s.before[known(*axis)])[p][t]);
    mean = count == 0 ? v : (mean + v + 1) >> 1;
    ++count;
  }
  switch (m.from) {
    case kConstant:
      return constant;
    case kCap:
      return cap;
    case kPast:
      return (*s.past)[p][t];
    case kAverage:
      return count > 0 ? mean : cap;
    case kPastChange:
      return word((*s.past)[p][t] + mean);
  }
  return 0;
}

/// The first record of a block that exists.
std::size_t first_record(const Surroundings& s) {
  return static_cast<std::size_t>(std::ranges::find(s.exists, true) - s.exists.begin());
}

std::optional<std::vector<unsigned>> read_modes(const Head& head,
                                                const std::vector<Surroundings>& blocks, int kind,
                                                Lanes& coder) {
  std::vector<int> context;
  for (const auto& s : blocks) {
    context.push_back(first_record(s) < s.exists.size() ? kind : Lanes::kInactive);
  }
  auto modes = coder.tokens(head.tables.modes, context);
  if (!coder.valid() || std::ranges::any_of(modes, [](unsigned m) { return m >= 8; })) return {};
  return modes;
}

/// What the texels of a block repeat.
struct Repeats {
  explicit Repeats(std::size_t texels) : guess(texels), alike(texels) {}
  std::vector<const Values*> guess;  ///< null: none
  std::vector<std::array<bool, 4>> alike;
};

/// The hit step of texel t.
bool read_repeats(const Head& head, const std::vector<Surroundings>& blocks, std::size_t t,
                  std::vector<Repeats>& repeats, Lanes& coder) {
  static const Values kZero(32, std::vector<int>(32768));
  const int columns = static_cast<int>(head.columns);
  const Around a = around(columns, static_cast<int>(t) % columns, static_cast<int>(t) / columns);
  std::vector<std::array<const Values*, 4>> candidate(blocks.size());
  std::vector<std::array<std::size_t, 2>> guess(blocks.size());
  std::vector<int> context;
  const auto alike = [&](const Values* x, const Values* y) {
    for (std::size_t p = 0; p < head.bits.size(); ++p) {
      if (head.coded[p] && (*x)[p][t] != (*y)[p][t]) return false;
    }
    return true;
  };
  for (std::size_t l = 0; l < blocks.size(); ++l) {
    const Surroundings& s = blocks[l];
    candidate[l] = {s.past ? &*s.past : &kZero, s.now[0] ? &*s.now[0] : &kZero,
                    s.now[1] ? &*s.now[1] : &kZero, s.now[2] ? &*s.now[2] : &kZero};
    int score[4] = {};
    for (std::size_t k = 0; k < 4 && a.w >= 0; ++k) {
      const auto m = [&](int u) {
        return repeats[l].alike[static_cast<std::size_t>(u)][k] ? 1 : 0;
      };
      score[k] = 4 * m(a.w) + 3 * m(a.n) + 2 * m(a.ne) + m(a.nw);
    }
    const auto best = static_cast<std::size_t>(std::max_element(score, score + 4) - score);
    guess[l] = {best, best};
    int votes = -1, second = -1;
    for (std::size_t k = 0; k < 4; ++k) {
      if (alike(candidate[l][k], candidate[l][best])) {
        ++votes;
      } else if (score[k] > second) {
        second = score[k];
        guess[l][1] = k;
      }
    }
    context.push_back(5 * score[best] + votes);
  }
  const auto symbol = coder.hits(head.tables.hits, context);
  if (!coder.valid()) return false;
  for (std::size_t l = 0; l < blocks.size(); ++l) {
    if (symbol[l] == 2) continue;
    const Values* taken = candidate[l][guess[l][symbol[l]]];
    repeats[l].guess[t] = taken;
    for (std::size_t k = 0; k < 4; ++k) repeats[l].alike[t][k] = alike(candidate[l][k], taken);
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
        const Around a = around(static_cast<int>(head.columns), i, j, blocks[l].exists);
        reference.push_back(source(m, blocks[l], p, t, half, half));
        int op = mantissa ? 0 : operate(m, d[l][p], a, deep);
        if (mantissa) {
          const int own = value[l][last][t], middle = 1 << (head.bits[last] - 1);
          const int other = source(m, blocks[l], last, t, middle, middle);
          reference[l] = rounded(32 * reference[l], 16 * scale(other, own));
          op = operate_scaled(m, d[l][p], value[l][last], a, own);
        }
        const Look look_l = look(e[l][p], a);
        const bool at_first = t == first_record(blocks[l]);
        int size = 15;
        if (p == 0 || exponent) {
          if (!at_first) size = magnitude(look_l.energy, deep);
        } else if (head.low[p]) {
          const int energy = look_l.energy >> 4, h = std::min(std::abs(e[l][p - 1][t]), 3);
          const int f = p == first_low ? 0 : std::abs(e[l][first_low][t]);
          if (!at_first)
            size = magnitude(capped(energy - (energy >> 2) + 1024 * h + (f >> 3)), deep);
        } else {
          const int e0 = e[l][0][t], e1 = p == second ? 0 : e[l][second][t];
          op += sign(m.a * e0 + 2) >> 2;
          const int c =
              p == second ? std::abs(e0) : capped(capped(std::abs(e0) + std::abs(e1)) + 1) >> 1;
          const int energy = at_first ? capped(capped(2 * c) * 2) : look_l.energy;
          size = magnitude(capped(energy - (energy >> 2) + capped(2 * c)), deep);
        }
        const int sum = reference[l] + op;
        prediction.push_back(mantissa ? std::clamp(sign(sum), 0, (1 << head.bits[p]) - 1) : sum);
        flip.push_back(look_l.flip);
        const bool coded = blocks[l].exists[t] && repeats[l].guess[t] == nullptr;
        context.push_back(coded ? 64 * m.klass + 16 * look_l.sign + size : Lanes::kInactive);
      }
      const auto u = coder.tokens(head.tables.planes[head.place(p)], context);
      if (!coder.valid()) return {};
      for (std::size_t l = 0; l < lanes; ++l) {
        const int modulus = 1 << head.bits[p];
        int r = residual(u[l], flip[l]) & (modulus - 1);
        if (const Values* guess = repeats[l].guess[t]; guess != nullptr) {
          r = ((*guess)[p][t] - prediction[l]) & (modulus - 1);
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

namespace {

/// One block of pairs in the making.
struct PairBlock {
  explicit PairBlock(std::size_t texels)
      : value(2, std::vector<int>(texels)),
        d(value),
        e(value),
        key_d(16, value[0]),
        key_e(16, value[0]),
        matched(texels) {}
  Values value, d, e, key_d, key_e;  // key_*: [8·plane + mode]
  std::vector<std::array<bool, 7>> matched;
};
using Pair = std::array<int, 2>;

struct Forecast {
  int reference[2], prediction[2];
  int key_reference[16], key_prediction[16];
};

Forecast predict(const Head& head, const Surroundings& s, const PairBlock& b,
                 const unsigned (&modes)[2], int i, int j) {
  const int columns = static_cast<int>(head.columns);
  const Around a = around(columns, i, j);
  const auto t = static_cast<std::size_t>(j * columns + i);
  Forecast f{};
  for (std::size_t p = 0; p < 2; ++p) {
    if (head.update) {
      const Mode& m = kPairUpdate[p][modes[p]];
      f.reference[p] = source(m, s, p, t, 0, head.cap[p]);
      f.prediction[p] = word(f.reference[p] + operate(m, b.d[p], a, true));
      continue;
    }
    int least = -1;
    for (std::size_t m = 0; m < 8; ++m) {
      const std::size_t k = 8 * p + m;
      f.key_reference[k] = source(kPairKey[p][m], s, p, t, 0, head.cap[p]);
      f.key_prediction[k] = word(f.key_reference[k] + operate(kPairKey[p][m], b.key_d[k], a, true));
      int left = look(b.key_e[k], a).energy;
      if (i >= 2 && j > 0) left = capped(left + std::abs(b.key_e[k][t - 2]));
      if (j >= 2) left = capped(left + std::abs(b.key_e[k][t - 2 * head.columns]));
      left /= 2;
      if (least < 0 || left < least) {
        least = left;
        f.prediction[p] = f.key_prediction[k];
      }
    }
  }
  return f;
}

std::array<Pair, 7> candidates(const Head& head, const Surroundings& s, const PairBlock& b,
                               const Around& a, std::size_t t) {
  std::array<Pair, 7> c;
  c.fill({head.cap[0], head.cap[1]});
  if (s.past) c[0] = {(*s.past)[0][t], (*s.past)[1][t]};
  for (std::size_t k = 0; k < 3; ++k) {
    if (s.now[k]) c[1 + k] = {(*s.now[k])[0][t], (*s.now[k])[1][t]};
  }
  if (a.w >= 0) c[4] = {at(b.value[0], a.w), at(b.value[1], a.w)};
  if (a.n >= 0) c[5] = {at(b.value[0], a.n), at(b.value[1], a.n)};
  return c;
}

struct Guess {
  Pair first, second;
  int context;
};
Guess guess(const std::array<Pair, 7>& c, const PairBlock& b, const Around& a) {
  int score[7] = {};
  for (std::size_t k = 0; k < 7 && a.w >= 0; ++k) {
    const auto m = [&](int t) { return b.matched[static_cast<std::size_t>(t)][k] ? 1 : 0; };
    score[k] = 4 * m(a.w) + 3 * m(a.n) + 2 * m(a.ne) + m(a.nw);
  }
  const auto best = static_cast<std::size_t>(std::max_element(score, score + 7) - score);
  Guess g{c[best], c[best], 0};
  int votes = -1, second = -1;
  for (std::size_t k = 0; k < 7; ++k) {
    if (c[k] == c[best]) {
      ++votes;
    } else if (score[k] > second) {
      second = score[k];
      g.second = c[k];
    }
  }
  g.context = 5 * score[best] + std::min(votes, 4);
  return g;
}

}  // namespace

std::optional<std::vector<Values>> decode_pairs(const Head& head,
                                                const std::vector<Surroundings>& blocks,
                                                Lanes& coder) {
  const std::size_t lanes = blocks.size();
  const int columns = static_cast<int>(head.columns);
  std::vector<unsigned> modes[2] = {std::vector<unsigned>(lanes), std::vector<unsigned>(lanes)};
  if (head.update) {
    for (int p = 0; p < 2; ++p) {
      const auto read = read_modes(head, blocks, 2 + p, coder);
      if (!read) return {};
      modes[p] = *read;
    }
  }
  std::vector<PairBlock> state(lanes, PairBlock(std::size_t{head.columns} * head.rows));
  for (int j = 0; j < static_cast<int>(head.rows); ++j) {
    for (int i = 0; i < columns; ++i) {
      const Around a = around(columns, i, j);
      const auto t = static_cast<std::size_t>(j * columns + i);
      std::vector<Forecast> forecast;
      std::vector<std::array<Pair, 7>> candidate;
      std::vector<Guess> guesses;
      std::vector<int> hit_context;
      for (std::size_t l = 0; l < lanes; ++l) {
        const unsigned m[2] = {modes[0][l], modes[1][l]};
        forecast.push_back(predict(head, blocks[l], state[l], m, i, j));
        candidate.push_back(candidates(head, blocks[l], state[l], a, t));
        guesses.push_back(guess(candidate[l], state[l], a));
        hit_context.push_back(guesses[l].context);
      }
      const auto symbol = coder.hits(head.tables.hits, hit_context);
      std::vector<Pair> value(lanes);
      std::vector<int> first_residual(lanes);
      const bool any = std::ranges::find(symbol, 2U) != symbol.end();
      for (std::size_t l = 0; l < lanes; ++l)
        value[l] = symbol[l] == 1 ? guesses[l].second : guesses[l].first;
      for (std::size_t p = 0; p < 2 && any; ++p) {
        std::vector<int> context(lanes, Lanes::kInactive);
        for (std::size_t l = 0; l < lanes; ++l) {
          if (symbol[l] != 2) continue;
          const Look k = look(state[l].e[p], a);
          const int c = std::abs(first_residual[l]);
          const int size = p == 1
                               ? magnitude(capped(k.energy + capped(c + capped(c + c))) >> 1, true)
                           : t == 0 ? 15
                                    : magnitude(k.energy, true);
          const int klass = head.update ? kPairUpdate[p][modes[p][l]].klass : 0;
          context[l] = 64 * klass + 16 * k.sign + size;
        }
        const auto u = coder.tokens(head.tables.planes[p], context);
        for (std::size_t l = 0; l < lanes; ++l) {
          if (symbol[l] != 2) continue;
          const int r = residual(u[l], look(state[l].e[p], a).flip);
          if (p == 0) first_residual[l] = r;
          value[l][p] = word(forecast[l].prediction[p] + r);
        }
      }
      if (!coder.valid()) return {};
      for (std::size_t l = 0; l < lanes; ++l) {
        PairBlock& b = state[l];
        for (std::size_t k = 0; k < 7; ++k) b.matched[t][k] = candidate[l][k] == value[l];
        for (std::size_t p = 0; p < 2; ++p) {
          b.value[p][t] = value[l][p];
          b.e[p][t] = sign(value[l][p] - forecast[l].prediction[p]);
          b.d[p][t] = sign(value[l][p] - forecast[l].reference[p]);
          for (std::size_t k = 8 * p; k < 8 * p + 8 && !head.update; ++k) {
            b.key_d[k][t] = sign(value[l][p] - forecast[l].key_reference[k]);
            b.key_e[k][t] = sign(value[l][p] - forecast[l].key_prediction[k]);
          }
        }
      }
    }
  }
  std::vector<Values> result;
  for (const auto& b : state) result.push_back(b.value);
  return result;
}

}  // namespace gicodec::reference
