// Blocks that name others: what they name is found once, is bounded, and keeps nobody waiting for
// ever.
#include "session/bricks.h"

#include <atomic>
#include <numeric>

namespace gicodec {
namespace {

using namespace test;

constexpr std::uint32_t kPages = 64, kEmitters = 96, kNamed = 4;

std::atomic<std::size_t> asked, most_room;

/// An emitter names the page of its number, modulo their number, and those after it.
std::size_t pages_of(std::span<const std::byte> emitter, std::span<std::uint32_t> out) {
  ++asked;
  most_room = std::max<std::size_t>(most_room, out.size());
  std::uint32_t first = 0;
  std::memcpy(&first, emitter.data(), sizeof first);
  for (std::uint32_t i = 0; i < std::min<std::size_t>(kNamed, out.size()); ++i) {
    out[i] = (first + i) % kPages;
  }
  return kNamed;
}

/// Every page and more, as often as there is room.
template <std::size_t count>
std::size_t far_too_many(std::span<const std::byte> emitter, std::span<std::uint32_t> out) {
  static_cast<void>(pages_of(emitter, out));
  for (std::uint32_t i = kNamed; i < out.size(); ++i) out[i] = i * kPages;
  return count;
}

using Named = std::size_t (*)(std::span<const std::byte>, std::span<std::uint32_t>);

class Emitters {
 public:
  explicit Emitters(Named named = pages_of) : pages_(kPages), emitters_(kEmitters) {
    DistributorOptions options;
    options.backend = "raw";
    options.region = {4, 1, 1};
    distributor_.emplace(*Distributor::create(options));
    volume_.groups.resize(2);
    volume_.groups[0].textures = {
        texture("pages", Format::R32_UINT, 1, {kPages, 1, 1}, Space::pool)};
    volume_.groups[1].textures = {
        texture("emitters", Format::R32_UINT, 1, {kEmitters, 1, 1}, Space::pool)};
    volume_.groups[1].depends_on = 0;
    volume_.groups[1].dependencies = named;
    EXPECT_TRUE(distributor_->add_volume(volume_, {{kPages, 1, 1}}).ok());
    std::iota(pages_.begin(), pages_.end(), 1U);
    std::iota(emitters_.begin(), emitters_.end(), 1U);
    asked = most_room = 0;
  }
  ClientId connect(Delivery delivery, Budget budget = {}) {
    const ClientId client = *distributor_->connect(delivery, budget);
    EXPECT_EQ(distributor_->set_visible(client, 0, BlockMask(kEmitters, 1), 1), Status::ok);
    return client;
  }
  void update() {
    ASSERT_EQ(distributor_->publish(0, 0, ConstTextureView(std::as_bytes(std::span(pages_)))),
              Status::ok);
    ASSERT_EQ(distributor_->publish(0, 1, ConstTextureView(std::as_bytes(std::span(emitters_)))),
              Status::ok);
    ASSERT_EQ(distributor_->update(), Status::ok);
  }
  /// All of them have other contents.
  void change(std::vector<std::uint32_t>& blocks) {
    for (std::uint32_t& block : blocks) block += static_cast<std::uint32_t>(blocks.size());
  }

