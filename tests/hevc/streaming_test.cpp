// A streaming server with HEVC: packets for each client, since a picture refers to the ones before.
#include "../messages.h"
#include "memory_sink.h"
#include "support.h"
#include "volumes.h"

#include <gicodec/client.h>
#include <gicodec/hevc.h>
#include <gicodec/host.h>
#include <gicodec/player.h>
#include <gicodec/recorder.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <vector>

namespace gicodec {
namespace {

using namespace test;

constexpr Grid kGrid{4, 2, 3};
constexpr std::uint32_t kBlocks = 24;

HostOptions host_options(const Backend& backend) {
  HostOptions options;
  options.backend = "hevc";
  options.backends = {&backend};
  options.settings.preset = "ultrafast";
  options.proofs = true;
  return options;
}

/// Why a peer that asks for shared packets is turned away, if it is.
std::optional<Reason> refusal_of_shared(Host& host) {
  auto client = *Client::create({.delivery = Delivery::shared});
  const PeerId peer = *host.connect(0);
  host.receive(peer, *client.hello(), 0);
  for (const HostEvent& event : host.take_events()) {
    if (event.kind == HostEvent::Kind::dropped) return event.reason;
  }
  host.drop(peer, Reason::dismissed);
  static_cast<void>(host.take_events());
  return std::nullopt;
}

TEST(HevcStreaming, ClientsHoldWhatTheServerThinks) {
  const HevcBackend backend;
  auto host = Host::create(host_options(backend));
  ASSERT_TRUE(host.ok());
  Texture texture(ddgi_irradiance(kGrid));
  ASSERT_TRUE(host->add_volume("volume", probes_of({{"color", texture.desc()}}), {kGrid}).ok());

  ClientOptions options;
  options.backends = {&backend};
  std::vector<Client> clients;
  std::vector<PeerId> peers;
  double now = 0;
  const auto connect = [&](std::size_t i) {
    peers[i] = *host->connect(now);
    const auto hello = clients[i].hello();
    ASSERT_TRUE(hello.ok());
    host->receive(peers[i], *hello, now);
  };
  for (std::uint32_t i = 0; i < 2; ++i) {
    clients.push_back(*Client::create(options));
    peers.push_back(0);
    connect(i);
    BlockMask visible(kBlocks, 0);
    for (std::uint32_t block = i; block < kBlocks; block += i + 1) visible[block] = 1;
    ASSERT_EQ(host->set_visible(peers[i], 0, visible), Status::ok);
  }
  Random random(1);
  for (int update = 0; update < 8; ++update) {
    now += 0.1;
    if (update == 5) {  // The second client's link breaks with an update under way.
      host->disconnect(peers[1], now);
      connect(1);
    }
    for (std::uint32_t block = update % 2; block < kBlocks; block += 2) {
      texture.fill_block(block, Fill::small, random);
      texture.fill_band(block);
    }
    ASSERT_EQ(host->publish(0, 0, std::as_const(texture).view()), Status::ok);
    ASSERT_EQ(host->update(now, now), Status::ok);
    for (std::size_t i = 0; i < clients.size(); ++i) {
      for (const Message& message : joined(host->take_messages(peers[i]))) {
        if (update == 4 && i == 1) continue;
        ASSERT_EQ(clients[i].receive(message), Status::ok);
      }
      for (const Message& reply : clients[i].take_messages()) host->receive(peers[i], reply, now);
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
    auto host = *Host::create(host_options(backend));
    Texture texture(ddgi_irradiance(kGrid));
    ASSERT_TRUE(host.add_volume("volume", probes_of({{"color", texture.desc()}}), {kGrid}).ok());
    Recording recording;
    recording.wait = wait;
    ClientOptions options;
    options.backends = {&backend};
    options.listener = &recording;
    auto client = *Client::create(options);
    const PeerId peer = *host.connect(0);
    host.receive(peer, *client.hello(), 0);
    ASSERT_EQ(host.set_visible(peer, 0, BlockMask(kBlocks, 1)), Status::ok);
    Random random(1);
    for (int update = 1; update < 6; ++update) {
      texture.fill(Fill::small, random);
      ASSERT_EQ(host.publish(0, 0, std::as_const(texture).view()), Status::ok);
      ASSERT_EQ(host.update(0.1 * update, 0), Status::ok);
      for (const Message& message : joined(host.take_messages(peer)))
        ASSERT_EQ(client.receive(message), Status::ok);
      for (const Message& reply : client.take_messages()) host.receive(peer, reply, 0.1 * update);
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

TEST(HevcStreaming, RefusesWhatPicturesCannotDo) {
  const HevcBackend backend;
  auto host = Host::create(host_options(backend));
  ASSERT_TRUE(host.ok());
  const VolumeDesc volume = probes_of({{"color", ddgi_irradiance(kGrid)}});
  auto early = *Client::create({.delivery = Delivery::shared});
  const PeerId peer = *host->connect(0);
  host->receive(peer, *early.hello(), 0);
  EXPECT_EQ(host->add_volume("volume", volume, {kGrid}).status(), Status::unsupported_backend);
  EXPECT_EQ(host->volumes(), 0U);
  host->drop(peer, Reason::dismissed);
  static_cast<void>(host->take_events());
  ASSERT_TRUE(host->add_volume("volume", volume, {kGrid}).ok());
  EXPECT_EQ(refusal_of_shared(*host), Reason::full);
  EXPECT_EQ(host->scroll(0, {1, 0, 0}), Status::unsupported_backend);
  // When it is gone there is nothing that remembers.
  ASSERT_EQ(host->remove_volume(0), Status::ok);
  EXPECT_EQ(refusal_of_shared(*host), std::nullopt);

  HevcSettings settings;
  settings.lossy_qp = 20;
  const HevcBackend lossy(settings);
  auto other = Host::create(host_options(lossy));
  ASSERT_TRUE(other.ok());
  EXPECT_EQ(other->add_volume("volume", volume, {kGrid}).status(), Status::unsupported_backend);
}

}  // namespace
}  // namespace gicodec
