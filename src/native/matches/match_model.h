// How literals, lengths and distances are coded, in both directions (docs/native/matches.md).
#pragma once

#include "base/memory.h"
#include "native/matches/bit_tree.h"
#include "native/matches/byte_order.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

namespace gicodec::native {

/// Numbers below 2^31: how many bits they have, then the four highest and the four lowest of those
/// below the first by trees.
struct MatchNumber {
  static constexpr unsigned kModelled = 4, kWidthBits = 5;
  BitTree<kWidthBits> width;
  std::array<BitTree<kModelled>, 1U << kWidthBits> high;
  BitTree<kModelled> low;

  template <typename Coder>
  std::uint32_t code(Coder& coder, std::uint32_t value) {
    const std::uint32_t bits = width.code(coder, static_cast<std::uint32_t>(std::bit_width(value)));
    if (bits <= 1) return bits;
    unsigned left = bits - 1;
    const auto part = [&](unsigned count) {
      left -= count;
      return value >> left & ((1U << count) - 1);
    };
    std::uint32_t number = 1;
    const unsigned first = std::min(left, kModelled);
    number = number << first | high[bits].code(coder, part(first), first);
    const unsigned last = left >= kModelled ? kModelled : 0;
    const unsigned middle = left - last;
    number = number << middle | coder.bypass(middle, part(middle));
    if (last != 0) number = number << last | low.code(coder, part(last));
    return number;
  }
};

/// How literals are coded.
enum class Literals : std::uint8_t {
  plain,     ///< eight bits
  together,  ///< by one tree
  apart,     ///< by one tree for each byte of a record
  after,     ///< by one tree for each value of the byte before
};
inline constexpr unsigned kLiterals = 4;

/// What a stream says: a length of 0 is a literal, a distance of 0 means zeros.
struct CodedMatch {
  std::uint32_t length = 0;
  std::uint64_t distance = 0;
};
inline constexpr std::uint64_t kNoDistance = UINT64_MAX;  ///< of what no encoder writes

inline constexpr std::uint32_t kMinMatch = 3;  ///< of new distances
inline constexpr unsigned kLastDistances = 4;
inline constexpr unsigned kZeros = kLastDistances;  ///< instead of the number of a last distance
inline constexpr std::size_t kByteContexts = 32;    ///< of bytes of records

/// The distances that were used last, the last first.
class LastDistances {
 public:
  explicit LastDistances(const Distances& first)
      : distance_{first.unit, first.row, first.block, first.far} {}
  [[nodiscard]] std::uint64_t operator[](unsigned i) const { return distance_[i]; }
  /// kLastDistances if there is none such.
  [[nodiscard]] unsigned find(std::uint64_t distance) const {
    const auto found = std::find(distance_.begin(), distance_.end(), distance);
    return static_cast<unsigned>(found - distance_.begin());
  }
  /// To the front; but the last one stays what it is, and the one before leaves if it is new.
  void use(std::uint64_t distance) {
    const unsigned found = find(distance);
    if (found == kLastDistances - 1) return;
    const unsigned at = std::min(found, kLastDistances - 2);
    for (unsigned i = at; i > 0; --i) distance_[i] = distance_[i - 1];
    distance_[0] = distance;
  }

 private:
  std::array<std::uint64_t, kLastDistances> distance_;
};

/// Codes literals and matches, one after the other.
class MatchModel {
 public:
  /// `trees`: memory for those of literals.
  MatchModel(Literals literals, const Distances& distances, Vector<BitTree<8>>& trees)
      : literals_(literals),
        unit_(distances.unit > kLargestUnit ? 1 : static_cast<std::uint32_t>(distances.unit)),
        last_(distances),
        trees_(trees) {
    trees_.assign(literals == Literals::after ? 256 : kByteContexts, {});
  }

  /// `byte`: index in its record. A length that is 0 says that a literal follows.
  template <typename Coder>
  CodedMatch match(Coder& coder, std::size_t byte, CodedMatch match) {
    const std::size_t context = std::min<std::size_t>(byte, kByteContexts - 1);
    const bool is_match = is_match_[after_][context].code(coder, match.length != 0);
    if (!is_match) {
      after_ = 0;
      return {};
    }
    const unsigned known = match.distance == 0 ? kZeros : last_.find(match.distance);
    const bool repeats =
        repeats_[after_].code(coder, match.distance == 0 || known < kLastDistances);
    after_ = repeats ? 2 : 1;
    if (repeats) {
      const unsigned which = which_.code(coder, known);
      match.length = 1 + length_[1].code(coder, match.length - 1);
      match.distance = which < kLastDistances ? last_[which] : which == kZeros ? 0 : kNoDistance;
    } else {
      match.length = kMinMatch + length_[0].code(coder, match.length - kMinMatch);
      const std::uint32_t of = std::min(match.length - kMinMatch, kLengths - 1);
      const auto units = static_cast<std::uint32_t>(match.distance / unit_);
      auto rest = static_cast<std::uint32_t>(match.distance % unit_);
      if (unit_ > 1) rest = rest_.code(coder, rest);
      match.distance = std::uint64_t{distance_[of].code(coder, units)} * unit_ + rest;
      if (match.distance == 0) match.distance = kNoDistance;
    }
    if (match.distance != 0) last_.use(match.distance);
    return match;
  }
  /// `before`: the byte before, or 0.
  template <typename Coder>
  std::uint8_t literal(Coder& coder, std::size_t byte, std::uint8_t before, std::uint8_t value) {
    std::size_t context = 0;
    switch (literals_) {
      case Literals::plain:
        return static_cast<std::uint8_t>(coder.bypass(8, value));
      case Literals::together:
        break;
      case Literals::apart:
        context = std::min<std::size_t>(byte, kByteContexts - 1);
        break;
      case Literals::after:
        context = before;
        break;
    }
    return static_cast<std::uint8_t>(trees_[context].code(coder, value));
  }

 private:
  static constexpr std::uint32_t kLengths = 4;  // that distances are told apart by
  static constexpr unsigned kUnitBits = 5, kLargestUnit = 1U << kUnitBits;

  Literals literals_;
  std::uint32_t unit_;  // distances are multiples of it, most of all
  unsigned after_ = 0;  // a literal, a match of a new distance, of a last one
  LastDistances last_;
  Vector<BitTree<8>>& trees_;
  std::array<std::array<MatchBit, kByteContexts>, 3> is_match_;
  std::array<MatchBit, 3> repeats_;
  BitTree<3> which_;
  std::array<MatchNumber, 2> length_;
  std::array<MatchNumber, kLengths> distance_;
  BitTree<kUnitBits> rest_;
};

}  // namespace gicodec::native
