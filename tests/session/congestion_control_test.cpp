// The limit of blocks in packets for few, as updates take their time, and when a client gets its
// next update.
#include "session/server/congestion_control.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

namespace gicodec {
namespace {

/// Updates of so many blocks for all, and as many for few as are wanted and the limit allows; each
/// takes the same time.
struct Load {
  double for_all, wanted, seconds_of_a_block, most;
  double limit = 0;

  double update() {
    const double few = limit == 0 ? wanted : std::min(wanted, limit);
    const double seconds = (for_all + few) * seconds_of_a_block;
    limit = next_limit_for_few(
        limit, {static_cast<std::uint64_t>(for_all + few), static_cast<std::uint64_t>(few), 0},
        seconds, most);
    return seconds;
  }
};

TEST(BlocksForFew, KeepUpdatesWithinTheirTime) {
  Load load{0, 4000, 1e-4, 0.2};
  double seconds = load.update();
  EXPECT_GT(seconds, 0.2);
  for (int i = 0; i < 20; ++i) seconds = load.update();
  EXPECT_NEAR(seconds, 0.14, 0.001);
  load.wanted = 100;
  for (int i = 0; i < 400; ++i) load.update();
  EXPECT_EQ(load.limit, 0);  // No limit where there is time.
}

/// Packets for all take most of the time, and for a while all of it.
TEST(BlocksForFew, AreNotStarvedByPacketsForAll) {
  Load load{1500, 4000, 1e-4, 0.2};
  for (int i = 0; i < 50; ++i) load.update();
  EXPECT_LT(load.update(), 0.2);
  EXPECT_NEAR(load.limit, 300, 10);  // 0.15 of the time.
  load.for_all = 2500;
  for (int i = 0; i < 50; ++i) load.update();
  EXPECT_NEAR(load.limit, 300, 10);
}

/// Looking for what to write takes longer than an update may, whatever is written.
TEST(BlocksForFew, AreNotStarvedByLookingForThem) {
  constexpr double kMax = 0.2, kLooking = 0.3, kBlock = 1e-5;
  const auto examined = static_cast<std::uint64_t>(64 * kLooking / kBlock);
  double limit = 1000;
  for (int i = 0; i < 100; ++i) {
    const auto few = static_cast<std::uint64_t>(limit);
    limit = next_limit_for_few(limit, {few, few, examined}, kLooking + kBlock * limit, kMax);
  }
  EXPECT_NEAR(limit, 0.15 * kMax / kBlock, 100);
}

/// Blocks that take longer than an update may come in every other one, or fewer.
TEST(BlocksForFew, MayTakeLongerThanAnUpdate) {
  constexpr double kMax = 0.1, kBlock = 0.13, kRest = 0.01;
  double limit = 0, left = 0, took = 0;
  int late = 0;
  constexpr int kUpdates = 1000, kFirst = 30;
  for (int i = 0; i < kUpdates; ++i) {
    left = std::min(left, 1.0) + limit;
    const std::uint64_t few = limit == 0 ? kFirst : left >= 1 ? 1 : 0;
    left -= static_cast<double>(few);
    const double seconds = kRest + kBlock * static_cast<double>(few);
    limit = next_limit_for_few(limit, {few + 1, few, 0}, seconds, kMax);
    took += seconds;
    late += seconds > 2 * kMax;
  }
  EXPECT_EQ(late, 1);
  EXPECT_GT(took / kUpdates, 0.5 * kMax);
  EXPECT_LT(took / kUpdates, kMax);
}

TEST(BlocksForFew, HaveNoLimitBeforeAnUpdateTakesTooLong) {
  EXPECT_EQ(next_limit_for_few(0, {100, 100, 0}, 0.1, 0.2), 0);
  EXPECT_EQ(next_limit_for_few(0, {0, 0, 0}, 0.1, 0.2), 0);
  EXPECT_LT(next_limit_for_few(0, {1, 1, 0}, 10, 0.2), 1);  // Not one in each update.
}

/// What docs/guarantees.md says: one and three quarters of an interval, and the path's own time.
TEST(CongestionControl, MakesNoUpdateWhileAnOlderOneIsLate) {
  constexpr double kPath = 0.25, kInterval = 0.125, kMade = 8;
  CongestionControl control(1 << 20);
  control.answered(kPath, 0);
  control.answered(2 * kPath, 1);  // The path was not idle.
  const auto at = [&](double intervals) {
    return control.budget(kMade + kPath + intervals * kInterval, kMade, 1, kInterval);
  };
  EXPECT_EQ(at(0), 1U << 20);
  EXPECT_EQ(at(1.75), 1U << 20);
  EXPECT_EQ(at(1.76), std::nullopt);
  EXPECT_EQ(at(100), std::nullopt);
  EXPECT_EQ(control.budget(100, std::nullopt, 0, kInterval), 1U << 20);  // All has arrived.
}

/// A path that is always busy may have become longer: once in ten seconds it is left idle.
TEST(CongestionControl, LooksAgainAtAPathThatIsAlwaysBusy) {
  constexpr double kPath = 0.25, kInterval = 0.125;
  CongestionControl control(1 << 20);
  control.answered(kPath, 0);
  control.acknowledged({.made = -kPath, .bytes = 1, .limited = true}, 0, kInterval, 1 << 20);
  const double whole = control.bytes();
  const auto at = [&](double now) { return control.budget(now, now, 1, kInterval); };
  EXPECT_EQ(at(10), whole);
  EXPECT_EQ(at(10.25), std::nullopt);
  EXPECT_EQ(at(10.25), std::nullopt);                               // until all has arrived,
  EXPECT_EQ(control.budget(10.5, std::nullopt, 0, kInterval), 0U);  // then an empty update
  // The path's own time is now twice what it was.
  control.acknowledged({.made = 10.5, .alone = true, .empty = true}, 11, kInterval, 1 << 20);
  EXPECT_EQ(control.budget(20.71, 20, 1, kInterval), whole);
  EXPECT_EQ(control.budget(20.72, 20, 1, kInterval), std::nullopt);
}

/// Queues in intervals between updates, and what they do to the budget.
TEST(CongestionControl, FollowsTheQueue) {
  constexpr double kPath = 0.25, kInterval = 0.125, kMean = 1 << 20;
  CongestionControl control(1 << 20);
  control.answered(kPath, 0);
  double now = 0;
  const auto after = [&](double queue) {
    const CongestionControl::Sent update{
        .made = now, .bytes = 1 << 20, .delivered = control.delivered(), .limited = true};
    now += kPath + queue * kInterval;
    const double before = control.bytes();
    control.acknowledged(update, now, kInterval, kMean);
    return control.bytes() - before;
  };
  EXPECT_EQ(after(0.5), kMean);  // A new client's doubles while there is none,
  const double slow = 0.05 * kMean * kPath / kInterval;
  EXPECT_NEAR(after(0.75), slow, 1);  // then grows by a twentieth of the mean and path,
  EXPECT_NEAR(after(0.25), slow, 1);
  EXPECT_NEAR(after(1), slow, 1);
  EXPECT_EQ(after(1.25), 0);  // then stays,
  EXPECT_LT(after(2), 0);     // and then becomes what gets through, less three tenths.
  EXPECT_NEAR(control.bytes(), 0.7 * kMean / 2, 1);
  EXPECT_NEAR(after(0.5), 0.25 * 0.7 * kMean / 2, 1);  // Small ones grow fast.
}

}  // namespace
}  // namespace gicodec