  std::optional<Distributor> distributor_;
  VolumeDesc volume_{kKindBricks, {}};
  std::vector<std::uint32_t> pages_, emitters_;
};

/// Though all that is named changes in every update, and fewer blocks than one names have room.
TEST(Names, NobodyWaitsForWhatKeepsChanging) {
  struct Case {
    Delivery delivery;
    Budget budget;
  };
  for (const Case& one : {Case{Delivery::unicast, {1, 0}}, Case{Delivery::unicast, {3, 0}},
                          Case{Delivery::unicast, {0, 100}}, Case{Delivery::shared, {0, 100}},
                          Case{Delivery::shared, {0, 1}}, Case{Delivery::shared, {3, 0}}}) {
    SCOPED_TRACE(testing::Message() << static_cast<int>(one.delivery) << ' ' << one.budget.blocks
                                    << ' ' << one.budget.bytes);
    Emitters emitters;
    const ClientId client = emitters.connect(one.delivery, one.budget);
    std::map<StreamId, Decoder> decoders;
    std::vector<std::uint32_t> pages(kPages), times(kEmitters);
    for (int update = 0; update < 4000; ++update) {
      emitters.change(emitters.pages_);
      if (update % 10 == 0) emitters.change(emitters.emitters_);
      emitters.update();
      for (const OutgoingPacket& packet : emitters.distributor_->packets(client)) {
        const TextureDesc& desc = emitters.volume_.groups[packet.stream.texture].textures[0].desc;
        const bool shared = one.delivery == Delivery::shared;
        const RegionGrid cut = regions_of(desc, emitters.distributor_->options().region);
        auto& decoder =
            decoders
                .try_emplace(
                    packet.stream,
                    *Decoder::create(shared ? region_texture(desc, {4, 1, 1}, packet.stream.region)
                                            : desc))
                .first->second;
        ASSERT_EQ(decoder.decode(*packet.packet), Status::ok);
        const auto places =
            shared ? cut.blocks_of(packet.stream.region) : std::vector<std::uint32_t>();
        for (const std::uint32_t at : listed_blocks(decoder, *packet.packet)) {
          const std::uint32_t block = shared ? places[at] : at;
          if (packet.stream.texture == 0) {
            ++pages[block];
            continue;
          }
          ++times[block];
          const std::uint32_t first = emitters.emitters_[block];
          for (std::uint32_t i = 0; i < kNamed; ++i) EXPECT_GT(pages[(first + i) % kPages], 0U);
        }
      }
      for (const OutgoingPacket& packet : emitters.distributor_->packets(client)) {
        static_cast<void>(emitters.distributor_->acknowledge(client, packet.stream,
                                                             peek(*packet.packet)->sequence));
      }
    }
    EXPECT_GE(*std::min_element(times.begin(), times.end()), 5U);
    EXPECT_GE(*std::min_element(pages.begin(), pages.end()), 5U);
  }
}

/// However many clients there are, and however many updates.
TEST(Names, BlocksAreAskedOnceForEachPublishedContents) {
  Emitters emitters;
  for (std::uint32_t i = 0; i < 6; ++i) emitters.connect(Delivery::unicast, {i % 3, 0});
  for (int i = 0; i < 3; ++i) emitters.connect(Delivery::shared);
  emitters.update();
  EXPECT_EQ(asked, kEmitters);
  for (int i = 0; i < 3; ++i) {
    emitters.change(emitters.pages_);
    emitters.update();
  }
  EXPECT_EQ(asked, kEmitters);
  emitters.emitters_[7] += 1;
  emitters.update();
  EXPECT_EQ(asked, kEmitters + 1);
}

/// What clients want follows what is named, visible and active, for those who saw the same, too.
TEST(Names, WantedIsWhatIsNamedNow) {
  Emitters emitters;
  const ClientId a = emitters.connect(Delivery::unicast), b = emitters.connect(Delivery::unicast);
  BlockMask one(kEmitters, 0);
  one[0] = 1;
  for (const ClientId client : {a, b}) {
    ASSERT_EQ(emitters.distributor_->set_visible(client, 0, one, 1), Status::ok);
  }
  std::map<StreamId, Decoder> decoders[2];
  const auto pages_sent = [&](int i) {
    return sent_by(*emitters.distributor_, i == 0 ? a : b, decoders[i], emitters.volume_)[0];
  };
  using Blocks = std::vector<std::uint32_t>;
  emitters.update();
  for (int i = 0; i < 2; ++i) EXPECT_EQ(pages_sent(i), (Blocks{1, 2, 3, 4}));
  emitters.emitters_[0] = 3;
  one[1] = 1;
  ASSERT_EQ(emitters.distributor_->set_visible(b, 0, one, 1), Status::ok);
  emitters.emitters_[1] = 20;
  emitters.update();
  EXPECT_EQ(pages_sent(0), (Blocks{5, 6}));
  EXPECT_EQ(pages_sent(1), (Blocks{5, 6, 20, 21, 22, 23}));
  BlockMask active(kEmitters, 1);
  active[0] = 0;
  ASSERT_EQ(emitters.distributor_->set_active(0, active, 1), Status::ok);
  emitters.change(emitters.pages_);
  emitters.update();
  EXPECT_EQ(pages_sent(0), Blocks());
  EXPECT_EQ(pages_sent(1), (Blocks{20, 21, 22, 23}));
}

/// A kind may claim any number.
TEST(Names, AreNoMoreThanThereAreBlocks) {
  for (const Named named : {far_too_many<SIZE_MAX>, far_too_many<std::size_t{1} << 30>}) {
    for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
      Emitters emitters(named);
      const ClientId client = emitters.connect(delivery);
      emitters.update();
      EXPECT_EQ(most_room, kPages);
      std::uint32_t blocks = 0;
      for (const OutgoingPacket& packet : emitters.distributor_->packets(client)) {
        blocks += packet.blocks;
      }
      EXPECT_EQ(blocks, kPages + kEmitters);
      EXPECT_LT(emitters.distributor_->memory(), std::size_t{1} << 20);
    }
  }
}

}  // namespace
}  // namespace gicodec
