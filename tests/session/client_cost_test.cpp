// What a server may cost a client: never more memory, and in a message never more work, than its
// limits.
#include "../allocation_counter.h"
#include "../messages.h"
#include "support.h"
#include "volumes.h"

#include "session/client/client_limits.h"

#include <gicodec/client.h>
#include <gicodec/photons.h>
#include <gicodec/server.h>
#include <gicodec/volume_encoder.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <thread>

namespace gicodec {
namespace {

using namespace test;

constexpr Grid kGrid{16, 8, 16};

class ClientCost : public testing::Test {
 protected:
  void make(std::string_view backend) {
    server_.emplace(*Server::create({.backend = backend}));
    const auto volume = probes_of({{"visibility", texture_.desc()}});
    ASSERT_TRUE(server_->add_volume("volume", volume, {kGrid}).ok());
  }

  /// A new session's Welcome and updates, the last ones of everything, some guard bands stale.
  std::vector<Message> messages(const Message& hello, Delivery delivery) {
    const ConnectionId connection = *server_->connect(0);
    server_->receive(connection, hello, 0);
    // All is acknowledged at once, so that there is more in every update.
    const std::uint32_t sync = std::get<Hello>(*read_message(hello)).sync;
    std::vector<Message> made = joined(server_->take_messages(connection));
    constexpr std::uint32_t kUpdates = 10;
    for (std::uint32_t update = 1; update <= kUpdates; ++update) {
      texture_.fill(Fill::noise, random_);
      texture_.set_block(9, noise(random_, texture_.block(9).size()));
      EXPECT_EQ(server_->publish(0, 0, std::as_const(texture_).view()), Status::ok);
      EXPECT_EQ(server_->update(0, 0), Status::ok);
      for (Message& message : joined(server_->take_messages(connection)))
        made.push_back(std::move(message));
      Message done;
      EXPECT_EQ(write_message(Acknowledge{sync, update}, done), Status::ok);
      server_->receive(connection, done, 0);
    }
    EXPECT_EQ(made.size(), 1 + kUpdates) << static_cast<int>(delivery);
    EXPECT_EQ(server_->statistics(connection)->delivery, delivery);
    const auto last = *read_message(made.back());
    std::uint64_t blocks = 0;
    for (const auto& part : std::get<UpdateMessage>(last).parts) {
      const auto info = *peek(part.packet);
      blocks += info.all_blocks ? block_count(texture_.desc()) : info.blocks;
    }
    EXPECT_GE(blocks, block_count(texture_.desc()) - 1);
    return made;
  }

  static ClientOptions options_of(Delivery delivery) {
    ClientOptions options;
    options.delivery = delivery;
    return options;
  }

  Random random_{4};
  Texture texture_{probe_texture(Format::R16G16_SFLOAT, kGrid, 8)};
  std::optional<Server> server_;
};

TEST_F(ClientCost, MemoryStaysWithinTheLimit) {
  for (const char* backend : {"native", "zstd"}) {
    for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
      for (const bool threaded : {false, true}) {
        make(backend);
        ClientOptions options = options_of(delivery);
        const auto said = messages(*Client::create(options)->hello(), delivery);
        const auto welcome = *read_message(said[0]);
        const std::uint64_t limit =
            client_memory(*volumes_of(std::get<Welcome>(welcome).volumes, options, 1), delivery,
                          threaded ? 4 : 1, options.threads.count);
        std::size_t queue = 0;
        for (const Message& message : said) queue += message.capacity();
        options.limits.max_total_bytes = limit;
        const std::size_t peak = heap_peak_of([&] {
          auto client = *Client::create(options);
          if (!threaded) {
            static_cast<void>(client.hello());
            for (const Message& message : said) ASSERT_EQ(client.receive(message), Status::ok);
            return;
          }
          auto thread = *ClientThread::start(std::move(client));
          static_cast<void>(thread.hello());
          for (const Message& message : said) ASSERT_EQ(thread.push(message), Status::ok);
          while (!thread.idle()) std::this_thread::yield();
          EXPECT_EQ(thread.status(), Status::ok);
          EXPECT_EQ(thread.latest().serial, said.size() - 1);
        });
        EXPECT_LE(peak, limit + limit / 5 + (threaded ? queue : 0))
            << backend << static_cast<int>(delivery) << threaded;
        options.limits.max_total_bytes = limit - 1;
        auto strict = *Client::create(options);
        static_cast<void>(strict.hello());
        Status status = Status::ok;
        if (threaded) continue;
        const auto refused = heap_peak_of([&] { status = strict.receive(said[0]); });
        EXPECT_EQ(status, Status::limit_exceeded);
        EXPECT_LE(refused, 4096U);
      }
    }
  }
}

/// What a client refuses by is what it is said to take.
TEST_F(ClientCost, TheLimitIsWhatItSays) {
  make("native");
  for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
    ClientOptions options = options_of(delivery);
    const ConnectionId connection = *server_->connect(0);
    server_->receive(connection, *Client::create(options)->hello(), 0);
    const auto said = *read_message(joined(server_->take_messages(connection)).at(0));
    const auto& volumes = std::get<Welcome>(said).volumes;
    const std::uint64_t all = client_memory(*volumes_of(volumes, options, 2), delivery, 2, 1);
    EXPECT_GT(all, 2 * texture_bytes(texture_.desc()));
    options.threads.count = 1;
    options.limits.max_total_bytes = all;
    EXPECT_TRUE(volumes_of(volumes, options, 2).ok());
    options.limits.max_total_bytes = all - 1;
    EXPECT_EQ(volumes_of(volumes, options, 2).status(), Status::limit_exceeded);
  }
}

