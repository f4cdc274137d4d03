#include "native/reference_bits.h"

namespace gicodec::reference {
namespace {

Number squash(Number x) {
  static constexpr Number t[49] = {
      1,     1,     1,     2,     3,     5,     8,     13,    22,    36,    60,    98,    162,
      267,   439,   720,   1179,  1921,  3108,  4971,  7812,  11955, 17625, 24743, 32768, 40793,
      47911, 53581, 57724, 60565, 62428, 63615, 64357, 64816, 65097, 65269, 65374, 65438, 65476,
      65500, 65514, 65523, 65528, 65531, 65533, 65534, 65535, 65535, 65535};
  const Number i = (x + 3072) >> 7, f = (x + 3072) % 128;
  return (t[i] * (128 - f) + t[i + 1] * f + 64) >> 7;
}

Number stretch(Number p) {
  static const std::vector<Number> table = [] {
    std::vector<Number> all;
    for (Number i = 0; i < 4096; ++i) {
      Number x = i == 0 ? -3071 : all.back();
      while (x < 3071 && squash(x) < 16 * i + 8) ++x;
      all.push_back(x);
    }
    return all;
  }();
  return table[static_cast<std::size_t>(p >> 10)];
}

}  // namespace

BitModels::Counter& BitModels::counter(const F& f) {
  Bucket*& bucket = buckets_[f.h * 0xC2B2AE35U >> 18];
  if (bucket == nullptr) bucket = &used_.emplace_back();
  return (*bucket)[static_cast<std::size_t>(f.i)];
}

void BitModels::count(Counter& c, bool bit) {
  const Number to = bit ? (1 << 22) - 1 : 0;
  c.p += static_cast<std::int32_t>(((to - c.p) * (131072 / (2 * c.n + 3))) >> 16);
  if (c.n < 127) ++c.n;
}

std::array<Number, BitModels::kMaxInputs>& BitModels::weights_of(const Mixer& mixer,
                                                                 std::size_t inputs) {
  const auto [entry, added] = mixers_.try_emplace(mixer);
  if (added) entry->second.fill(5 * 65536 / (4 * static_cast<Number>(inputs)));
  return entry->second;
}

bool BitModels::mixed_twice(const Mixer& a, const Mixer& b, const std::array<F, 5>& by) {
  auto &weights_a = weights_of(a, 5), &weights_b = weights_of(b, 5);
  std::array<Counter*, 5> counters{};
  std::array<Number, 5> s{};
  Number sum_a = 0, sum_b = 0;
  for (std::size_t i = 0; i < 5; ++i) {
    counters[i] = &counter(by[i]);
    s[i] = stretch(counters[i]->p);
    sum_a += s[i] * weights_a[i];
    sum_b += s[i] * weights_b[i];
  }
  const auto q = [](Number x) { return squash(brought_into(x, -3071, 3071)); };
  const bool bit =
      source_.bit(static_cast<Word>(brought_into(q((sum_a + sum_b) >> 17), 24, 65512)));
  const auto learn = [&](std::array<Number, 5>& weights, Number sum) {
    const Number error = (bit ? 65536 : 0) - q(sum >> 16);
    for (std::size_t i = 0; i < 5; ++i) {
      const Number step = (s[i] * error * 80 + (1 << 19)) >> 20;
      weights[i] = brought_into(weights[i] + step, -(1 << 19), 1 << 19);
    }
  };
  learn(weights_a, sum_a);
  learn(weights_b, sum_b);
  for (Counter* c : counters) count(*c, bit);
  return bit;
}

BitModels::Mixed BitModels::mixed(const Mixer& mixer, std::span<const F> by) {
  auto& weights = weights_of(mixer, by.size());
  std::array<Counter*, kMaxInputs> counters{};
  std::array<Number, kMaxInputs> s{};
  Number x = 0;
  for (std::size_t i = 0; i < by.size(); ++i) {
    counters[i] = &counter(by[i]);
    s[i] = stretch(counters[i]->p);
    x += s[i] * weights[i];
  }
  const Number q = squash(brought_into(x >> 16, -3071, 3071));
  const bool bit = source_.bit(static_cast<Word>(brought_into(q, 24, 65512)));
  for (std::size_t i = 0; i < by.size(); ++i) {
    const Number step = (s[i] * ((bit ? 65536 : 0) - q) * 18 + (1 << 19)) >> 20;
    weights[i] = brought_into(weights[i] + step, -(1 << 19), 1 << 19);
    count(*counters[i], bit);
  }
  return {bit, q};
}

Word BitModels::value(unsigned channel, const std::array<Word, 5>& hashes, unsigned bits) {
  std::uint64_t y = 1;
  for (unsigned done = 0, k = 0; done < bits; ++k) {
    const unsigned w = bits - done < 4 ? bits - done : 4;
    Noise& noise = noise_[{channel, k}];
    if (noise.rest > 0) {
      --noise.rest;
      y = y << w | source_.bypass(w);
    } else {
      Word m = 1;
      Number t = 0;
      std::array<F, 5> by{};
      for (std::size_t i = 0; i < 5; ++i) by[i].h = H({hashes[i], static_cast<Number>(y)});
      for (unsigned b = 0; b < w; ++b) {
        for (F& f : by) f.i = m;
        const auto [bit, q] = mixed({'v', channel, done + b}, by);
        t += bit ? q - 32768 : 32768 - q;
        m = m << 1 | (bit ? 1U : 0U);
      }
      noise.gain += (t - noise.gain) >> 5;
      if (noise.gain < 512) noise.rest = 15;
      y = y << w | (m - (1U << w));
    }
    done += w;
  }
  return static_cast<Word>(y - (std::uint64_t{1} << bits));
}

Number BitModels::number(unsigned channel, const std::array<Word, 5>& hashes,
                         std::initializer_list<F> sign) {
  unsigned width = 0;
  while (width < 32) {
    std::array<F, 5> by{};
    for (std::size_t i = 0; i < 5; ++i) by[i] = {H({hashes[i], width - width % 16}), width % 16};
    if (!mixed({'w', channel, width}, by).bit) break;
    ++width;
  }
  if (width == 0) return 0;
  const bool negative = flag(224 + channel, sign);
  Number m = 1;
  for (unsigned left = width - 1, k = 0; left > 0;) {
    if (k < 3) {
      const bool bit = flag({'d', channel, k}, {{H({99, channel, width}), m},
                                                {H({hashes[0], 99, width}), m},
                                                {H({hashes[1], 99, width}), m}});
      m = m * 2 + (bit ? 1 : 0);
      ++k;
      --left;
    } else {
      m = (m << left) | source_.bypass(left);
      left = 0;
    }
  }
  return negative ? -m : m;
}

}  // namespace gicodec::reference
