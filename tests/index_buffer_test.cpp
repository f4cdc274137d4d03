// Probe index buffers: every small subset, large and adversarial ones, hostile bytes.
#include "support.h"

#include "bitstream/index_buffer.h"
#include "native/reference_bits.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <map>

namespace gicodec {
namespace {

using namespace test;
using Probes = Vector<std::uint32_t>;

/// Encodes into an exact buffer, checks the bound, decodes and compares. Returns the size.
std::size_t round_trip(const Probes& probes, std::uint32_t total) {
  Bytes out;
  const auto mode = encode_index_buffer(probes, total, out);
  EXPECT_LE(out.size(), (total + 7U) / 8);
  const Exact bytes(out);
  Probes back{77};
  EXPECT_EQ(decode_index_buffer(mode, static_cast<std::uint32_t>(probes.size()), total,
                                bytes.span(), back),
            Status::ok);
  EXPECT_EQ(back, probes);
  return out.size();
}

TEST(IndexBuffer, EverySubsetOfUpToTwelve) {
  for (std::uint32_t total = 1; total <= 12; ++total) {
    for (std::uint32_t bits = 0; bits < 1U << total; ++bits) {
      Probes probes;
      for (std::uint32_t i = 0; i < total; ++i) {
        if ((bits >> i & 1) != 0) probes.push_back(i);
      }
      round_trip(probes, total);
      ASSERT_FALSE(HasFailure()) << total << " " << bits;
    }
  }
}

RC_GTEST_PROP(IndexBuffer, RandomSelectionsOfLargeGrids, (std::uint64_t seed)) {
  Random random(seed);
  const auto total = pick(random, 1, chance(random, 4) ? 200000 : 9000);
  const auto probes = random_selection(random, total);
  round_trip({probes.begin(), probes.end()}, total);
  RC_ASSERT(!testing::Test::HasFailure());
}

TEST(IndexBuffer, EmptyAndFullTakeNoBytes) {
  for (const std::uint32_t total : {1U, 8U, 8192U, kMaxBlocks}) {
    EXPECT_EQ(round_trip({}, total), 0U);
    if (total > 10000) continue;
    Probes all(total);
    for (std::uint32_t i = 0; i < total; ++i) all[i] = i;
    EXPECT_EQ(round_trip(all, total), 0U);
  }
}

TEST(IndexBuffer, LargestGrid) {
  EXPECT_LE(round_trip({0}, kMaxBlocks), 4U);
  EXPECT_LE(round_trip({kMaxBlocks - 1}, kMaxBlocks), 7U);
  EXPECT_LE(round_trip({0, kMaxBlocks - 1}, kMaxBlocks), 10U);
  EXPECT_LE(round_trip({0, 1, 2, 3, kMaxBlocks / 2, kMaxBlocks - 2, kMaxBlocks - 1}, kMaxBlocks),
            40U);
}

// The paper's bound: below 1 kB for 8,192 probes, of which a bitmap is the worst case.
TEST(IndexBuffer, NeverMoreThanABitmapFor8192Probes) {
  constexpr std::uint32_t kTotal = 8192;
  std::size_t worst = 0;
  Random random(3);
  for (std::uint32_t step = 1; step <= 64; ++step) {
    for (std::uint32_t run = 1; run <= step; ++run) {
      Probes probes;
      for (std::uint32_t i = 0; i < kTotal; ++i) {
        if (i % (step + 1) < run) probes.push_back(i);
      }
      worst = std::max(worst, round_trip(probes, kTotal));
    }
  }
  for (std::uint32_t percent = 1; percent < 100; ++percent) {
    Probes probes;
    for (std::uint32_t i = 0; i < kTotal; ++i) {
      if (random() % 100 < percent) probes.push_back(i);
    }
    worst = std::max(worst, round_trip(probes, kTotal));
  }
  EXPECT_EQ(worst, 1024U);
}

TEST(IndexBuffer, SparseSelectionsAreMuchSmaller) {
  Random random(4);
  Probes sparse, block;
  for (std::uint32_t i = 0; i < 8192; ++i) {
    if (random() % 100 == 0) sparse.push_back(i);
    if (i >= 3000 && i < 4000) block.push_back(i);
  }
  EXPECT_LT(round_trip(sparse, 8192), 110U);
  EXPECT_LT(round_trip(block, 8192), 8U);
}

/// Clusters far from each other, in which every second block or so changed.
TEST(IndexBuffer, RunsLearnWhatListsAreLike) {
  constexpr std::uint32_t kTotal = 200000, kClusters = 100, kOfCluster = 30;
  Random random(5);
  Probes probes;
  for (std::uint32_t cluster = 0; cluster < kClusters; ++cluster) {
    std::uint32_t block = cluster * (kTotal / kClusters) + pick(random, 0, 1000);
    for (std::uint32_t i = 0; i < kOfCluster; ++i) probes.push_back(block += pick(random, 1, 3));
  }
  // Of 1.6 bits a step; Rice codes take 9 for each.
  EXPECT_LT(round_trip(probes, kTotal), kClusters * kOfCluster * 5 / 16);
}

/// FORMAT.md, "Index buffer", from the page alone.
class LearnedNumbers {
 public:
  LearnedNumbers(std::span<const std::byte> bytes, std::uint32_t total, std::uint32_t count)
      : source_(bytes), usual_(total / count) {}

