#include "native/reference_context.h"

namespace gicodec::reference {
namespace {

constexpr Mode kPairUpdate[2][8] = {{{kPrevious, "", 2, 2, 0, 0, 0, 0},
                                     {kPrevious, "", 6, 6, -4, 0, 0, 1},
                                     {kPrevious, "", 0, 0, 0, 0, 0, 2},
                                     {kPrevious, "", 4, 2, 0, 2, 0, 0},
                                     {kPreviousChange, "X", 2, 1, 0, 1, 0, 3},
                                     {kPreviousChange, "Y", 2, 1, 0, 1, 0, 3},
                                     {kPreviousChange, "Z", 2, 1, 0, 1, 0, 3},
                                     {kFrequent, "", 6, 6, -4, 0, 0, 1}},
                                    {{kPrevious, "", 2, 1, 0, 1, 0, 0},
                                     {kPrevious, "", 0, 0, 0, 0, 0, 1},
                                     {kPrevious, "", 4, 2, 0, 2, 0, 0},
                                     {kPrevious, "", 2, 2, 0, 0, 0, 0},
                                     {kConstant, "", 2, 2, 0, 0, 0, 2},
                                     {kPreviousChange, "XYZ", 0, 0, 0, 0, 0, 3},
                                     {kPreviousChange, "Y", 0, 0, 0, 0, 0, 3},
                                     {kAverage, "Z", 2, 2, 0, 0, 0, 2}}};
constexpr Mode kPairKey[2][8] = {{{kFrequent, "", 6, 6, -4, 0, 0, 0},
                                  {kAverage, "X", 6, 6, -4, 0, 0, 0},
                                  {kAverage, "Y", 6, 6, -4, 0, 0, 0},
                                  {kAverage, "Z", 6, 6, -4, 0, 0, 0},
                                  {kAverage, "X", 2, 2, 0, 0, 0, 0},
                                  {kAverage, "Y", 2, 2, 0, 0, 0, 0},
                                  {kAverage, "Z", 2, 2, 0, 0, 0, 0},
                                  {kFrequent, "", 2, 1, 0, 1, 0, 0}},
                                 {{kConstant, "", 2, 1, 0, 1, 0, 0},
                                  {kConstant, "", 8, 8, -8, 0, 0, 0},
                                  {kConstant, "", 2, 2, 0, 0, 0, 0},
                                  {kAverage, "X", 2, 2, 0, 0, 0, 0},
                                  {kAverage, "Y", 2, 2, 0, 0, 0, 0},
                                  {kAverage, "Z", 2, 2, 0, 0, 0, 0},
                                  {kAverage, "X", 2, 1, 0, 1, 0, 0},
                                  {kAverage, "Y", 2, 1, 0, 1, 0, 0}}};

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

struct PlanePrediction {
  int reference[2], prediction[2];
  int key_reference[16], key_prediction[16];
};

PlanePrediction predict(const Head& head, const Surroundings& s, const PairBlock& b,
                        const unsigned (&modes)[2], int i, int j) {
  const int columns = static_cast<int>(head.columns);
  const Around a = around(columns, i, j);
  const auto t = static_cast<std::size_t>(j * columns + i);
  PlanePrediction f{};
  for (std::size_t p = 0; p < 2; ++p) {
    if (head.update) {
      const Mode& m = kPairUpdate[p][modes[p]];
      f.reference[p] = source(m, s, p, t, 0, head.frequent[p]);
      f.prediction[p] = word(f.reference[p] + operate(m, b.d[p], a, true));
      continue;
    }
    int least = -1;
    for (std::size_t m = 0; m < 8; ++m) {
      const std::size_t k = 8 * p + m;
      f.key_reference[k] = source(kPairKey[p][m], s, p, t, 0, head.frequent[p]);
      f.key_prediction[k] = word(f.key_reference[k] + operate(kPairKey[p][m], b.key_d[k], a, true));
      int left = local_context(b.key_e[k], a).energy;
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
  c.fill({head.frequent[0], head.frequent[1]});
  if (s.previous) c[0] = {(*s.previous)[0][t], (*s.previous)[1][t]};
  for (std::size_t k = 0; k < 3; ++k) {
    if (s.now[k]) c[1 + k] = {(*s.now[k])[0][t], (*s.now[k])[1][t]};
  }
  if (a.w >= 0) c[4] = {at(b.value[0], a.w), at(b.value[1], a.w)};
  if (a.n >= 0) c[5] = {at(b.value[0], a.n), at(b.value[1], a.n)};
  return c;
}

struct BestCandidates {
  Pair first, second;
  int context;
};
BestCandidates rank_candidates(const std::array<Pair, 7>& c, const PairBlock& b, const Around& a) {
  int score[7] = {};
  for (std::size_t k = 0; k < 7 && a.w >= 0; ++k) {
    const auto m = [&](int t) { return b.matched[static_cast<std::size_t>(t)][k] ? 1 : 0; };
    score[k] = 4 * m(a.w) + 3 * m(a.n) + 2 * m(a.ne) + m(a.nw);
  }
  const auto best = static_cast<std::size_t>(std::max_element(score, score + 7) - score);
  BestCandidates g{c[best], c[best], 0};
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
      std::vector<PlanePrediction> predicted;
      std::vector<std::array<Pair, 7>> candidate;
      std::vector<BestCandidates> best;
      std::vector<int> repeat_context;
      for (std::size_t l = 0; l < lanes; ++l) {
        const unsigned m[2] = {modes[0][l], modes[1][l]};
        predicted.push_back(predict(head, blocks[l], state[l], m, i, j));
        candidate.push_back(candidates(head, blocks[l], state[l], a, t));
        best.push_back(rank_candidates(candidate[l], state[l], a));
        repeat_context.push_back(best[l].context);
      }
      const auto symbol = coder.repeats(head.tables.repeats, repeat_context);
      std::vector<Pair> value(lanes);
      std::vector<int> first_residual(lanes);
      const bool any = std::ranges::find(symbol, 2U) != symbol.end();
      for (std::size_t l = 0; l < lanes; ++l)
        value[l] = symbol[l] == 1 ? best[l].second : best[l].first;
      for (std::size_t p = 0; p < 2 && any; ++p) {
        std::vector<int> context(lanes, Lanes::kInactive);
        for (std::size_t l = 0; l < lanes; ++l) {
          if (symbol[l] != 2) continue;
          const Local k = local_context(state[l].e[p], a);
          const int c = std::abs(first_residual[l]);
          const int size = p == 1
                               ? magnitude(capped(k.energy + capped(c + capped(c + c))) >> 1, true)
                           : t == 0 ? 15
                                    : magnitude(k.energy, true);
          const int context_class = head.update ? kPairUpdate[p][modes[p][l]].context_class : 0;
          context[l] = 64 * context_class + 16 * k.sign + size;
        }
        const auto u = coder.tokens(head.tables.planes[p], context);
        for (std::size_t l = 0; l < lanes; ++l) {
          if (symbol[l] != 2) continue;
          const int r = residual(u[l], local_context(state[l].e[p], a).flip);
          if (p == 0) first_residual[l] = r;
          value[l][p] = word(predicted[l].prediction[p] + r);
        }
      }
      if (!coder.valid()) return {};
      for (std::size_t l = 0; l < lanes; ++l) {
        PairBlock& b = state[l];
        for (std::size_t k = 0; k < 7; ++k) b.matched[t][k] = candidate[l][k] == value[l];
        for (std::size_t p = 0; p < 2; ++p) {
          b.value[p][t] = value[l][p];
          b.e[p][t] = sign(value[l][p] - predicted[l].prediction[p]);
          b.d[p][t] = sign(value[l][p] - predicted[l].reference[p]);
          for (std::size_t k = 8 * p; k < 8 * p + 8 && !head.update; ++k) {
            b.key_d[k][t] = sign(value[l][p] - predicted[l].key_reference[k]);
            b.key_e[k][t] = sign(value[l][p] - predicted[l].key_prediction[k]);
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
