// Flags, values and numbers by mixed bits (docs/native.md, "Mixed bits"): what the models of
// sets and of records are made of.
#pragma once

#include "native/mixed/mixed_bits.h"

#include <gicodec/record.h>

#include <bit>
#include <cstdlib>

namespace gicodec::native {

inline constexpr std::size_t kValueContexts = 5, kFlagContexts = 3;
using ValueContexts = std::array<std::uint32_t, kValueContexts>;  ///< hashes
/// A counter: a hash, and one of its 16.
struct FlagContext {
  std::uint32_t hash, index;
};

/// Memory of one thread, kept for its capacity.
class ValueModel {
 public:
  static constexpr unsigned kFlags = 256, kChannels = 2 * static_cast<unsigned>(kMaxComponents);
  static constexpr std::size_t kOfAll = kChannels;

  void reset() {
    counters_.reset();
    flags_.assign(kFlags, {});
    values_.assign(kOfAll * kMaxBits, {});
    widths_.assign(kOfAll * kMaxBits, {});
    digits_.assign(kOfAll * kMaxDigits, {});
    noise_.assign(kOfAll * kNibbles, {});
  }

  template <typename Coder>
  bool flag(Coder& coder, unsigned mixer, const std::array<FlagContext, kFlagContexts>& by,
            bool value) {
    return flag(coder, flags_[mixer], by, value);
  }
  /// Without other contexts.
  template <typename Coder>
  bool flag(Coder& coder, unsigned mixer, std::uint32_t context, bool value) {
    return flag(coder, mixer, {{{context, 0}, {context, 1}, {context, 2}}}, value);
  }
  /// For mixers of the caller's.
  [[nodiscard]] CounterTable& counters() { return counters_; }
  /// With a mixer of the caller's.
  template <typename Coder>
  bool flag(Coder& coder, Mixer<kFlagContexts>& mixer,
            const std::array<FlagContext, kFlagContexts>& by, bool value) {
    std::array<Counter*, kFlagContexts> context;
    for (std::size_t i = 0; i < kFlagContexts; ++i) {
      context[i] = counters_[by[i].hash] + by[i].index;
    }
    std::uint32_t probability = 0;
    return code_bit(coder, context, mixer, value, probability);
  }

  /// A value of `bits` bits, four at a time from the highest on. Noise is
  /// coded by bypass bits, and modelled again after a while. `channel`: whose mixers and noise.
  template <typename Coder>
  std::uint32_t value(Coder& coder, unsigned channel, const ValueContexts& by, unsigned bits,
                      std::uint32_t value) {
    std::uint32_t prefix = 1;
    for (unsigned done = 0, n = 0; done < bits; ++n) {
      const unsigned width = std::min(4U, bits - done);
      Noise& noise = noise_[channel * kNibbles + n];
      std::uint32_t nibble = value >> (bits - done - width) & ((1U << width) - 1);
      if (noise.bypass > 0) {
        --noise.bypass;
        nibble = coder.bypass(width, nibble);
      } else {
        nibble = modelled(coder, channel * kMaxBits + done, by, prefix, width, nibble, noise);
      }
      prefix = prefix << width | nibble;
      done += width;
    }
    // Of 32 bits the 1 before them is gone.
    return bits == 32 ? prefix : prefix & ((1U << bits) - 1);
  }

  /// A number of up to 32 bits and a sign: its width, its sign by `signs`, the bits below its
  /// first one.
  template <typename Coder>
  std::int64_t number(Coder& coder, unsigned channel, const ValueContexts& by,
                      const std::array<FlagContext, kFlagContexts>& signs, std::int64_t value) {
    constexpr unsigned kMax = 32;
    const auto magnitude = static_cast<std::uint32_t>(std::abs(value));
    const auto actual = static_cast<unsigned>(std::bit_width(magnitude));
    std::array<Counter*, kValueContexts> context;
    unsigned width = 0;
    for (; width < kMax; ++width) {
      if (width % kStep == 0) {
        for (std::size_t i = 0; i < kValueContexts; ++i) {
          context[i] = counters_[hashed(by[i], width)];
        }
      }
      std::uint32_t probability = 0;
      const bool more = code_bit(coder, context, widths_[channel * kMaxBits + width],
                                 actual > width, probability);
      for (auto& c : context) ++c;
      if (!more) break;
    }
    if (width == 0) return 0;
    const bool negative = flag(coder, kSignFlags + channel, signs, value < 0);
    std::uint32_t read = 1;
    unsigned left = width - 1;
    for (unsigned digit = 0; digit < kMaxDigits && left > 0; ++digit) {
      --left;
      const std::array<Counter*, kFlagContexts> seen{
          counters_[hashed(kDigits, channel, width)] + (read & 15),
          counters_[hashed(by[0], kDigits, width)] + (read & 15),
          counters_[hashed(by[1], kDigits, width)] + (read & 15)};
      std::uint32_t probability = 0;
      const bool bit = code_bit(coder, seen, digits_[channel * kMaxDigits + digit],
                                (magnitude >> left & 1) != 0, probability);
      read = read << 1 | (bit ? 1U : 0U);
    }
    if (left > 0) {
      read = static_cast<std::uint32_t>(std::uint64_t{read} << left) |
             coder.bypass(left, magnitude & ((1U << left) - 1));
    }
    return negative ? -std::int64_t{read} : std::int64_t{read};
  }

 private:
  static constexpr unsigned kMaxBits = 32, kNibbles = 8, kMaxDigits = 3, kStep = 16;
  static constexpr unsigned kSignFlags = kFlags - kChannels;
  static constexpr std::uint32_t kDigits = 99;
  static constexpr std::int32_t kFirstGain = 8192, kMinGain = 512;
  static constexpr unsigned kBypassRun = 15;

  struct Noise {
    std::int32_t gain = kFirstGain;  ///< mean sum over a nibble of the margin of its bits'
                                     ///< probabilities over a half, of 65536
    unsigned bypass = 0;             ///< nibbles to come that are coded by bypass bits
  };

  template <typename Coder>
  std::uint32_t modelled(Coder& coder, unsigned mixer, const ValueContexts& by,
                         std::uint32_t prefix, unsigned width, std::uint32_t nibble, Noise& noise) {
    std::array<Counter*, kValueContexts> bucket;
    for (std::size_t i = 0; i < kValueContexts; ++i) bucket[i] = counters_[hashed(by[i], prefix)];
    std::uint32_t node = 1;
    std::int32_t margin = 0;
    for (unsigned b = 0; b < width; ++b) {
      std::array<Counter*, kValueContexts> context;
      for (std::size_t i = 0; i < kValueContexts; ++i) context[i] = bucket[i] + node;
      std::uint32_t probability = 0;
      const bool bit = code_bit(coder, context, values_[mixer + b],
                                (nibble >> (width - 1 - b) & 1) != 0, probability);
      const std::int32_t right = static_cast<std::int32_t>(probability) - 32768;
      margin += bit ? right : -right;
      node = node << 1 | (bit ? 1U : 0U);
    }
    noise.gain += (margin - noise.gain) >> 5;
    if (noise.gain < kMinGain) noise.bypass = kBypassRun;
    return node & ((1U << width) - 1);
  }

  CounterTable counters_;
  Vector<Mixer<kFlagContexts>> flags_, digits_;
  Vector<Mixer<kValueContexts>> values_, widths_;
  Vector<Noise> noise_;
};

}  // namespace gicodec::native