  Probes blocks(std::uint32_t count) {
    Probes blocks;
    for (std::uint32_t next = 0; blocks.size() < count && !source_.missing();) {
      const std::uint32_t skipped = number(0);
      far_ = skipped >= 15;
      next += skipped + (blocks.empty() ? 0 : 1);
      for (std::uint32_t more = number(1) + 1; more > 0 && blocks.size() < count; --more) {
        blocks.push_back(next++);
      }
    }
    return blocks;
  }
  [[nodiscard]] bool finished() const { return source_.finished(); }

 private:
  struct Counter {
    std::int64_t p = 32768, a = 0;
  };
  bool bit(Counter& counter) {
    const auto p = std::clamp<std::int64_t>(counter.p, 1024, 64512);
    const bool one = source_.bit(static_cast<std::uint32_t>(p));
    const std::int64_t d = one ? 65535 - counter.p : counter.p;
    const std::int64_t step = d * (131072 / (2 * counter.a + 3)) / 65536;
    counter.p += one ? step : -step;
    counter.a = std::min<std::int64_t>(counter.a + 1, 30);
    return one;
  }
  std::uint32_t number(std::uint32_t kind) {
    std::uint32_t w = 1;
    for (; w <= 24; ++w) {
      const bool likely = kind == 0 && (std::uint64_t{2} << w) <= usual_;
      auto [counter, fresh] = widths_.try_emplace({kind, far_ ? 1U : 0U, w});
      if (fresh && likely) counter->second = {58982, 1};
      if (!bit(counter->second)) break;
    }
    std::uint32_t value = 1;
    for (std::uint32_t left = w - 1; left > 0; --left) {
      const bool modelled = w - left <= 2;
      const bool one = modelled ? bit(digits_[{kind, w, value}]) : false;
      if (!modelled) return (value << left | source_.bypass(left)) - 1;
      value = 2 * value + (one ? 1 : 0);
    }
    return value - 1;
  }

