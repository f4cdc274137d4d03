// Shared streams for clients that take fewer updates than others: how many they get, and that what
// they miss is made up for by differences.
#include "support.h"
#include "volumes.h"

#include "session/server/distributor.h"

#include "session/server/shared_rate.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <map>

namespace gicodec {
namespace {

using namespace test;

constexpr Grid kSharedGrid{8, 4, 8};
constexpr std::uint32_t kSharedBlocks = 256;
constexpr std::size_t kStreams = 16;

/// Noise in a volume of 16 regions.
class SharedRates : public testing::Test {
 protected:
  void SetUp() override {
    DistributorOptions options;
    options.backend = "raw";
    options.region = {2, 4, 2};
    auto distributor = Distributor::create(options);
    ASSERT_TRUE(distributor.ok());
    distributor_.emplace(*std::move(distributor));
    ASSERT_TRUE(
        distributor_->add_volume(probes_of({{"color", texture_.desc()}}), {kSharedGrid}).ok());
  }

  struct Viewer {
    ClientId id = 0;
    std::map<StreamId, Decoder> decoders = {};
    std::uint64_t bytes = 0, keyframes = 0, catch_ups = 0, updates = 0;
  };

  Viewer join(std::uint64_t bytes) {
    const auto id = distributor_->connect(Delivery::shared, {0, bytes});
    EXPECT_TRUE(id.ok());
    EXPECT_EQ(distributor_->set_visible(*id, 0, BlockMask(kSharedBlocks, 1)), Status::ok);
    return {*id};
  }

  void update() {
    texture_.fill(Fill::noise, random_);
    ASSERT_EQ(distributor_->publish(0, 0, std::as_const(texture_).view()), Status::ok);
    ASSERT_EQ(distributor_->update(), Status::ok);
  }

  void deliver(Viewer& viewer) {
    for (const OutgoingPacket& packet : distributor_->packets(viewer.id)) {
      auto it = viewer.decoders.find(packet.stream);
      if (it == viewer.decoders.end()) {
        TextureDesc desc = texture_.desc();
        desc.grid = {2, 4, 2};
        it = viewer.decoders.emplace(packet.stream, *Decoder::create(desc)).first;
      }
      ASSERT_EQ(it->second.decode(*packet.packet), Status::ok);
      ASSERT_EQ(it->second.state_hash(), *distributor_->state_hash(viewer.id, packet.stream));
      const auto info = peek(*packet.packet);
      viewer.bytes += packet.packet->size();
      viewer.keyframes += is_keyframe(info->type);
      viewer.catch_ups += is_stand_in(info->type) && !is_keyframe(info->type);
    }
    viewer.updates += distributor_->packets(viewer.id).empty() ? 0 : 1;
  }

