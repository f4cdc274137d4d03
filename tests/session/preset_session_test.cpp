// Servers that choose presets: by links, within their time; whatever they choose, every client
// holds the same bits.
#include "path_to_server.h"

#include <set>

namespace gicodec {
namespace {

using namespace test;

constexpr double kMbps = 125000, kDelay = 0.01;

ServerOptions with_proofs(BackendSettings settings = {}) {
  ServerOptions options;
  options.settings = std::move(settings);
  options.proofs = true;
  return options;
}

/// Noise in half of the bits of some blocks; updates take as long as the test likes.
class Presets : public PathToServer {
 public:
  explicit Presets(std::uint32_t blocks = 64, const ServerOptions& options = with_proofs(),
                   std::string_view backend = "native")
      : PathToServer(1e9, options, 1000, backend), blocks_(blocks) {
    BlockMask active(kBlocks);
    std::fill_n(active.begin(), blocks, std::uint8_t{1});
    EXPECT_EQ(server().set_active(0, active), Status::ok);
  }

  [[nodiscard]] std::string_view preset(std::size_t client) {
    return server().statistics(viewer(client).connection)->preset;
  }
  [[nodiscard]] const std::set<std::string_view>& seen() const { return seen_; }
  void set_update_time(double seconds) { seconds_ = seconds; }

  void expect_the_same_bits(std::size_t clients) const {
    for (std::size_t i = 0; i < clients; ++i) {
      const ClientStatistics statistics = viewer(i).client->statistics();
      EXPECT_FALSE(viewer(i).dropped);
      EXPECT_GT(statistics.proofs, 0U);
      EXPECT_EQ(statistics.failed_proofs + statistics.gaps, 0U);
    }
  }

 private:
  void paint(Texture& texture, Random& random) override {
    constexpr std::byte kNoise[] = {std::byte{0x1F}, std::byte{0x7C}, std::byte{0xF0},
                                    std::byte{0x01}};
    for (std::uint32_t block = 0; block < blocks_; ++block) {
      Bytes records = noise(random, guarded_bytes(texture.desc()));
      for (std::size_t i = 0; i < records.size(); ++i) records[i] &= kNoise[i % 4];
      texture.set_block(block, records);
      texture.fill_band(block);
    }
  }
  void after_update() override {
    server().report_update_time(seconds_, kInterval);
    const auto connections = server().connections();
    for (const ConnectionId connection : *connections)
      seen_.insert(server().statistics(connection)->preset);
  }

  std::uint32_t blocks_;
  double seconds_ = 0.001;
  std::set<std::string_view> seen_;
};

TEST(PresetSession, UnicastClientsGetTheirOwn) {
  Presets path(Presets::kBlocks);
  path.join(1, Delivery::unicast, kDelay, 0.5 * kMbps, false);
  path.join(1, Delivery::unicast, kDelay, 8000 * kMbps, false);
  path.run(6);
  EXPECT_EQ(path.preset(0), "strong");
  EXPECT_EQ(path.preset(1), "turbo");
  EXPECT_EQ(path.seen(), (std::set<std::string_view>{"turbo", "fast", "strong"}));
  path.expect_the_same_bits(2);
}

/// A server that takes too long goes to turbo, and comes back; also of shared packets, catch-ups of
/// slow clients among them.
TEST(PresetSession, UpdatesBeyondTheBudgetAreTurbo) {
  for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
    SCOPED_TRACE(static_cast<int>(delivery));
    Presets path;
    path.join(3, delivery, kDelay, 0.2 * kMbps, false);
    path.join(1, delivery, kDelay, 0.1 * kMbps, false);
    path.run(4);
    EXPECT_EQ(path.preset(0), "strong");
    path.set_update_time(0.11);
    path.run(0.3);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(path.preset(i), "turbo");
    path.run(1);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(path.preset(i), "turbo");
    path.set_update_time(0.001);
    path.run(10);
    EXPECT_EQ(path.preset(0), "strong");
    path.expect_the_same_bits(4);
  }
}

/// One that is slow, and one that acknowledges late, change nothing for others.
TEST(PresetSession, FewSlowClientsDoNotDecideForOthers) {
  Presets path(Presets::kBlocks);
  path.join(5, Delivery::shared, kDelay, 8000 * kMbps, false);
  path.run(4);
  EXPECT_EQ(path.preset(0), "turbo");
  path.join(1, Delivery::shared, kDelay, 0.1 * kMbps, false);
  path.join(1, Delivery::shared, 0.5, 1 * kMbps, false);
  for (int i = 0; i < 40; ++i) {
    path.run(0.1);
    EXPECT_EQ(path.preset(0), "turbo") << i;
  }
  path.expect_the_same_bits(7);
}

/// A client that acknowledges what it cannot have yet changes nothing for others either.
class EarlyAcknowledger : public Presets {
 public:
  void join_liar() {
    const auto connection = server().connect(now());
    liar_ = *connection;
    ClientOptions options;
    options.delivery = Delivery::shared;
    auto client = Client::create(options);
    server().receive(liar_, *client->hello(), now());
  }

 private:
  void tick() override {
    if (liar_ == 0) return;
    for (const Message& message : joined(server().take_messages(liar_))) {
      const auto read = read_message(message);
      const auto* update = read ? std::get_if<UpdateMessage>(&*read) : nullptr;
      if (update == nullptr) continue;
      Message bytes;
      ASSERT_EQ(write_message(Acknowledge{update->sync, update->number}, bytes), Status::ok);
      server().receive(liar_, bytes, now());
    }
  }

  ConnectionId liar_ = 0;
};

TEST(PresetSession, EarlyAcknowledgementsDoNotDecideForOthers) {
  EarlyAcknowledger path;
  path.join(4, Delivery::shared, kDelay, 0.2 * kMbps, false);
  path.run(6);
  EXPECT_EQ(path.preset(0), "strong");
  path.join_liar();
  for (int i = 0; i < 40; ++i) {
    path.run(0.1);
    EXPECT_EQ(path.preset(0), "strong") << i;
  }
  path.expect_the_same_bits(4);
}

TEST(PresetSession, WithoutReportsNoneIsSlowerThanFast) {
  class Silent : public Presets {
    void after_update() override {}
  } path;
  path.join(1, Delivery::unicast, kDelay, 0.2 * kMbps, false);
  path.run(6);
  EXPECT_EQ(path.preset(0), "fast");
}

TEST(PresetSession, ApplicationsMayChooseAndOtherBackendsHaveNone) {
  for (const char* preset : {"turbo", "fast", "strong"}) {
    Presets path(64, with_proofs({.preset = preset}));
    path.join(1, Delivery::unicast, kDelay, 0.2 * kMbps, false);
    path.run(2);
    EXPECT_EQ(path.seen(), std::set<std::string_view>{""});
    path.expect_the_same_bits(1);
  }
  Presets path(64, with_proofs(), "zstd");
  path.join(1, Delivery::shared, kDelay, 0.2 * kMbps, false);
  path.run(2);
  EXPECT_EQ(path.seen(), std::set<std::string_view>{""});
  path.expect_the_same_bits(1);
}

}  // namespace
}  // namespace gicodec
