// Literals and matches of bytes in one pass: looks at the last distances and at one earlier place.
#pragma once

#include "base/memory.h"
#include "native/matches/match_model.h"
#include "native/matches/match_prices.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace gicodec::native {

inline std::uint32_t word_at(const std::uint8_t* bytes) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes, sizeof word);
  return word;
}

/// How many bytes from `at` on are those from `from` on, which is before.
inline std::size_t length_at(std::span<const std::uint8_t> bytes, std::size_t from,
                             std::size_t at) {
  const std::size_t most = bytes.size() - at;
  std::size_t length = 0;
  for (; length + 8 <= most; length += 8) {
    std::uint64_t a = 0, b = 0;
    std::memcpy(&a, &bytes[from + length], 8);
    std::memcpy(&b, &bytes[at + length], 8);
    if (a != b) return length + static_cast<std::size_t>(std::countr_zero(a ^ b)) / 8;
  }
  while (length < most && bytes[from + length] == bytes[at + length]) ++length;
  return length;
}

/// How many of the bytes from `at` on are 0.
inline std::size_t zeros_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  std::size_t end = at;
  for (std::uint64_t word = 0; end + 8 <= bytes.size(); end += 8) {
    std::memcpy(&word, &bytes[end], 8);
    if (word != 0) return end - at + static_cast<std::size_t>(std::countr_zero(word)) / 8;
  }
  while (end < bytes.size() && bytes[end] == 0) ++end;
  return end - at;
}

/// on_literals(at, count) and on_match(literals before it, way, length, distance), in turn.
/// `literal`: the price of one, about. Where nothing repeats only some places are looked at, by
/// what stands there: about one of 2^sparse, at last.
template <typename OnLiterals, typename OnMatch>
void parse_quickly(std::span<const std::uint8_t> bytes, const Distances& distances, Price literal,
                   unsigned sparse, Vector<std::uint32_t>& before, const OnLiterals& on_literals,
                   const OnMatch& on_match) {
  constexpr unsigned kHashBits = 15, kFewMisses = 8;
  const auto hash = [&](std::size_t at) {
    return word_at(&bytes[at]) * 0x9E3779B1U >> (32 - kHashBits);
  };
  before.assign(std::size_t{1} << kHashBits, UINT32_MAX);
  LastDistances last(distances);
  MatchPrices prices;
  std::size_t at = 0, begin = 0;  // of literals
  while (at + 4 <= bytes.size()) {
    const std::uint32_t word = word_at(&bytes[at]);
    auto& place = before[hash(at)];
    Price saved = 0;
    std::size_t length = 0, distance = 0;
    unsigned way = 0;
    const auto take = [&](unsigned by, std::size_t here, std::size_t back, Price price) {
      const Price saves = static_cast<Price>(here) * literal - price;
      if (saves <= saved + (here == length ? kHabit : 0)) return;
      saved = saves;
      length = here;
      distance = back;
      way = by;
    };
    if (bytes[at] == 0) take(kZeros, zeros_at(bytes, at), 0, prices.of(kZeros));
    for (unsigned i = 0; i < kLastDistances; ++i) {
      if (last[i] > at) continue;
      const std::size_t from = at - static_cast<std::size_t>(last[i]);
      if (bytes[from] != bytes[at]) continue;
      take(i, length_at(bytes, from, at), at - from, prices.of(i));
    }
    if (place != UINT32_MAX && word_at(&bytes[place]) == word) {
      const std::size_t back = at - place;
      take(kNewDistance, length_at(bytes, place, at), back, prices.of(back, distances.unit));
    }
    place = static_cast<std::uint32_t>(at);
    if (length == 0) {
      const auto misses = static_cast<unsigned>(std::bit_width((at - begin) >> kFewMisses));
      const std::uint32_t skipped = (1U << std::min(misses, sparse)) - 1;
      const std::size_t end = at + std::size_t{2} * skipped + 1;
      do {
        ++at;
      } while (at < end && at + 4 <= bytes.size() && (hash(at) & skipped) != 0);
      continue;
    }
    if (begin != at) on_literals(begin, at - begin);
    on_match(at - begin, way, length, distance);
    prices.count(at - begin, way);
    if (distance != 0) last.use(distance);
    at += length;
    begin = at;
  }
  if (begin != bytes.size()) on_literals(begin, bytes.size() - begin);
}

}  // namespace gicodec::native
