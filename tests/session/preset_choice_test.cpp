// Which preset is chosen: what delivers first, within the processor's time, and steadily.
#include "session/server/preset_choice.h"

#include "session/server/congestion_control.h"

#include <gicodec/probes.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace gicodec {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();
constexpr int kMany = 100;  ///< updates
constexpr ByPreset kUsual{1, 1, 1}, kCoded{0, 0.01, 0};

/// An update of 4,096 probes' colour at a ratio of about 12, in a preset.
PresetCosts colour(std::size_t preset) {
  PresetCosts costs;
  constexpr std::size_t kSizes[] = {115000, 85000, 83000};
  costs.add(ddgi_irradiance({16, 16, 16}, Format::A2B10G10R10_UNORM_PACK32), 4096, kSizes[preset],
            preset);
  return costs;
}

/// The preset after many updates, each coded in the preset of the time.
std::size_t settled(PresetChoice& choice, double throughput, double pace = 1,
                    std::size_t slowest = kStrong) {
  for (int i = 0; i < kMany; ++i) {
    choice.choose(colour(choice.preset()), throughput, {pace, pace, pace}, slowest);
  }
  return choice.preset();
}
std::size_t settled(double throughput, double pace = 1, std::size_t slowest = kStrong) {
  PresetChoice choice;
  return settled(choice, throughput, pace, slowest);
}

TEST(PresetChoice, LinksGetWhatDeliversFirst) {
  constexpr double kMbps = 125000;
  EXPECT_EQ(settled(0.5 * kMbps), kStrong);
  EXPECT_EQ(settled(20 * kMbps), kFast);
  EXPECT_EQ(settled(1000 * kMbps), kTurbo);
  EXPECT_EQ(settled(kUnlimited), kTurbo);
  EXPECT_EQ(settled(0), kFast);  // Not known.
}

/// For any data, machine and limit.
TEST(PresetChoice, HigherThroughputIsNeverSlower) {
  std::mt19937 random(5);
  const auto number = [&](double low, double high) {
    return std::exp(std::uniform_real_distribution(std::log(low), std::log(high))(random));
  };
  for (int i = 0; i < 200; ++i) {
    PresetCosts costs;
    for (unsigned textures = 0; textures < 3; ++textures) {
      TextureDesc desc = ddgi_irradiance({16, 16, 16});
      desc.model = static_cast<Model>(random() % 6);
      costs.add(desc, random() % 4096, random() % 1000000, random() % kPresets.size(),
                number(0.01, 1));
    }
    const ByPreset pace{number(0.1, 10), number(0.1, 10), number(0.1, 10)};
    const std::size_t slowest = random() % kPresets.size();
    std::size_t before = slowest;
    for (double throughput = 1; throughput < 1e12; throughput *= 1.7) {
      PresetChoice choice;
      for (int update = 0; update < kMany; ++update)
        choice.choose(costs, throughput, pace, slowest);
      EXPECT_LE(choice.preset(), before);
      before = choice.preset();
    }
  }
}

TEST(PresetChoice, ASlowMachineTakesFasterPresets) {
  for (double throughput = 1e3; throughput < 1e10; throughput *= 2) {
    EXPECT_LE(settled(throughput, 4), settled(throughput, 1));
    EXPECT_LE(settled(throughput, 1), settled(throughput, 0.25));
  }
}

/// Wherever the thresholds are: no more than one change of the preset for a throughput that goes up
/// and down by a tenth.
TEST(PresetChoice, OscillationChangesNothing) {
  for (const int period : {1, 5, 40}) {
    for (double throughput = 1e3; throughput < 1e10; throughput *= 1.05) {
      PresetChoice choice;
      int changes = 0;
      for (int i = 0; i < 400; ++i) {
        const std::size_t before = choice.preset();
        const double now = throughput * (i / period % 2 == 0 ? 0.9 : 1.1);
        choice.choose(colour(before), now, kUsual, kStrong);
        changes += choice.preset() != before;
      }
      EXPECT_LE(changes, 1) << throughput << " " << period;
    }
  }
}

