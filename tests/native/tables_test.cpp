// The tables: the published numbers, what is built from them, and fits of new distributions.
#include "native/planes/tables.h"

#include "native/planes/distribution_fit.h"
#include "native/planes/table_data.h"
#include "support.h"

#include <gtest/gtest.h>

#define XXH_STATIC_LINKING_ONLY
#include <xxhash.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>

namespace gicodec::native {
namespace {

std::string read(const char* path) {
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  EXPECT_FALSE(text.empty()) << path;
  return text;
}

/// Any that is valid, of few and of many symbols.
Distribution any_distribution(test::Random& random) {
  Distribution m{static_cast<std::uint8_t>(test::pick(random, 0, kMaxUnit)),
                 static_cast<std::uint8_t>(test::pick(random, 0, kMaxShift)),
                 {}};
  m.units[kEscape] = 1;
  const unsigned most = test::chance(random, 3) ? kEscape : test::pick(random, 0, kEscape);
  unsigned left = test::chance(random, 3) ? 254 : test::pick(random, 0, 254);
  for (unsigned s = 0; s < kListed && left > 0; ++s) {
    if (s > most || test::chance(random, 5)) continue;
    const auto units = test::pick(random, 0, std::min(left, 60U));
    m.units[s] = static_cast<std::uint8_t>(m.units[s] + units);
    left -= units;
  }
  m.units[kEscape] = static_cast<std::uint8_t>(m.units[kEscape] + left);
  return m;
}

TEST(NativeTables, DataIsSound) {
  const std::uint16_t* next = kTableNumbers;
  for (unsigned role = 0; role < kRoles; ++role) {
    for (unsigned set = 0; set < kSets; ++set) {
      for (unsigned m = 0; m < kDistributions; ++m) {
        const Distribution& distribution = distribution_of(role, set, m);
        EXPECT_TRUE(valid(distribution)) << role << " " << set << " " << m;
        EXPECT_EQ(*next++, distribution.unit);
        EXPECT_EQ(*next++, distribution.shift);
        for (const auto units : distribution.units) ASSERT_EQ(*next++, units);
      }
      for (const auto distribution : role_tables(role, set).map) {
        EXPECT_LT(distribution, kDistributions);
        ASSERT_EQ(*next++, distribution);
      }
    }
  }
  for (const bool update : {false, true}) {
    for (unsigned set = 0; set < kSets; ++set) {
      const RepeatTables& tables = repeat_tables(update, set);
      for (unsigned m = 0; m < kDistributions; ++m, next += 2) {
        EXPECT_LE(1, next[0]);
        EXPECT_LT(next[0], next[1]);
        EXPECT_LE(next[1], 4095);
        for (unsigned k = 0; k < 2; ++k) {
          ASSERT_EQ(tables.low[k][m] | tables.high[k][m] << 8, next[k]);
        }
      }
      for (const auto distribution : tables.map) {
        EXPECT_LT(distribution, kDistributions);
        ASSERT_EQ(*next++, distribution);
      }
    }
  }
  EXPECT_EQ(next, std::end(kTableNumbers));
}

TEST(NativeTables, ThePageNamesTheirChecksum) {
  const std::string numbers = read(GICODEC_TABLES_FILE), page = read(GICODEC_NATIVE_PAGE);
  std::ostringstream sum;
  sum << std::hex << XXH3_64bits(numbers.data(), numbers.size());
  const std::string expected = "0x" + std::string(16 - sum.str().size(), '0') + sum.str();
  std::smatch found;
  ASSERT_TRUE(std::regex_search(
      page, found,
      std::regex(R"(XXH3\s+checksum\s+\(64 bits, seed 0\)\s+is\s+`(0x[0-9a-f]{16})`)")));
  EXPECT_EQ(found[1], expected) << "docs/native.md, section 8, should say `" << expected << "`";
}

TEST(NativeTables, ValidDistributions) {
  Distribution m{4, 7, {}};
  EXPECT_FALSE(valid(m));
  m.units[kEscape] = 1;
  EXPECT_TRUE(valid(m));
  m.units[0] = 254;
  EXPECT_TRUE(valid(m));
  m.units[1] = 1;
  EXPECT_FALSE(valid(m));
  m.units[1] = 0;
  m.unit = 5;
  EXPECT_FALSE(valid(m));
  m.unit = 0;
  m.shift = 8;
  EXPECT_FALSE(valid(m));
}

/// Of every value, by the table in section 5 of the page.
TEST(NativeTables, CodesOfValues) {
  constexpr unsigned kRange[kSymbols][2] = {{1, 0},  {2, 0},   {3, 0},  {4, 0},  {5, 0},  {6, 0},
                                            {7, 0},  {8, 2},   {12, 2}, {16, 3}, {24, 3}, {32, 5},
                                            {64, 6}, {128, 7}, {0, 16}, {0, 0}};
  test::Random random(5);
  RoleTables tables{};
  for (int round = 0; round < 40; ++round) {
    const Distribution m = any_distribution(random);
    ASSERT_TRUE(valid(m));
    const unsigned number = test::pick(random, 0, kDistributions - 1);
    build_distribution(m, number, tables);
    for (unsigned value = 0; value <= 0xFFFF; ++value) {
      unsigned symbol = kEscape;
      for (unsigned s = 0; s < kSymbols; ++s) {
        const unsigned base = kRange[s][0] << m.shift;
        const unsigned count = 1U << (kRange[s][1] + m.shift);
        if (s != kEscape && value >= base && value < base + count) symbol = s;
      }
      if (symbol != kZero && m.units[symbol] == 0) symbol = kEscape;
      unsigned start = 0;
      for (unsigned s = 0; s < std::min(symbol, kListed); ++s) start += m.units[s] << m.unit;
      const unsigned frequency = symbol == kZero ? kProbabilityScale - start
                                                 : static_cast<unsigned>(m.units[symbol]) << m.unit;
      const unsigned raw = std::min(kRange[symbol][1] + m.shift, 16U);
      const unsigned bin = bin_of(static_cast<std::uint16_t>(value));
      ASSERT_EQ(code_of(m, bin), start | frequency << 12 | raw << 24) << value;
      ASSERT_EQ(price_of(m, bin), frequency_cost(frequency) + 256 * raw) << value;
      ASSERT_EQ(tables.by_bin[number][bin], code_of(m, bin));
      ASSERT_EQ(tables.price[number][bin], price_of(m, bin));
    }
  }
}

TEST(NativeTables, CostsAreLogarithms) {
  EXPECT_EQ(frequency_cost(4096), 0);
  EXPECT_EQ(frequency_cost(2048), 256);
  EXPECT_EQ(frequency_cost(1), 12 * 256);
  for (unsigned f = 2; f <= 4096; ++f) EXPECT_LE(frequency_cost(f), frequency_cost(f - 1));
}

std::uint64_t cost(const std::uint32_t (&counts)[kBins], const Distribution& m) {
  std::uint64_t sum = 0;
  for (unsigned bin = 0; bin <= bin_of(0xFFFF); ++bin) {
    sum += std::uint64_t{counts[bin]} * static_cast<std::uint64_t>(price_of(m, bin));
  }
  return sum;
}

/// Counts of few bins, of many, or as a distribution would have them.
void any_counts(test::Random& random, std::uint32_t (&counts)[kBins]) {
  std::fill(std::begin(counts), std::end(counts), 0U);
  const unsigned values = 1U << test::pick(random, 0, 12);
  const unsigned shape = test::pick(random, 0, 2), bits = test::pick(random, 0, 16);
  for (unsigned i = 0; i < values; ++i) {
    const unsigned width = shape == 0 ? bits : test::pick(random, 0, bits);
    const auto value = static_cast<std::uint16_t>(random() & ((1U << width) - 1));
    ++counts[shape == 1 ? test::pick(random, 0, bin_of(value)) : bin_of(value)];
  }
}

/// Valid, and little is gained by any other: by escapes alone, or by those of the tables.
TEST(NativeTables, FittedDistributions) {
  test::Random random(6);
  Distribution escapes{4, 0, {}};
  escapes.units[kEscape] = 255;
  std::uint32_t counts[kBins] = {};
  EXPECT_TRUE(valid(fit_distribution(counts)));
  for (int round = 0; round < 400; ++round) {
    any_counts(random, counts);
    const Distribution fitted = fit_distribution(counts);
    ASSERT_TRUE(valid(fitted)) << round;
    ++counts[0];  // The value that a fit always allows for.
    std::uint64_t least = cost(counts, escapes);
    const std::uint64_t own = cost(counts, fitted);
    for (unsigned role = 0; role < kRoles; ++role) {
      for (unsigned set = 0; set < kSets; ++set) {
        for (unsigned m = 0; m < kDistributions; ++m) {
          least = std::min(least, cost(counts, distribution_of(role, set, m)));
        }
      }
    }
    ASSERT_LE(own, least + least / 500) << round;
  }
}

}  // namespace
}  // namespace gicodec::native
