#include "rooms.h"

#include <gtest/gtest.h>

#include <set>

namespace gicodec::photons {
namespace {

using namespace test;

PoolOptions few() {
  PoolOptions options;
  options.shots.emitted = 500;
  options.shots.capacity = 2048;
  options.per_watt = 200;  // 5 to 6 batches for each of two lamps of 4π watts
  options.batches = 16;
  options.per_update = 3;
  return options;
}

struct Fixture {
  Scene scene;
  ddgi::RayScene rays;
  ddgi::ThreadPool threads{2};
  BatchPool pool;

  explicit Fixture(Scene scene_in, const PoolOptions& options)
      : scene(std::move(scene_in)), rays(scene), pool(rays, options) {
    rays.set_state(scene.state_at(0));
  }
  BatchPool::Update at(double time) {
    rays.set_state(scene.state_at(time));
    return pool.update(threads);
  }
  void settle(double time) {
    while (at(time).stale > 0) {
    }
  }
  [[nodiscard]] std::set<std::uint32_t> of(std::uint32_t light) const {
    std::set<std::uint32_t> slots;
    for (std::uint32_t i = 0; i < pool.slots().size(); ++i) {
      if (pool.slots()[i].used && pool.slots()[i].light == light) slots.insert(i);
    }
    return slots;
  }
  /// Every batch is what would be shot now, in its box.
  void expect_fresh() const {
    ddgi::ThreadPool one(1);
    PoolOptions options = few();
    options.per_update = 0;
    BatchPool fresh(rays, options);
    fresh.update(one);
    std::map<std::uint32_t, const Emitter*> emitters;
    for (const auto& slot : fresh.slots()) {
      if (slot.used) emitters[slot.light] = &slot.emitter;
    }
    for (const auto& slot : pool.slots()) {
      if (!slot.used) continue;
      ASSERT_FALSE(slot.stale);
      const Shot other = shoot(rays, *emitters.at(slot.light), slot.light, slot.number, 0,
                               slot.shot.batch, pool.shots(), one);
      EXPECT_EQ(slot.shot.records, other.records);
      EXPECT_EQ(slot.shot.batch.watts, other.batch.watts);
    }
  }
};

TEST(BatchPool, AWholeNumberOfBatchesForEachWatt) {
  Fixture f(two_lights(), few());
  const auto update = f.at(0);
  EXPECT_EQ(f.of(0).size(), 6U);  // 4π · 200 / 500 = 5.03
  EXPECT_EQ(f.of(1).size(), 6U);
  EXPECT_EQ(update.wanted, 12U);
  PoolOptions dim = few();
  dim.per_watt = 0.01F;
  Fixture g(two_lights(), dim);
  g.at(0);
  EXPECT_EQ(g.of(0).size(), 1U);
  PoolOptions small = few();
  small.batches = 7;
  Fixture h(two_lights(), small);
  EXPECT_EQ(h.at(0).wanted, 12U);
  EXPECT_EQ(h.of(0).size() + h.of(1).size(), 7U);
  EXPECT_LE(std::max(h.of(0).size(), h.of(1).size()), 4U);
}

TEST(BatchPool, StaleBatchesLeaveAFewAtATime) {
  Fixture f(two_lights(), few());
  std::set<std::uint32_t> shot;
  for (std::uint32_t left = 12; left > 0; left -= 3) {
    const auto update = f.at(0);
    EXPECT_EQ(update.shot, 3U);
    EXPECT_EQ(update.stale, left - 3);
    EXPECT_EQ(update.changed.size(), 3U);
    shot.insert(update.changed.begin(), update.changed.end());
  }
  EXPECT_EQ(shot.size(), 12U);
  f.expect_fresh();
  EXPECT_TRUE(f.at(0).changed.empty());
}

TEST(BatchPool, OnlyBatchesOfLightsThatChangedAreShotAgain) {
  Fixture f(two_lights(), few());
  f.settle(0);
  const auto before = std::vector<BatchPool::Slot>(f.pool.slots().begin(), f.pool.slots().end());
  std::set<std::uint32_t> changed;
  for (int i = 0; i < 2; ++i) {
    const auto update = f.at(3);
    EXPECT_EQ(update.shot, 3U);
    changed.insert(update.changed.begin(), update.changed.end());
  }
  EXPECT_EQ(changed, f.of(0));
  EXPECT_EQ(f.at(3).shot, 0U);
  for (const std::uint32_t slot : f.of(0)) {
    EXPECT_NE(f.pool.slots()[slot].shot.records, before[slot].shot.records);
    EXPECT_EQ(f.pool.slots()[slot].shot.batch.generation, before[slot].shot.batch.generation + 1);
  }
  for (const std::uint32_t slot : f.of(1)) {
    EXPECT_EQ(f.pool.slots()[slot].shot.records, before[slot].shot.records);
    EXPECT_EQ(f.pool.slots()[slot].shot.batch, before[slot].shot.batch);
  }
  f.expect_fresh();
}

TEST(BatchPool, LightsThatFadeKeepTheirPhotons) {
  PoolOptions options = few();
  options.per_watt = 0.01F;  // a batch each, however bright
  Fixture f(two_lights(), options);
  f.settle(0);
  const BatchPool::Slot before = f.pool.slots()[*f.of(0).begin()];
  const auto update = f.at(1);
  EXPECT_EQ(update.shot, 0U);
  EXPECT_EQ(std::set<std::uint32_t>(update.changed.begin(), update.changed.end()), f.of(0));
  const BatchPool::Slot& after = f.pool.slots()[*f.of(0).begin()];
  EXPECT_EQ(after.shot.records, before.shot.records);
  EXPECT_FLOAT_EQ(after.shot.batch.watts, before.shot.batch.watts / 2);
  EXPECT_EQ(f.at(2).shot, 1U) << "another hue";
}

TEST(BatchPool, AMovedObjectTouchesOnlyPathsNearIt) {
  Fixture f(two_lights(), few());
  f.settle(0);
  const auto update = f.at(4);
  EXPECT_GT(update.shot + update.stale, 0U);
  f.settle(4);
  // Light 1 is behind the wall: none of its batches was shot again.
  for (const std::uint32_t slot : f.of(1)) {
    const auto& changed = update.changed;
    EXPECT_EQ(std::count(changed.begin(), changed.end(), slot), 0);
  }
  f.expect_fresh();
}

TEST(BatchPool, ADarkLightHasNone) {
  Fixture f(two_lights(), few());
  f.settle(0);
  const auto slots = f.of(0);
  const auto update = f.at(5);
  EXPECT_EQ(std::set<std::uint32_t>(update.changed.begin(), update.changed.end()), slots);
  EXPECT_TRUE(f.of(0).empty());
  for (const std::uint32_t slot : slots) {
    EXPECT_EQ(f.pool.slots()[slot].shot.batch, PhotonBatch{});
    EXPECT_TRUE(f.pool.slots()[slot].shot.records.empty());
  }
  f.settle(0);
  EXPECT_EQ(f.of(0).size(), 6U);
  f.expect_fresh();
}

TEST(PhotonSource, FramesAreTheSameForAnyNumberOfThreads) {
  const auto frames = [](unsigned threads) {
    kinds::TraceRequest request;
    request.scene = two_lights();
    request.settings = settings({"photons=300", "per-watt=100", "max-batches=9", "form=R"});
    request.threads = threads;
    kinds::Feed feed = trace(std::move(request));
    std::vector<std::vector<std::vector<std::byte>>> all;
    for (const double time : {0, 0, 1, 3, 4, 5, 0}) {
      all.push_back(feed.next({time, {}}).volumes[0].textures);
    }
    return all;
  };
  const auto one = frames(1);
  EXPECT_EQ(frames(2), one);
  EXPECT_EQ(frames(5), one);
  EXPECT_NE(one[1], one[2]);
}

TEST(PhotonSource, SaysWhatIsLeftOut) {
  kinds::TraceRequest request;
  request.scene = two_lights();
  request.settings = settings({"photons=300", "max-batches=1"});
  kinds::Feed feed = trace(std::move(request));
  ASSERT_EQ(feed.remarks.size(), 1U);
  EXPECT_NE(feed.remarks[0].find("sky"), std::string::npos);
  EXPECT_EQ(feed.next({0, {}}).remarks.size(), 1U);
  EXPECT_TRUE(feed.next({0, {}}).remarks.empty());
}

}  // namespace
}  // namespace gicodec::photons
