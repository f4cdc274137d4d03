// A client with far more pending than an update has room for is sent what is pending longest,
// without all being looked at each time.
#include "session/bricks.h"

#include <gicodec/textures.h>

#include <cstring>
#include <map>
#include <vector>

namespace gicodec {
namespace {

using namespace test;

constexpr Grid kBacklogGrid{32, 16, 4};
constexpr std::uint32_t kBacklogBlocks = 2048, kBacklogBudget = 32;

/// One texture whose records say when they were written.
struct Written {
  Written() {
    volume.kind = kKindTextures;
    volume.groups = {{{test::texture("written", Format::R32_UINT, 1, kBacklogGrid)}}};
    texture.assign(texture_bytes(volume.groups[0].textures[0].desc), std::byte{0});
  }
  void write(std::uint32_t block, std::uint32_t update) {
    std::memcpy(&texture[4 * block], &update, 4);
  }
  [[nodiscard]] Status publish(Distributor& distributor) const {
    return distributor.publish(0, 0, {texture});
  }

  VolumeDesc volume;
  Bytes texture;
};

struct Sent {
  std::vector<std::uint32_t> blocks;
  std::uint64_t examined = 0;
};

class Backlog : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(distributor_.add_volume(written_.volume, {kBacklogGrid}).ok());
    client_ = *distributor_.connect(Delivery::unicast, {kBacklogBudget, 0});
    ASSERT_EQ(distributor_.set_visible(client_, 0, BlockMask(kBacklogBlocks, 1)), Status::ok);
    for (std::uint32_t block = 0; block < kBacklogBlocks; ++block) written_.write(block, 1);
  }

  Sent update() {
    EXPECT_EQ(written_.publish(distributor_), Status::ok);
    EXPECT_EQ(distributor_.update(), Status::ok);
    auto sent = sent_by(distributor_, client_, decoders_, written_.volume)[0];
    return {{sent.begin(), sent.end()}, distributor_.written().examined};
  }

  Written written_;
  Distributor distributor_ = make_distributor("raw");
  ClientId client_ = 0;
  std::map<StreamId, Decoder> decoders_;
};

TEST_F(Backlog, IsSentInItsOrderAndLookedAtSeldom) {
  std::vector<std::uint32_t> times(kBacklogBlocks);
  std::uint64_t examined = 0;
  std::uint32_t changed_first = 0, updates = 0;
  for (std::uint32_t seen = 0; seen < kBacklogBlocks; ++updates) {
    ASSERT_LT(updates, 4 * kBacklogBlocks / kBacklogBudget);
    // Of each four blocks that are sent one comes again.
    for (std::uint32_t i = 0; i < kBacklogBudget / 4; ++i) {
      const std::uint32_t block = (updates * kBacklogBudget + i * 37) % kBacklogBlocks;
      written_.write(block, updates + 2);
    }
    const Sent sent = update();
    examined += sent.examined;
    EXPECT_LE(sent.blocks.size(), kBacklogBudget);
    for (const std::uint32_t block : sent.blocks) {
      if (times[block]++ == 0)
        ++seen;
      else if (seen < kBacklogBlocks)
        ++changed_first;
    }
  }
  EXPECT_LE(updates, kBacklogBlocks / kBacklogBudget + 8) << "what changed later came first";
  EXPECT_LT(changed_first, kBacklogBudget * 8);
  EXPECT_LT(examined, updates * std::uint64_t{kBacklogBlocks} * 2 / 3);
  for (int i = 0; i < 40; ++i) update();
  EXPECT_EQ(distributor_.state(client_)->pending, 0U);
}

TEST_F(Backlog, IsOfWhatIsSeenAndActiveNow) {
  update();
  // The later half is not seen any more, and every other block of the first not active.
  BlockMask visible(kBacklogBlocks, 0), active(kBacklogBlocks, 0);
  for (std::uint32_t block = 0; block < kBacklogBlocks; ++block) {
    visible[block] = block < kBacklogBlocks / 2 ? 1 : 0;
    active[block] = block % 2 == 0 ? 1 : 0;
  }
  ASSERT_EQ(distributor_.set_visible(client_, 0, visible), Status::ok);
  ASSERT_EQ(distributor_.set_active(0, active), Status::ok);
  std::size_t sent = 0;
  for (int i = 0; i < 40; ++i) {
    for (const std::uint32_t block : update().blocks) {
      EXPECT_LT(block, kBacklogBlocks / 2);
      EXPECT_EQ(block % 2, 0U);
      ++sent;
    }
  }
  EXPECT_GT(sent, kBacklogBlocks / 4 - kBacklogBudget);
  EXPECT_LE(sent, kBacklogBlocks / 4);
}

TEST_F(Backlog, GoesWithItsVolume) {
  update();
  ASSERT_TRUE(distributor_.add_volume(written_.volume, {kBacklogGrid}).ok());
  ASSERT_EQ(distributor_.remove_volume(0), Status::ok);
  ASSERT_EQ(distributor_.publish(1, 0, {written_.texture}), Status::ok);
  ASSERT_EQ(distributor_.set_visible(client_, 1, BlockMask(kBacklogBlocks, 1)), Status::ok);
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(distributor_.update(), Status::ok);
    ASSERT_EQ(distributor_.packets(client_).size(), 1U);
    EXPECT_EQ(distributor_.packets(client_)[0].stream.volume, 1U);
    EXPECT_EQ(distributor_.packets(client_)[0].blocks, kBacklogBudget);
  }
}

}  // namespace
}  // namespace gicodec