TEST(PresetChoice, AChangeTakesSeveralUpdates) {
  PresetChoice choice;
  for (int i = 0; i < 7; ++i) choice.choose(colour(kFast), kUnlimited, kUsual, kStrong);
  choice.choose(colour(kFast), 2.5e6, kUsual, kStrong);  // Begins anew.
  for (int i = 0; i < 7; ++i) choice.choose(colour(kFast), kUnlimited, kUsual, kStrong);
  EXPECT_EQ(choice.preset(), kFast);
  choice.choose({}, kUnlimited, kUsual, kStrong);  // Nothing was sent.
  EXPECT_EQ(choice.preset(), kFast);
  choice.choose(colour(kFast), kUnlimited, kUsual, kStrong);
  EXPECT_EQ(choice.preset(), kTurbo);
}

TEST(PresetChoice, WithoutTimeAPresetIsLeftAtOnce) {
  PresetChoice choice;
  EXPECT_EQ(settled(choice, 1000), kStrong);
  choice.choose({}, 0, kUsual, kFast);
  EXPECT_EQ(choice.preset(), kFast);
  choice.choose(colour(kFast), 1000, kUsual, kTurbo);
  EXPECT_EQ(choice.preset(), kTurbo);
  EXPECT_EQ(settled(choice, 1000, 1, kTurbo), kTurbo);
  EXPECT_EQ(settled(choice, 1000), kStrong);
}

TEST(ProcessorTime, AnUpdateBeyondItsBudgetMakesItTurbo) {
  ProcessorTime time;
  EXPECT_EQ(time.slowest(), kFast);  // No report yet.
  for (int i = 0; i < kMany; ++i) time.report(0.01, 0.1, kCoded);
  EXPECT_EQ(time.slowest(), kStrong);
  time.report(0.101, 0.1, kCoded);
  EXPECT_EQ(time.slowest(), kTurbo);
  for (int i = 0; i < kMany; ++i) time.report(0.06, 0.1, kCoded);
  EXPECT_EQ(time.slowest(), kTurbo);  // In time, but without room.
  for (int i = 0; i < kMany; ++i) time.report(0.04, 0.1, kCoded);
  EXPECT_EQ(time.slowest(), kStrong);
}

/// A preset that there is no time for is tried ever less often, one below it goes on.
TEST(ProcessorTime, WhatTookTooLongIsTriedLessOften) {
  ProcessorTime time;
  int late = 0, strong = 0;
  constexpr int kUpdates = 4000;
  for (int i = 0; i < kUpdates; ++i) {
    constexpr double kSeconds[] = {0.01, 0.03, 0.2};
    late += time.slowest() == kStrong;
    time.report(kSeconds[time.slowest()], 0.1, kCoded);
    if (i >= kUpdates / 2) strong += time.slowest() == kFast;
  }
  EXPECT_LE(late, 10);
  EXPECT_GT(strong, kUpdates / 2 - 50);
}

TEST(ProcessorTime, LearnsThePaceOfTheMachine) {
  ProcessorTime time;
  EXPECT_EQ(time.pace(), kUsual);
  time.report(0.03, 0.1, kCoded);
  EXPECT_EQ(time.pace(), (ByPreset{3, 3, 3}));
  for (int i = 0; i < kMany; ++i) time.report(0.005, 0.1, kCoded);
  EXPECT_NEAR(time.pace()[kFast], 0.5, 0.01);
  EXPECT_NEAR(time.pace()[kTurbo], 0.5, 0.01);
  for (int i = 0; i < kMany; ++i) time.report(0.09, 0.1, {0, 1e-6, 0});  // Hardly anything coded.
  EXPECT_NEAR(time.pace()[kFast], 0.5, 0.01);
}

