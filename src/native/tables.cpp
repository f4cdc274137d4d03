#include "native/tables.h"

#include <algorithm>
#include <array>
#include <bit>
#include <memory>

namespace gicodec::native {
namespace {

constexpr int digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : 63;
}

/// log2 in 1/256 bits, of 1..4096, negated and offset so that 4096 costs nothing.
constexpr std::array<std::uint16_t, kProbabilityScale + 1> make_costs() {
  std::array<std::uint16_t, kProbabilityScale + 1> cost{};
  cost[0] = 0xFFFF;
  for (std::uint32_t p = 1; p <= kProbabilityScale; ++p) {
    // Eight squarings give eight bits of the fraction.
    const int whole = 31 - std::countl_zero(p);
    std::uint64_t x = static_cast<std::uint64_t>(p) << (30 - whole);
    int fraction = 0;
    for (int i = 0; i < 8; ++i) {
      x = x * x >> 30;
      fraction *= 2;
      if (x >= std::uint64_t{1} << 31) {
        x >>= 1;
        ++fraction;
      }
    }
    cost[p] = static_cast<std::uint16_t>((12 - whole) * 256 - fraction);
  }
  return cost;
}
constexpr auto kCosts = make_costs();

struct Storage {
  Distribution family[kDistributions];
  std::uint8_t map[kSets][kRows * kRowSize];
  Tables tables[kSets][2];

  Storage() noexcept : family{} {
    for (unsigned d = 0; d < kDistributions; ++d) {
      build_distribution(kTableData.frequency[d], family[d]);
    }
    for (unsigned set = 0; set < kSets; ++set) {
      for (unsigned row = 0; row < kRows; ++row) {
        for (unsigned i = 0; i < kRowSize; ++i) {
          map[set][row * kRowSize + i] =
              i < kSignClasses * kMagnitudes
                  ? static_cast<std::uint8_t>(digit(kTableData.map[set][row][i]))
                  : std::uint8_t{0};
        }
      }
      for (unsigned update = 0; update < 2; ++update) {
        tables[set][update] = {family, map[set], kTableData.hits[set][update][0]};
      }
    }
  }
};

}  // namespace

void build_distribution(const std::uint16_t* frequency, Distribution& out) noexcept {
  std::uint32_t start = 0;
  for (unsigned s = 0; s < kTokens; ++s) {
    const std::uint32_t f = frequency[s];
    out.codes[s] = s << 24 | f << 12 | start;
    out.prices[s] = kCosts[f] + 256 * raw_bits_of(s);
    std::fill_n(out.slots + start, f, static_cast<std::uint8_t>(s));
    start += f;
  }
}

const Tables& tables(unsigned set, bool update) noexcept {
  static const Storage storage;
  return storage.tables[set][update ? 1 : 0];
}

std::uint16_t frequency_cost(std::uint32_t frequency) noexcept { return kCosts[frequency]; }

}  // namespace gicodec::native