  Random random_{3};
  Texture texture_{ddgi_irradiance(kSharedGrid)};
  std::optional<Distributor> distributor_;
};

TEST_F(SharedRates, ABudgetIsUsedAndKeptOnAverage) {
  Viewer all = join(0);
  for (int i = 0; i < 8; ++i) {
    update();
    deliver(all);
  }
  const std::uint64_t whole = all.bytes / 8;
  std::vector<Viewer> viewers;
  std::vector<double> shares{0.9, 0.6, 0.5, 0.3, 0.125};
  for (const double share : shares) {
    viewers.push_back(join(static_cast<std::uint64_t>(share * static_cast<double>(whole))));
  }
  const auto run = [&](int updates) {
    for (int i = 0; i < updates; ++i) {
      update();
      deliver(all);
      for (Viewer& viewer : viewers) deliver(viewer);
    }
  };
  run(64);
  for (Viewer& viewer : viewers) viewer.bytes = viewer.keyframes = 0;
  const std::uint64_t before = all.bytes;
  run(64);
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const double share =
        static_cast<double>(viewers[i].bytes) / static_cast<double>(all.bytes - before);
    EXPECT_GT(share, 0.85 * shares[i]);
    EXPECT_LT(share, 1.1 * shares[i]);
    // What was skipped never means a snapshot.
    EXPECT_EQ(viewers[i].keyframes, 0U);
    EXPECT_GT(viewers[i].catch_ups, 0U);
    EXPECT_EQ(viewers[i].updates, 128U);  // Some regions in each.
  }
  EXPECT_EQ(all.keyframes, kStreams);
  EXPECT_EQ(all.catch_ups, 0U);
}

/// Skips of clients with one rate and group are the same packets, whenever they joined.
TEST_F(SharedRates, ClientsOfARateShareTheirPackets) {
  Viewer all = join(0);
  for (int i = 0; i < 3; ++i) update();
  const std::uint64_t budget = 20000;
  Viewer first = join(budget);
  for (int i = 0; i < 5; ++i) update();
  for (int i = 0; i < 3; ++i) static_cast<void>(join(0));
  Viewer second = join(budget);
  for (int i = 0; i < 100; ++i) update();
  ASSERT_FALSE(distributor_->packets(first.id).empty());
  EXPECT_LT(distributor_->packets(first.id).size(), kStreams);
  ASSERT_EQ(distributor_->packets(first.id).size(), distributor_->packets(second.id).size());
  for (std::size_t i = 0; i < distributor_->packets(first.id).size(); ++i) {
    EXPECT_EQ(distributor_->packets(first.id)[i].packet,
              distributor_->packets(second.id)[i].packet);
  }
}

/// A client that takes nothing for a while goes on with differences, as long as what it holds is
/// kept; else with snapshots.
TEST_F(SharedRates, WhoWasAwayGoesOn) {
  Viewer all = join(0), away = join(0);
  update();
  deliver(all);
  deliver(away);
  EXPECT_EQ(away.keyframes, kStreams);
  for (int round = 0; round < 3; ++round) {
    ASSERT_EQ(distributor_->suspend(away.id, true), Status::ok);
    for (int i = 0; i < 20; ++i) {
      update();
      deliver(all);
      deliver(away);
    }
    ASSERT_EQ(distributor_->suspend(away.id, false), Status::ok);
    update();
    deliver(all);
    deliver(away);
  }
  EXPECT_EQ(away.keyframes, kStreams);
  EXPECT_EQ(away.catch_ups, 3 * kStreams);
  // Many who stop at different times: of what they hold some is forgotten, and memory is bounded.
  std::vector<Viewer> many;
  for (int i = 0; i < 30; ++i) many.push_back(join(0));
  update();
  for (Viewer& viewer : many) deliver(viewer);
  std::size_t most = 0;
  for (Viewer& viewer : many) {
    ASSERT_EQ(distributor_->suspend(viewer.id, true), Status::ok);
    update();
    for (Viewer& other : many) deliver(other);
    most = std::max(most, distributor_->memory());
  }
  for (Viewer& viewer : many) ASSERT_EQ(distributor_->suspend(viewer.id, false), Status::ok);
  std::uint64_t keyframes = 0, catch_ups = 0;
  for (Viewer& viewer : many) viewer.keyframes = viewer.catch_ups = 0;
  for (int i = 0; i < 3; ++i) {  // A few states in each.
    update();
    for (Viewer& viewer : many) deliver(viewer);
  }
  for (Viewer& viewer : many) {
    keyframes += viewer.keyframes;
    catch_ups += viewer.catch_ups;
  }
  EXPECT_EQ(keyframes + catch_ups, 30 * kStreams);
  EXPECT_EQ(catch_ups, 12 * kStreams);
  EXPECT_LT(most, 24 * kSharedBlocks * block_bytes(texture_.desc()));
}

/// Nobody takes part: nothing is made.
TEST_F(SharedRates, NothingIsMadeForNobody) {
  Viewer viewer = join(0);
  update();
  deliver(viewer);
  ASSERT_EQ(distributor_->suspend(viewer.id, true), Status::ok);
  for (int i = 0; i < 5; ++i) update();
  ASSERT_EQ(distributor_->suspend(viewer.id, false), Status::ok);
  update();
  deliver(viewer);
  EXPECT_EQ(viewer.catch_ups, 0U);  // The next packet of the chain, as if there had been no others.
  EXPECT_EQ(viewer.decoders.begin()->second.sequence(), 2U);
}

/// Turns of a slower rate are turns of every faster one.
RC_GTEST_PROP(SharedRate, TurnsAreNested,
              (std::uint32_t first, std::uint32_t second, std::uint32_t group)) {
  SharedRate slow(group), fast(group);
  const std::uint64_t less = 1 + first % 10000, more = less + second % 10000;
  slow.choose({0, less}, 10, 3000);
  fast.choose({0, more}, 10, 3000);
  std::uint64_t turns = 0;
  for (std::uint64_t update = 0; update < 64; ++update) {
    for (std::size_t place = 0; place < 64; ++place) {
      turns += slow.turn(update, place);
      RC_ASSERT(!slow.turn(update, place) || fast.turn(update, place));
    }
  }
  const double share = static_cast<double>(turns) / (64 * 64);
  RC_ASSERT(std::abs(share - static_cast<double>(slow.share())) < 0.05);
}

/// The first packets are guessed, later ones measured.
TEST(SharedRate, LearnsWhatStreamsTake) {
  SharedRate rate(0);
  constexpr Budget kBudget{0, 1000};
  constexpr std::size_t kTen = 10, kBytes = 3000;
  rate.choose(kBudget, kTen, kBytes);
  EXPECT_LT(rate.share(), 0.2F);
  for (int update = 0; update < 100; ++update) {
    rate.choose(kBudget, kTen, kBytes);
    rate.sent(kTen, kTen * 20, kTen);
  }
  rate.choose(kBudget, kTen, kBytes);
  EXPECT_EQ(rate.share(), 1);
  for (int update = 0; update < 100; ++update) rate.sent(kTen, kTen * 400, kTen);
  rate.choose(kBudget, kTen, kBytes);
  EXPECT_NEAR(rate.share(), 0.25F, 0.01F);
}

}  // namespace
}  // namespace gicodec