/// Room to decode in is that of the largest region, also where the last is smaller.
TEST(ClientMemory, GrowsWithTheGrid) {
  std::uint64_t before = 0;
  for (const Grid grid : {Grid{4, 4, 4}, Grid{5, 4, 4}, Grid{8, 4, 4}}) {
    const TextureDesc desc = probe_texture(Format::R16G16_SFLOAT, grid, 8);
    ClientVolume volume{0, 0, "v", probes_of({{"t", desc}}), {grid}, {4, 4, 4}, {}};
    volume.textures.push_back({"t", desc, {}, {}, 0});
    const std::uint64_t all = client_memory({volume}, Delivery::shared, 1, 1);
    EXPECT_GT(all, before) << grid.x;
    before = all;
  }
}

ClientFrame frame_of(const Welcome& welcome) {
  ClientFrame frame;
  frame.volumes = *volumes_of(welcome.volumes, {}, 1);
  return frame;
}

TEST_F(ClientCost, WhatComesTwiceCountsTwice) {
  make("native");
  const auto said = messages(*Client::create({})->hello(), Delivery::unicast);
  const auto client_after = [&](const AnyMessage& changed, const ClientOptions& options) {
    auto client = *Client::create(options);
    static_cast<void>(client.hello());
    EXPECT_EQ(client.receive(said[0]), Status::ok);
    Message bytes;
    EXPECT_EQ(write_message(changed, bytes), Status::ok);
    return client.receive(bytes);
  };
  const auto read = *read_message(said[1]);
  const auto update = std::get<UpdateMessage>(read);
  EXPECT_EQ(client_after(update, {}), Status::ok);
  auto twice = update;
  twice.parts.push_back(twice.parts[0]);
  const auto work = [frame = frame_of(std::get<Welcome>(*read_message(said[0])))](
                        const UpdateMessage& one) { return update_work(one, frame); };
  UpdateMessage single = update;
  single.parts.resize(1);
  EXPECT_EQ(work(twice), work(update) + work(single));
  auto proven = update;
  proven.proofs = {{update.parts[0].stream, 1}, {update.parts[0].stream, 1}};
  EXPECT_EQ(client_after(proven, {}), Status::corrupt);
  // Of keyframes all blocks count twice: as cleared and as written.
  ClientOptions options;
  options.limits.max_work_bytes = work(update);
  EXPECT_EQ(client_after(update, options), Status::ok);
  EXPECT_EQ(client_after(twice, options), Status::limit_exceeded);
  options.limits.max_work_bytes -= 1;
  EXPECT_EQ(client_after(update, options), Status::limit_exceeded);
}

/// A presence is compared with all records that the client holds of its blocks.
TEST(PresenceCost, CountsRecordsThatDoNotComeWithIt) {
  const VolumeDesc volume = *photon_volume(8, 64);
  const auto textures = textures_of(volume);
  std::vector<std::vector<std::byte>> contents;
  std::uint64_t records = 0;
  ClientFrame frame;
  frame.volumes.push_back(
      {0, 0, "photons", volume, {volume.groups[0].textures[0].desc.grid}, {}, {}});
  for (const NamedTexture* texture : textures) {
    contents.emplace_back(texture_bytes(texture->desc));
    if (texture->desc.presence != Presence::all) records += contents.back().size();
    frame.volumes[0].textures.push_back({texture->name, texture->desc, {}, {}, 0});
  }
  ASSERT_GT(records, 0U);
  const std::vector<ConstTextureView> views(contents.begin(), contents.end());
  const auto packets = *VolumeEncoder::create(volume)->encode(views);
  UpdateMessage whole;
  std::uint64_t sum = 0;
  for (std::uint8_t t = 0; t < packets.size(); ++t) {
    const UpdateMessage::Part part{{0, t}, 0, packets[t]};
    const UpdateMessage one{.parts = {part}};
    whole.parts.push_back(part);
    sum += update_work(one, frame);
  }
  EXPECT_EQ(sum, update_work(whole, frame) + records);
}

TEST_F(ClientCost, WorkCanBeCancelled) {
  make("native");
  std::atomic<bool> cancel{false};
  ClientOptions options;
  options.cancel = &cancel;
  auto client = *Client::create(options);
  const auto said = messages(*client.hello(), Delivery::unicast);
  ASSERT_EQ(client.receive(said[0]), Status::ok);
  cancel = true;
  EXPECT_EQ(client.receive(said[1]), Status::cancelled);
  EXPECT_FALSE(client.consistent());
  // Over the next connection it goes on.
  cancel = false;
  const auto again = messages(*client.hello(), Delivery::unicast);
  for (const Message& message : again) ASSERT_EQ(client.receive(message), Status::ok);
  EXPECT_TRUE(client.resumed());
  EXPECT_TRUE(std::ranges::equal(client.frame().volumes[0].textures[0].texels,
                                 std::as_const(texture_).view().bytes));
}

}  // namespace
}  // namespace gicodec
