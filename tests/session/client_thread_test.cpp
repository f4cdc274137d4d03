// Frames go from the decoding thread to the render loop whole and in order.
#include "../messages.h"
#include "support.h"
#include "volumes.h"

#include <gicodec/client.h>
#include <gicodec/server.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <optional>
#include <thread>

namespace gicodec {
namespace {

using namespace test;

constexpr Grid kThreadGrid{3, 2, 3};

/// Every texel of both textures says the number of the update.
void publish(Server& server, std::uint16_t volume, std::uint32_t number) {
  for (std::uint8_t t = 0; t < 2; ++t) {
    const TextureDesc desc = t == 0 ? ddgi_irradiance(kThreadGrid) : ddgi_visibility(kThreadGrid);
    std::vector<std::uint32_t> texels(static_cast<std::size_t>(texture_bytes(desc) / 4), number);
    ASSERT_EQ(server.publish(volume, t, {std::as_bytes(std::span(texels))}), Status::ok);
  }
}

std::optional<Server> make_server(std::uint16_t& volume) {
  ServerOptions options;
  options.limits.messages_per_second = 1e6;
  options.limits.max_in_flight = 1000;
  options.timeouts.stall = 1e6;  // The clock counts updates here.
  auto server = Server::create(options);
  EXPECT_TRUE(server.ok());
  const auto probes =
      probes_of({{"color", ddgi_irradiance(kThreadGrid)}, {"vis", ddgi_visibility(kThreadGrid)}});
  const auto id = server->add_volume("volume", probes, {kThreadGrid});
  EXPECT_TRUE(id.ok());
  volume = *id;
  return *std::move(server);
}

/// All texels of a frame, or nothing if they are not the same.
std::optional<std::uint32_t> number_of(const ClientFrame& frame) {
  std::uint32_t number = 0;
  bool first = true;
  for (const ClientVolume& volume : frame.volumes) {
    for (const ClientTexture& texture : volume.textures) {
      for (std::size_t i = 0; i < texture.texels.size(); i += 4) {
        std::uint32_t texel = 0;
        std::memcpy(&texel, texture.texels.data() + i, 4);
        if (first) number = texel;
        first = false;
        if (texel != number) return std::nullopt;
      }
    }
  }
  return number;
}

TEST(ClientThread, HandsOverWholeFramesWhileTheNextAreDecoded) {
  constexpr std::uint32_t kUpdates = 300;
  std::uint16_t volume = 0;
  auto server = make_server(volume);
  auto client = Client::create();
  ASSERT_TRUE(client.ok());
  auto thread = ClientThread::start(*std::move(client));
  ASSERT_TRUE(thread.ok());

  std::atomic<bool> done = false;
  std::thread renderer([&] {
    std::uint64_t serial = 0;
    std::uint32_t seen = 0, last = 0;
    while (true) {
      const bool end = done;  // Before the look, so that the last frame is seen.
      const ClientFrame& frame = thread->latest();
      EXPECT_GE(frame.serial, serial);
      if (frame.serial > serial) {
        const auto number = number_of(frame);
        ASSERT_TRUE(number.has_value());
        EXPECT_GE(*number, last);
        EXPECT_EQ(*number, frame.update);
        last = *number;
        serial = frame.serial;
        ++seen;
      }
      if (end) break;
    }
    EXPECT_GT(seen, 0U);
    EXPECT_EQ(last, kUpdates);
  });

  const auto connection = server->connect(0);
  ASSERT_TRUE(connection.ok());
  const auto hello = thread->hello();
  ASSERT_TRUE(hello.ok());
  server->receive(*connection, *hello, 0);
  Message all;
  ASSERT_EQ(write_message(Subscribe{1, volume, 0,
                                    BlockMask(kThreadGrid.x * kThreadGrid.y * kThreadGrid.z, 1)},
                          all),
            Status::ok);
  server->receive(*connection, all, 0);
  for (std::uint32_t update = 1; update <= kUpdates; ++update) {
    publish(*server, volume, update);
    ASSERT_EQ(server->update(0, update), Status::ok);
    for (Message& message : joined(server->take_messages(*connection))) {
      ASSERT_EQ(thread->push(std::move(message)), Status::ok);
    }
    // Who is many updates late is skipped, and would not hold the last one.
    do {
      std::this_thread::yield();
      for (const Message& reply : thread->take_messages())
        server->receive(*connection, reply, update);
    } while (server->statistics(*connection)->in_flight > 2);
  }
  while (!thread->idle()) std::this_thread::yield();
  done = true;
  renderer.join();
  EXPECT_EQ(thread->status(), Status::ok);
  EXPECT_EQ(thread->statistics().gaps, 0U);
}

TEST(ClientThread, SaysItsWishesToEverySession) {
  std::uint16_t volume = 0;
  auto server = make_server(volume);
  BlockMask some(kThreadGrid.x * kThreadGrid.y * kThreadGrid.z);
  some[1] = 1;
  auto client = *Client::create();
  ASSERT_EQ(client.set_viewpoint({{4, 5, 6}}), Status::ok);
  auto thread = ClientThread::start(std::move(client));
  ASSERT_TRUE(thread.ok());
  ASSERT_EQ(thread->subscribe(volume, some), Status::ok);
  for (std::uint32_t session = 1; session <= 2; ++session) {
    const ConnectionId connection = *server->connect(0);
    const auto exchange = [&] {
      for (Message& message : joined(server->take_messages(connection))) {
        ASSERT_EQ(thread->push(std::move(message)), Status::ok);
      }
      while (!thread->idle()) std::this_thread::yield();
      for (const Message& message : thread->take_messages())
        server->receive(connection, message, 0);
    };
    server->receive(connection, *thread->hello(), 0);
    exchange();
    ASSERT_TRUE(server->viewpoint(connection).has_value());
    EXPECT_EQ(server->viewpoint(connection)->eye, (Position{4, 5, 6}));
    EXPECT_EQ(thread->subscribe(volume, some, 1), Status::unknown_group);
    EXPECT_EQ(thread->subscribe(volume, BlockMask(1)), Status::mask_mismatch);
    publish(*server, volume, session);
    ASSERT_EQ(server->update(0, session), Status::ok);
    for (const OutgoingPacket& packet : server->packets(connection)) EXPECT_EQ(packet.blocks, 1U);
    exchange();
    ASSERT_EQ(thread->disconnect(), Status::ok);
    EXPECT_EQ(thread->status(), Status::end);
    for (const Message& message : thread->take_messages()) server->receive(connection, message, 0);
    EXPECT_FALSE(server->client(connection).has_value());
  }
}

TEST(ClientThread, RefusesMoreThanItMayKeep) {
  auto client = Client::create();
  ASSERT_TRUE(client.ok());
  auto thread = ClientThread::start(*std::move(client), {.max_waiting_bytes = 100});
  ASSERT_TRUE(thread.ok());
  EXPECT_EQ(thread->push(Message(101)), Status::limit_exceeded);
}

TEST(ClientThread, ReportsGarbageUntilTheNextHello) {
  auto client = Client::create();
  ASSERT_TRUE(client.ok());
  auto thread = ClientThread::start(*std::move(client));
  ASSERT_TRUE(thread.ok());
  ASSERT_EQ(thread->push(Message(10, std::byte{0xFF})), Status::ok);
  while (thread->status() == Status::ok) std::this_thread::yield();
  EXPECT_EQ(thread->status(), Status::corrupt);
  EXPECT_EQ(thread->push(Message(10)), Status::corrupt);
  ASSERT_TRUE(thread->hello().ok());
  EXPECT_EQ(thread->status(), Status::ok);
}

}  // namespace
}  // namespace gicodec
