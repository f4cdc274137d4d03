// A server that is asked for more than the way to its clients carries: what arrives, how late, and
// how evenly. In virtual time over a modelled path.
#include "path_to_server.h"

#include <cstdio>
#include <tuple>

namespace gicodec {
namespace {

using namespace test;

constexpr double kUpdateInterval = PathToServer::kInterval;

void print(const std::string& what, const Measured& m) {
  std::printf("%-20s %6.2f MB/s  latency %3.0f, 95 %% %3.0f ms  fewest %.2f  updates %.2f\n",
              what.c_str(), m.goodput * 1e-6, m.typical * 1e3, m.late * 1e3, m.fairness,
              m.fewest_updates);
}

class Overload : public testing::TestWithParam<std::tuple<Delivery, double>> {};

TEST_P(Overload, DegradesGracefully) {
  const auto [delivery, delay] = GetParam();
  const std::size_t fit = delivery == Delivery::unicast ? 3 : 10;
  const double rate = 1.02 * PathToServer::demand() * static_cast<double>(fit);
  for (const std::size_t load : {1, 2, 5, 20}) {
    PathToServer path(rate);
    path.join(fit * load, delivery, delay);
    path.run(5);
    const Measured m = path.measure(6);
    print(std::to_string(load) + " x the capacity", m);
    EXPECT_GE(m.goodput, 0.8 * rate);
    EXPECT_LT(m.late, 3 * kUpdateInterval + 2 * delay);
    EXPECT_GT(m.fairness, 0.8);
    EXPECT_EQ(m.dropped + m.gaps, 0U);
  }
}

INSTANTIATE_TEST_SUITE_P(Ways, Overload,
                         testing::Combine(testing::Values(Delivery::unicast, Delivery::shared),
                                          testing::Values(0.0, 0.15)));

/// Long ways are used all the time, also after they were looked at.
TEST(OverloadTest, LongWaysAreFilled) {
  for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
    for (const double delay : {0.05, 0.15}) {
      if (!test::everything() && (delivery == Delivery::unicast) != (delay < 0.1)) continue;
      constexpr double kRate = 10 * 125000;
      PathToServer path(1e9);
      path.join(1, delivery, delay, kRate);
      path.run(4);
      for (int i = 0; i < 15; ++i) {
        const Measured m = path.measure(2);
        EXPECT_GE(m.goodput, 0.5 * kRate) << i;
      }
      const Measured m = path.measure(12);
      print("10 Mbps", m);
      EXPECT_GE(m.goodput, 0.8 * kRate);
      EXPECT_LT(m.late, 3 * kUpdateInterval + 2 * delay);
    }
  }
}

/// What all may be sent is shared out evenly and kept.
TEST(OverloadTest, BandwidthIsShared) {
  for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
    constexpr double kRate = 2e6;
    ServerOptions options;
    options.limits.max_total_bytes_per_second = static_cast<std::uint64_t>(kRate);
    PathToServer path(1e9, options);
    path.join(5, delivery, 0.01);
    path.run(4);
    const Measured m = path.measure(8);
    print("2 MB/s for all", m);
    EXPECT_GE(m.goodput, 0.8 * kRate);
    EXPECT_LE(m.goodput, 1.05 * kRate);
    EXPECT_GT(m.fairness, 0.8);
  }
}

/// Links of 1 to 20 Mbps side by side: each is used, none delays another's updates, and what comes
/// over them is right.
TEST(OverloadTest, SlowLinksAreFilled) {
  for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
    ServerOptions options;
    options.proofs = true;
    PathToServer path(1e9, options);
    constexpr double kDelay = 0.02;
    const std::vector<double> links{1, 2, 5, 20};
    for (const double mbps : links) path.join(2, delivery, kDelay, mbps * 125000, false);
    path.run(5);
    path.begin();
    path.run(8);
    for (std::size_t i = 0; i < links.size(); ++i) {
      const Measured m = path.measured(8, 2 * i, 2);
      print(std::to_string(static_cast<int>(links[i])) + " Mbps", m);
      EXPECT_GE(m.goodput, 0.8 * 2 * links[i] * 125000);
      EXPECT_LT(m.late, 3 * kUpdateInterval + 2 * kDelay);
      EXPECT_EQ(m.dropped + m.gaps + m.failed_proofs, 0U);
    }
  }
}

/// Who joins an overloaded server waits no longer for what it gets, and soon gets as much as
/// others.
TEST(OverloadTest, JoiningClientsAreServed) {
  for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
    const std::size_t fit = delivery == Delivery::unicast ? 3 : 10;
    PathToServer path(1.02 * PathToServer::demand() * static_cast<double>(fit));
    path.join(2 * fit, delivery, 0.02);
    path.run(6);
    path.join(fit, delivery, 0.02);
    path.begin();
    path.run(3);
    const Measured joining = path.measured(3, 2 * fit, fit);
    print("joining", joining);
    EXPECT_LT(joining.late, 3 * kUpdateInterval + 0.04);
    const Measured m = path.measure(6);
    print("three seconds later", m);
    EXPECT_GT(m.fairness, 0.7);
    EXPECT_EQ(m.dropped + m.gaps, 0U);
  }
}

/// A path that suddenly carries a tenth: what is on its way then is late, what comes later is not.
TEST(OverloadTest, FollowsAPathThatGetsSlower) {
  for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
    const double rate = 3 * PathToServer::demand();
    PathToServer path(rate);
    path.join(3, delivery, 0.02);
    path.run(6);
    path.set_rate(rate / 10);
    path.run(5);
    const Measured slow = path.measure(6);
    print("a tenth", slow);
    EXPECT_GE(slow.goodput, 0.8 * rate / 10);
    EXPECT_LT(slow.late, 3 * kUpdateInterval + 0.04);
    path.set_rate(rate);
    path.run(8);
    const Measured fast = path.measure(6);
    print("all of it again", fast);
    EXPECT_GE(fast.goodput, 0.8 * rate);
    EXPECT_EQ(fast.dropped + fast.gaps, 0U);
  }
}

}  // namespace
}  // namespace gicodec