/// Much is published of which little is coded, as when a client joins.
TEST(ProcessorTime, PublishingIsNotCoding) {
  ProcessorTime time;
  time.report(0.02, 0.1, {0, 0.0005, 0}, 0.0095);
  EXPECT_NEAR(time.pace()[kFast], 2, 0.01);
  EXPECT_NEAR(time.pace()[kTurbo], 2, 0.01);
  for (int i = 0; i < kMany; ++i) time.report(0.01, 0.1, {0.0005, 0, 0}, 0.0095);
  EXPECT_NEAR(time.pace()[kFast], 1, 0.01);
}

/// A preset that takes longer than others here is known for that, and forgotten after a while.
TEST(ProcessorTime, LearnsThePaceOfEachPreset) {
  ProcessorTime time;
  time.report(0.01, 0.1, kCoded);
  for (int i = 0; i < kMany; ++i) time.report(0.09, 0.1, {0, 0, 0.01});
  EXPECT_NEAR(time.pace()[kStrong], 9, 0.01);
  EXPECT_LT(time.pace()[kFast], 4);
  for (int i = 0; i < kMany; ++i) time.report(0.01, 0.1, kCoded);
  EXPECT_NEAR(time.pace()[kFast], 1, 0.01);
  EXPECT_GT(time.pace()[kStrong], 6);
  for (int i = 0; i < 20 * kMany; ++i) time.report(0.01, 0.1, kCoded);
  EXPECT_NEAR(time.pace()[kStrong], 1, 0.01);
}

double low(std::vector<double> throughputs) { return low_throughput(throughputs); }

TEST(LowThroughput, IsThatOfATenthOfTheClients) {
  EXPECT_EQ(low({}), 0);
  EXPECT_EQ(low({5}), 5);
  EXPECT_EQ(low({5, 3}), 5);  // One of them may be slow.
  EXPECT_EQ(low({9, 5, 3}), 5);
  std::vector<double> hundred;
  for (int i = 100; i > 0; --i) hundred.push_back(i);
  EXPECT_EQ(low(hundred), 11);
}

/// From three on a client that says anything leaves the choice among the others.
TEST(LowThroughput, OneLiarChangesNothing) {
  for (const std::size_t others : {2, 3, 10, 50}) {
    for (const double lie : {1e-3, 50.0, kUnlimited}) {
      std::vector<double> values(others, 50);
      values.push_back(lie);
      EXPECT_EQ(low(values), 50);
      std::vector<double> different{lie};
      for (std::size_t i = 0; i < others; ++i) different.push_back(100 + static_cast<double>(i));
      EXPECT_GE(low(different), 100);
      EXPECT_LE(low(different), 100 + std::max(1.0, static_cast<double>(others) / 10));
    }
  }
}

/// Updates that queue behind each other at a link of 1 MB/s, on a path of 0.1 s.
TEST(Throughput, IsThatOfTheLink) {
  constexpr double kPath = 0.1, kInterval = 0.1, kRate = 1e6;
  for (const double bytes : {20e3, 80e3, 120e3}) {
    CongestionControl control(1 << 20);
    EXPECT_EQ(control.throughput(), 0);
    control.answered(kPath, 0);
    double free = 0;
    for (int i = 0; i < kMany; ++i) {
      const double made = i * kInterval;
      const double sent = std::max(free, made) + bytes / kRate;
      free = sent;
      control.acknowledged({.made = made, .bytes = static_cast<std::uint64_t>(bytes)}, sent + kPath,
                           kInterval, 1e6);
      control.acknowledged({.made = made, .bytes = 50}, sent + kPath, kInterval, 1e6);
    }
    EXPECT_NEAR(control.throughput(), kRate, 0.01 * kRate);
  }
  CongestionControl control(1 << 20);
  control.answered(kPath, 0);
  control.acknowledged({.made = 0, .bytes = 5000}, kPath, kInterval, 1e6);
  EXPECT_EQ(control.throughput(), kUnlimited);
}

}  // namespace
}  // namespace gicodec
