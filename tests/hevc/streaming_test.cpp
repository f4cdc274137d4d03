// A streaming server with HEVC: a stream of pictures for each client, or one for all.
#include "../messages.h"
#include "memory_sink.h"
#include "support.h"
#include "volumes.h"

#include <gicodec/client.h>
#include <gicodec/hevc.h>
#include <gicodec/player.h>
#include <gicodec/recorder.h>
#include <gicodec/server.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

namespace gicodec {
namespace {

using namespace test;

constexpr Grid kGrid{4, 2, 3};
constexpr std::uint32_t kBlocks = 24;

ServerOptions server_options(const Backend& backend) {
  ServerOptions options;
  options.backend = "hevc";
  options.backends = {&backend};
  options.settings.preset = "ultrafast";
  options.proofs = true;
  return options;
}

TEST(HevcStreaming, ClientsHoldWhatTheServerThinks) {
  const HevcBackend backend;
  auto server = Server::create(server_options(backend));
  ASSERT_TRUE(server.ok());
  Texture texture(ddgi_irradiance(kGrid));
  ASSERT_TRUE(server->add_volume("volume", probes_of({{"color", texture.desc()}}), {kGrid}).ok());

  ClientOptions options;
  options.backends = {&backend};
  std::vector<Client> clients;
  std::vector<ConnectionId> connections;
  double now = 0;
  const auto connect = [&](std::size_t i) {
    connections[i] = *server->connect(now);
    const auto hello = clients[i].hello();
    ASSERT_TRUE(hello.ok());
    server->receive(connections[i], *hello, now);
  };
  for (std::uint32_t i = 0; i < 2; ++i) {
    clients.push_back(*Client::create(options));
    connections.push_back(0);
    connect(i);
    BlockMask visible(kBlocks, 0);
    for (std::uint32_t block = i; block < kBlocks; block += i + 1) visible[block] = 1;
    ASSERT_EQ(server->set_visible(connections[i], 0, visible), Status::ok);
  }
  Random random(1);
  for (int update = 0; update < 8; ++update) {
    now += 0.1;
    if (update == 5) {  // The second client's link breaks with an update under way.
      server->disconnect(connections[1], now);
      connect(1);
    }
    for (std::uint32_t block = update % 2; block < kBlocks; block += 2) {
      texture.fill_block(block, Fill::small, random);
      texture.fill_band(block);
    }
    ASSERT_EQ(server->publish(0, 0, std::as_const(texture).view()), Status::ok);
    ASSERT_EQ(server->update(now, now), Status::ok);
    for (std::size_t i = 0; i < clients.size(); ++i) {
      for (const Message& message : joined(server->take_messages(connections[i]))) {
        if (update == 4 && i == 1) continue;
        ASSERT_EQ(clients[i].receive(message), Status::ok);
      }
      for (const Message& reply : clients[i].take_messages())
        server->receive(connections[i], reply, now);
    }
  }
  EXPECT_TRUE(std::ranges::equal(clients[0].frame().volumes[0].textures[0].texels,
                                 std::as_const(texture).view().bytes));
  for (const Client& client : clients) {
    EXPECT_TRUE(client.consistent());
    EXPECT_GE(client.statistics().proofs, 6U);
    EXPECT_EQ(client.statistics().failed_proofs, 0U);
  }
}

/// Records from an update on.
struct Recording final : ClientListener {
  void updated(const Client& client,
               std::span<const UpdateMessage::Part> packets) noexcept override {
    if (--wait >= 0) return;
    if (!recorder)
      recorder.emplace(*ClientRecorder::begin(sink, client, *ClientRecorder::describe(client)));
    EXPECT_EQ(recorder->add(client, packets), Status::ok);
  }
  int wait = 0;
  MemorySink sink;
  std::optional<ClientRecorder> recorder;
};

/// A picture refers to those before: nothing but a keyframe can begin a recording.
TEST(HevcStreaming, RecordingsBeginWithKeyframes) {
  const HevcBackend backend;
  for (const int wait : {0, 2}) {
    auto server = *Server::create(server_options(backend));
    Texture texture(ddgi_irradiance(kGrid));
    ASSERT_TRUE(server.add_volume("volume", probes_of({{"color", texture.desc()}}), {kGrid}).ok());
    Recording recording;
    recording.wait = wait;
    ClientOptions options;
    options.backends = {&backend};
    options.listener = &recording;
    auto client = *Client::create(options);
    const ConnectionId connection = *server.connect(0);
    server.receive(connection, *client.hello(), 0);
    ASSERT_EQ(server.set_visible(connection, 0, BlockMask(kBlocks, 1)), Status::ok);
    Random random(1);
    for (int update = 1; update < 6; ++update) {
      texture.fill(Fill::small, random);
      ASSERT_EQ(server.publish(0, 0, std::as_const(texture).view()), Status::ok);
      ASSERT_EQ(server.update(0.1 * update, 0), Status::ok);
      for (const Message& message : joined(server.take_messages(connection)))
        ASSERT_EQ(client.receive(message), Status::ok);
      for (const Message& reply : client.take_messages())
        server.receive(connection, reply, 0.1 * update);
    }
    EXPECT_EQ(recording.recorder->waiting(), wait == 0 ? 0U : 1U);
    ASSERT_EQ(recording.recorder->finish(), Status::ok);
    MemorySource source(recording.sink.bytes);
    auto player = *ContainerPlayer::open(source, {.backends = {&backend}});
    int frames = 0;
    while (player.next() == Status::ok) ++frames;
    EXPECT_TRUE(player.finished());
    EXPECT_EQ(frames, wait == 0 ? 5 : 0);
    const auto& held = client.frame().volumes[0].textures[0].texels;
    std::vector<std::byte> played(held.size());
    ASSERT_EQ(player.read(0, TextureView{played}), Status::ok);
    EXPECT_EQ(played == held, wait == 0);
  }
}

/// A client of a shared stream.
struct Watcher {
  explicit Watcher(const Backend& backend, const Budget& budget = {})
      : client(*Client::create(
            {.backends = {&backend}, .delivery = Delivery::shared, .budget = budget})) {}