  reference::BitSource source_;
  std::uint32_t usual_;
  bool far_ = false;
  std::map<std::array<std::uint32_t, 3>, Counter> widths_, digits_;
};

RC_GTEST_PROP(IndexBuffer, RunsAreAsThePageSays, (std::uint64_t seed)) {
  Random random(seed);
  const auto total = pick(random, 1, 9000);
  const auto selection = random_selection(random, total);
  const Probes probes(selection.begin(), selection.end());
  Bytes out;
  if (encode_index_buffer(probes, total, out) != IndexMode::runs) return;
  const auto count = static_cast<std::uint32_t>(probes.size());
  LearnedNumbers numbers(out, total, count);
  RC_ASSERT(numbers.blocks(count) == probes);
  RC_ASSERT(numbers.finished());
}

/// Whatever the bytes: an error, or ascending indices in range of the right number.
void check_hostile(IndexMode mode, std::uint32_t count, std::uint32_t total,
                   std::span<const std::byte> bytes) {
  const Exact exact(bytes);
  Probes probes;
  if (decode_index_buffer(mode, count, total, exact.span(), probes) != Status::ok) return;
  ASSERT_EQ(probes.size(), count);
  ASSERT_TRUE(probes.empty() || probes.back() < total);
  ASSERT_EQ(std::ranges::adjacent_find(probes, std::greater_equal<>()), probes.end());
}

RC_GTEST_PROP(IndexBuffer, HostileBytes, (std::uint64_t seed)) {
  Random random(seed);
  for (int round = 0; round < 200; ++round) {
    const auto total = pick(random, 1, chance(random, 2) ? 20 : 5000);
    const auto count =
        chance(random, 8) ? static_cast<std::uint32_t>(random()) : pick(random, 0, total + 1);
    auto bytes = noise(random, chance(random, 4) ? index_buffer_bound(total) : random() % 40);
    if (!bytes.empty() && chance(random, 2)) bytes[0] &= std::byte{0x63};  // Small parameters.
    check_hostile(static_cast<IndexMode>(random() % 4), count, total, bytes);
  }
  RC_ASSERT(!testing::Test::HasFailure());
}

TEST(IndexBuffer, TruncationAndBitFlips) {
  Random random(6);
  for (const std::uint32_t total : {9U, 64U, 300U, 4096U}) {
    for (int round = 0; round < 12; ++round) {
      const auto selection = random_selection(random, total);
      const Probes probes(selection.begin(), selection.end());
      Bytes out;
      const auto mode = encode_index_buffer(probes, total, out);
      const auto count = static_cast<std::uint32_t>(probes.size());
      for (std::size_t size = 0; size < out.size(); ++size) {
        const Exact cut{std::span(out).first(size)};
        Probes back;
        const Status status = decode_index_buffer(mode, count, total, cut.span(), back);
        // The binary coder takes any bytes, the same list from no others.
        ASSERT_TRUE(status == Status::corrupt || (mode == IndexMode::runs && back != probes));
        check_hostile(mode, count, total, cut.span());
      }
      auto longer = out;
      longer.push_back(std::byte{0});
      Probes back;
      ASSERT_EQ(decode_index_buffer(mode, count, total, longer, back), Status::corrupt);
      for (std::size_t bit = 0; bit < out.size() * 8; ++bit) {
        check_hostile(mode, count, total, flip_bit(out, bit));
      }
      for (const std::uint32_t other : {count + 1, count - 1, total, total + 1, UINT32_MAX}) {
        check_hostile(mode, other, total, out);
      }
      ASSERT_FALSE(HasFailure());
    }
  }
}

TEST(IndexBuffer, ModesWithTheWrongShapeAreRefused) {
  Probes probes;
  const Bytes none, one(1, std::byte{0});
  const auto decode = [&](IndexMode mode, std::uint32_t count, std::uint32_t total,
                          const Bytes& bytes) {
    return decode_index_buffer(mode, count, total, bytes, probes);
  };
  EXPECT_EQ(decode(IndexMode::all, 7, 8, none), Status::corrupt);
  EXPECT_EQ(decode(IndexMode::all, 8, 8, one), Status::corrupt);
  EXPECT_EQ(decode(IndexMode::all, 8, 8, none), Status::ok);
  EXPECT_EQ(decode(IndexMode::gaps, 0, 8, one), Status::corrupt);
  EXPECT_EQ(decode(IndexMode::runs, 0, 8, none), Status::corrupt);
  EXPECT_EQ(decode(IndexMode::bitmap, 0, 8, one), Status::corrupt);
  EXPECT_EQ(decode(IndexMode::gaps, 9, 8, one), Status::corrupt);
  // A bit beyond the grid, too many and too few bits.
  EXPECT_EQ(decode(IndexMode::bitmap, 1, 7, Bytes(1, std::byte{0x80})), Status::corrupt);
  EXPECT_EQ(decode(IndexMode::bitmap, 1, 8, Bytes(1, std::byte{0x81})), Status::corrupt);
  EXPECT_EQ(decode(IndexMode::bitmap, 2, 8, Bytes(1, std::byte{0x80})), Status::corrupt);
  EXPECT_EQ(decode(IndexMode::bitmap, 1, 8, Bytes(1, std::byte{0x80})), Status::ok);
  // One gap of 0 with k = 0 and two bits of padding set; all padding zero.
  EXPECT_EQ(decode(IndexMode::gaps, 1, 8, Bytes(1, std::byte{0x80})), Status::corrupt);
  EXPECT_EQ(decode(IndexMode::gaps, 1, 8, Bytes(1, std::byte{0x40})), Status::corrupt);
  EXPECT_EQ(decode(IndexMode::gaps, 1, 8, Bytes(1, std::byte{0x00})), Status::ok);
  // Rice parameters above 24.
  EXPECT_EQ(decode(IndexMode::gaps, 1, 8, Bytes(8, std::byte{25})), Status::corrupt);
  // Longer than a bitmap, and runs that do not end, or do not end as the coder does.
  EXPECT_EQ(decode(IndexMode::runs, 1, 8, Bytes(8, std::byte{25})), Status::corrupt);
  EXPECT_EQ(decode(IndexMode::runs, 1, 800, Bytes(1, std::byte{0})), Status::corrupt);
  EXPECT_EQ(decode(IndexMode::runs, 1, 800, Bytes(8, std::byte{0xFF})), Status::corrupt);
  // Longer than a bitmap: probe 9 of 10, then of 8·2, by nine ones and a zero behind k = 0.
  const Bytes nine{std::byte{0xE0}, std::byte{0x3F}};
  EXPECT_EQ(decode(IndexMode::gaps, 1, 10, nine), Status::ok);
  EXPECT_EQ(probes, Probes{9});
  const Bytes seven{std::byte{0xE0}, std::byte{0x0F}};
  EXPECT_EQ(decode(IndexMode::gaps, 1, 8, seven), Status::corrupt);
}

}  // namespace
}  // namespace gicodec
