// The tables of a row chunk, for the reference decoder (docs/native/rows.md, "Tables").
#pragma once

#include "native/reference_entropy.h"
#include "native/reference_tables.h"

#include <array>

namespace gicodec::reference {

struct RowRepeats {
  std::array<RepeatDistribution, 16> distributions;
  std::array<unsigned, 180> map{};
};

template <std::size_t n>
bool read_map(Bytes& in, unsigned distributions, std::size_t entries,
              std::array<unsigned, n>& map) {
  const unsigned width = width_of(distributions - 1);
  unsigned held = 0, count = 0;
  for (std::size_t i = 0; i < entries; ++i) {
    while (count < width) {
      held |= in.u8() << count;
      count += 8;
    }
    map[i] = held % (1U << width);
    held >>= width;
    count -= width;
    if (map[i] >= distributions) return false;
  }
  return held == 0 && !in.failed();
}

struct RowTables {
  RowRepeats repeats;
  std::array<DistributionTables, 3> roles;

  /// `follow`, `lows`: how many channels there are of these.
  bool read(Bytes& in, bool exponent, std::size_t follow, std::size_t lows) {
    const unsigned n = read_repeats(in, repeats.distributions);
    if (n == 0 || !read_map(in, n, 180, repeats.map)) return false;
    const std::size_t entries[3] = {exponent ? 128U : 64U,
                                    follow == 0   ? 0U
                                    : follow == 1 ? 128U
                                                  : 256U,
                                    lows == 0 ? 0U : 128U};
    for (unsigned role = 0; role < 3; ++role) {
      if (entries[role] == 0) continue;
      const unsigned count = in.u8();
      if (count < 1 || count > 16) return false;
      for (unsigned i = 0; i < count; ++i) {
        if (!read_distribution(in, roles[role].distributions[i])) return false;
      }
      if (!read_map(in, count, entries[role], roles[role].map)) return false;
    }
    return true;
  }
};

}  // namespace gicodec::reference
