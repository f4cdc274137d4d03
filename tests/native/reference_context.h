// What planes and pairs of the reference decoder share (docs/native.md, sections 6 and 7).
#pragma once

#include "native/reference_model.h"

#include <algorithm>
#include <cstdlib>

namespace gicodec::reference {

enum From { kConstant, kFrequent, kPrevious, kAverage, kPreviousChange };
struct Mode {
  From from;
  const char* neighbours;
  int w, n, nw, ne, a, context_class;
};

inline int word(int v) { return v & 0xFFFF; }
inline int sign(int v) { return ((v & 0xFFFF) ^ 0x8000) - 0x8000; }
inline int capped(int v) { return std::min(v, 65535); }

/// Texels around, by index; -1 where everything reads 0.
struct Around {
  int w = -1, n = -1, nw = -1, ne = -1;
};
inline Around around(int columns, int i, int j) {
  const int at = j * columns + i;
  if (j == 0) {
    if (i == 0) return {};
    return {at - 1, at - 1, at - 1, at - 1};
  }
  const int n = at - columns;
  return {i > 0 ? at - 1 : n, n, i > 0 ? n - 1 : n, i + 1 < columns ? n + 1 : n};
}
/// For every record of a block the last one before it that exists, or −1.
inline std::vector<int> last_existing(const std::vector<bool>& exists) {
  std::vector<int> last(exists.size(), -1);
  for (std::size_t t = 1; t < exists.size(); ++t) {
    last[t] = exists[t - 1] ? static_cast<int>(t - 1) : last[t - 1];
  }
  return last;
}
/// Neighbours that do not exist are the last record before that does.
inline Around around(int columns, int i, int j, const std::vector<bool>& exists,
                     const std::vector<int>& last) {
  Around a = around(columns, i, j);
  for (int* t : {&a.w, &a.n, &a.nw, &a.ne}) {
    if (*t >= 0 && !exists[static_cast<std::size_t>(*t)]) {
      *t = last[static_cast<std::size_t>(j * columns + i)];
    }
  }
  return a;
}
inline int at(const std::vector<int>& v, int t) {
  return t < 0 ? 0 : v[static_cast<std::size_t>(t)];
}

inline int operate(const Mode& m, const std::vector<int>& d, const Around& a, bool deep) {
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
inline int rounded(int a, int b) { return (sign(a) * sign(b) + 16384) >> 15; }
struct Local {
  int energy = 0, sign = 0;
  bool flip = false;
};
inline Local local_context(const std::vector<int>& e, const Around& a) {
  const int w = at(e, a.w), n = at(e, a.n);
  const int near = capped(std::abs(w) + std::abs(n));
  Local l;
  l.energy = capped(capped(near + near) + capped(std::abs(at(e, a.nw)) + std::abs(at(e, a.ne))));
  l.flip = w < 0 || (w == 0 && n < 0);
  if ((w != 0) != (n != 0)) l.sign = 1;
  if (w != 0 && n != 0) l.sign = (w < 0) == (n < 0) ? 2 : 3;
  return l;
}
inline int magnitude(int s, bool deep) {
  constexpr int kShallow[15] = {1, 3, 5, 8, 11, 16, 24, 36, 48, 64, 96, 144, 208, 256, 512};
  constexpr int kDeep[15] = {1, 4, 8, 16, 32, 48, 64, 96, 144, 208, 256, 512, 1024, 2048, 3072};
  return static_cast<int>(std::ranges::count_if(deep ? kDeep : kShallow,
                                                [&](int threshold) { return threshold <= s; }));
}
inline int residual(unsigned u, bool flip) {
  const int f = (u & 1) != 0 ? -static_cast<int>(u / 2) - 1 : static_cast<int>(u / 2);
  return sign(flip ? -f : f);
}

/// What a mode predicts from, at one texel.
inline int source(const Mode& m, const Surroundings& s, std::size_t p, std::size_t t, int constant,
                  int frequent) {
  const auto known = [&](char axis) -> int { return axis - 'X'; };
  int count = 0, mean = 0;
  for (const char* axis = m.neighbours; *axis != 0; ++axis) {
    const auto& now = s.now[known(*axis)];
    if (!now) continue;
    int v = (*now)[p][t];
    if (m.from == kPreviousChange) v = sign(v - (*s.before[known(*axis)])[p][t]);
    mean = count == 0 ? v : (mean + v + 1) >> 1;
    ++count;
  }
  switch (m.from) {
    case kConstant:
      return constant;
    case kFrequent:
      return frequent;
    case kPrevious:
      return (*s.previous)[p][t];
    case kAverage:
      return count > 0 ? mean : frequent;
    case kPreviousChange:
      return word((*s.previous)[p][t] + mean);
  }
  return 0;
}

/// The first record of a block that exists.
inline std::size_t first_record(const Surroundings& s) {
  return static_cast<std::size_t>(std::ranges::find(s.exists, true) - s.exists.begin());
}

inline std::optional<std::vector<unsigned>> read_modes(const Head& head,
                                                       const std::vector<Surroundings>& blocks,
                                                       int kind, Lanes& coder) {
  std::vector<int> context;
  for (const auto& s : blocks) {
    context.push_back(first_record(s) < s.exists.size() ? kind : Lanes::kInactive);
  }
  auto modes = coder.tokens(head.tables.modes, context);
  if (!coder.valid() || std::ranges::any_of(modes, [](unsigned m) { return m >= 8; })) return {};
  return modes;
}

}  // namespace gicodec::reference
