// Binary coder and mixed bits of the reference decoder (docs/native.md, sections 9.1 and 9.2).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <initializer_list>
#include <map>
#include <span>
#include <tuple>
#include <vector>

namespace gicodec::reference {

using Word = std::uint32_t;
using Number = std::int64_t;

inline Number brought_into(Number x, Number low, Number high) {
  return x < low ? low : x > high ? high : x;
}
inline unsigned width_of(Number x) {
  if (x < 0) x = -x;
  unsigned width = 0;
  for (; x != 0; x >>= 1) ++width;
  return width;
}
/// H(v1, v2, …).
inline Word H(std::initializer_list<Number> values) {
  Word h = static_cast<Word>(*values.begin());
  for (const auto* v = values.begin() + 1; v != values.end(); ++v) {
    h = (h + static_cast<Word>(*v) + 1) * 0x9E3779B1U;
    h ^= h >> 15;
  }
  return h;
}

class BitSource {
 public:
  explicit BitSource(std::span<const std::byte> bytes) : bytes_(bytes) {
    for (int i = 0; i < 4; ++i) next();
  }
  bool bit(Word p) {
    const Word b = static_cast<Word>(std::uint64_t{range_} * p >> 16);
    const bool one = code_ < b;
    if (one) {
      range_ = b;
    } else {
      code_ -= b;
      range_ -= b;
    }
    fill();
    return one;
  }
  Word bypass(unsigned n) {
    Word value = 0;
    while (n > 0) {
      const unsigned s = n < 8 ? n : 8;
      range_ /= 1U << s;
      Word v = code_ / range_;
      if (v > (1U << s) - 1) v = (1U << s) - 1;
      code_ -= v * range_;
      value = value << s | v;
      n -= s;
      fill();
    }
    return value;
  }
  [[nodiscard]] bool missing() const { return at_ > bytes_.size() + 4; }
  [[nodiscard]] bool finished() const {
    if (at_ == bytes_.size() + 4) return code_ < range_;
    if (at_ != bytes_.size() + 3) return false;
    const auto last = static_cast<std::uint64_t>(bytes_.back());
    return code_ < 1U << 24 && last != 0 && code_ + ((256 - last) << 24) >= range_;
  }

 private:
  void fill() {
    while (range_ < 1U << 24) {
      range_ <<= 8;
      next();
    }
  }
  void next() {
    code_ = code_ << 8 | (at_ < bytes_.size() ? static_cast<Word>(bytes_[at_]) : 0);
    ++at_;
  }
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  Word range_ = 0xFFFFFFFF, code_ = 0;
};

/// F(h, i).
struct F {
  Word h;
  Number i;
};

/// All adaptive state of a chunk.
class BitModels {
 public:
  BitModels(BitSource& source) : source_(source) {}

  struct Mixed {
    bool bit;
    Number q;
  };
  using Mixer = std::tuple<char, Number, Number>;
  Mixed mixed(const Mixer& mixer, std::span<const F> by);
  bool flag(const Mixer& mixer, std::initializer_list<F> by) {
    return mixed(mixer, {by.begin(), by.size()}).bit;
  }
  /// With two mixers (docs/native/continuous.md, "Bits").
  bool mixed_twice(const Mixer& a, const Mixer& b, const std::array<F, 5>& by);
  bool flag(Number mixer, std::initializer_list<F> by) { return flag({'f', mixer, 0}, by); }
  Word value(unsigned channel, const std::array<Word, 5>& hashes, unsigned bits);
  Number number(unsigned channel, const std::array<Word, 5>& hashes, std::initializer_list<F> sign);
  BitSource& source() { return source_; }

 private:
  static constexpr std::size_t kMaxInputs = 5;
  struct Counter {
    std::int32_t p = 1 << 21, n = 0;
  };
  using Bucket = std::array<Counter, 16>;
  Counter& counter(const F& f);
  static void count(Counter& counter, bool bit);
  std::array<Number, kMaxInputs>& weights_of(const Mixer& mixer, std::size_t inputs);
  struct Noise {
    Number gain = 8192, rest = 0;
  };
  BitSource& source_;
  std::vector<Bucket*> buckets_ = std::vector<Bucket*>(1 << 14);  ///< null: not in use
  std::deque<Bucket> used_;
  std::map<Mixer, std::array<Number, kMaxInputs>> mixers_;
  std::map<std::pair<unsigned, unsigned>, Noise> noise_;
};

}  // namespace gicodec::reference