  void connect(Server& server, double now) {
    connection = *server.connect(now);
    server.receive(connection, *client.hello(), now);
  }
  /// Applies what came, or loses it with the connection.
  void take(Server& server, double now, bool lost) {
    for (const Message& message : joined(server.take_messages(connection))) {
      if (!lost) {
        ASSERT_EQ(client.receive(message), Status::ok);
      }
    }
    for (const Message& reply : client.take_messages()) server.receive(connection, reply, now);
    if (!lost) return;
    server.disconnect(connection, now);
    connect(server, now);
  }
  [[nodiscard]] std::span<const std::byte> texels() const {
    return client.frame().volumes[0].textures[0].texels;
  }

  Client client;
  ConnectionId connection = 0;
};

/// A server of one texture that has this backend of its own.
Server server_of_pictures(const Backend& backend, const TextureDesc& desc) {
  auto server = *Server::create({.backends = {&backend}, .proofs = true});
  StreamedTexture streamed{.texture = "color", .backend = &backend};
  streamed.settings.preset = "ultrafast";
  EXPECT_TRUE(
      server.add_volume("volume", probes_of({{"color", desc}}), {kGrid}, std::span(&streamed, 1))
          .ok());
  return server;
}

/// All share one stream of pictures: a client that comes late, or lost an update, begins with a
/// keyframe, and holds bit by bit what the others hold.
void share(const HevcBackend& backend, bool lossy) {
  Texture texture(ddgi_irradiance(kGrid));
  auto server = server_of_pictures(backend, texture.desc());
  std::vector<Watcher> watchers;
  for (int i = 0; i < 3; ++i) watchers.emplace_back(backend);
  watchers[0].connect(server, 0);
  watchers[1].connect(server, 0);
  Random random(1);
  texture.fill(Fill::small, random);
  constexpr int kUpdates = 50, kLate = 5, kLoses = 20;
  std::vector<int> keyframes;
  for (int update = 0; update < kUpdates; ++update) {
    const double now = 0.1 * (update + 1);
    if (update == kLate) watchers[2].connect(server, now);
    for (std::uint32_t block = update % 2; block < kBlocks; block += 2) {
      texture.fill_block(block, Fill::small, random);
      texture.fill_band(block);
    }
    ASSERT_EQ(server.publish(0, 0, std::as_const(texture).view()), Status::ok);
    ASSERT_EQ(server.update(now, now), Status::ok);
    const auto packets = server.packets(watchers[0].connection);
    if (std::ranges::any_of(packets, &OutgoingPacket::keyframe)) keyframes.push_back(update);
    for (std::size_t i = 0; i < watchers.size(); ++i) {
      if (i == 2 && update < kLate) continue;
      watchers[i].take(server, now, i == 1 && update == kLoses);
    }
  }
  const auto published = std::as_const(texture).view().bytes;
  for (const Watcher& one : watchers) {
    EXPECT_TRUE(std::ranges::equal(one.texels(), watchers[0].texels()));
    EXPECT_EQ(std::ranges::equal(one.texels(), published), !lossy);
    EXPECT_TRUE(one.client.consistent());
    EXPECT_GE(one.client.statistics().proofs, 10U);
    EXPECT_EQ(one.client.statistics().failed_proofs, 0U);
    const float error = one.client.frame().volumes[0].textures[0].largest_error;
    EXPECT_EQ(error, lossy ? std::numeric_limits<float>::infinity() : 0);
  }
  // The first; one for the late client and one after the loss, 16 updates apart.
  ASSERT_EQ(keyframes.size(), 3U);
  EXPECT_GE(keyframes[1], keyframes[0] + 16);
  EXPECT_GE(keyframes[2], keyframes[1] + 16);
  EXPECT_EQ(server.scroll(0, {1, 0, 0}), Status::unsupported_backend);
}

TEST(HevcStreaming, ClientsShareAStream) { share(HevcBackend(), false); }

TEST(HevcStreaming, ClientsShareALossyStream) {
  HevcSettings settings;
  settings.packing = HevcPacking::luma;
  settings.lossy_qp = 20;
  share(HevcBackend(settings), true);
}

/// Keyframes come when a faster client asks; a slow one gets those after its turns.
TEST(HevcStreaming, SlowClientsGetKeyframes) {
  const HevcBackend backend;
  Texture texture(ddgi_irradiance(kGrid));
  auto server = server_of_pictures(backend, texture.desc());
  Random random(1);
  texture.fill(Fill::small, random);
  std::vector<Watcher> watchers;
  std::vector<int> last, longest;
  constexpr int kUpdates = 240, kEvery = 16, kKeyframes = 16;
  for (int update = 0; update < kUpdates; ++update) {
    const double now = 0.1 * (update + 1);
    if (update % 5 == 0 && watchers.size() < 6) {
      // The first takes part in every second update, and waits for each keyframe.
      const std::uint32_t blocks = watchers.empty() ? kBlocks / 4 : 1;
      watchers.emplace_back(backend, Budget{.blocks = blocks});
      watchers.back().connect(server, now);
      last.push_back(update);
      longest.push_back(0);
    }
    for (std::uint32_t block = update % 2; block < kBlocks; block += 2) {
      texture.fill_block(block, Fill::small, random);
      texture.fill_band(block);
    }
    ASSERT_EQ(server.publish(0, 0, std::as_const(texture).view()), Status::ok);
    ASSERT_EQ(server.update(now, now), Status::ok);
    for (std::size_t i = 0; i < watchers.size(); ++i) {
      if (!server.packets(watchers[i].connection).empty()) last[i] = update;
      longest[i] = std::max(longest[i], update - last[i]);
      watchers[i].take(server, now, false);
    }
  }
  for (std::size_t i = 0; i < watchers.size(); ++i) {
    EXPECT_LE(longest[i], kEvery + kKeyframes) << i;
    EXPECT_EQ(watchers[i].client.statistics().failed_proofs, 0U);
  }
}

/// Unicast clients would each hold something else.
TEST(HevcStreaming, LossyTexturesAreShared) {
  HevcSettings settings;
  settings.lossy_qp = 20;
  const HevcBackend lossy(settings);
  auto server = *Server::create(server_options(lossy));
  const VolumeDesc volume = probes_of({{"color", ddgi_irradiance(kGrid)}});
  auto client = *Client::create();
  const ConnectionId early = *server.connect(0);
  server.receive(early, *client.hello(), 0);
  EXPECT_EQ(server.add_volume("volume", volume, {kGrid}).status(), Status::unsupported_backend);
  EXPECT_EQ(server.volumes(), 0U);
  server.drop(early, Reason::dismissed);
  static_cast<void>(server.take_events());
  const StreamedTexture bounded{.texture = "color", .max_error = 1};
  EXPECT_EQ(server.add_volume("volume", volume, {kGrid}, std::span(&bounded, 1)).status(),
            Status::invalid_bound);
  ASSERT_TRUE(server.add_volume("volume", volume, {kGrid}).ok());
  const auto refusal = [&]() -> std::optional<Reason> {
    auto late = *Client::create();
    const ConnectionId connection = *server.connect(0);
    server.receive(connection, *late.hello(), 0);
    for (const ServerEvent& event : server.take_events()) {
      if (event.type == ServerEvent::Type::dropped) return event.reason;
    }
    return std::nullopt;
  };
  EXPECT_EQ(refusal(), Reason::unicast_full);
  ASSERT_EQ(server.remove_volume(0), Status::ok);
  EXPECT_EQ(refusal(), std::nullopt);
}

}  // namespace
}  // namespace gicodec
