// A streaming server with HEVC: packets for each client, since a picture refers to the ones before.
#include "support.h"
#include "volumes.h"

#include <gicodec/client.h>
#include <gicodec/hevc.h>
#include <gicodec/host.h>

#include <gtest/gtest.h>

#include <algorithm>
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
  return options;
}

TEST(HevcStreaming, ClientsHoldWhatTheServerThinks) {
  const HevcBackend backend;
  auto server = Server::create(server_options(backend));
  ASSERT_TRUE(server.ok());
  auto host = Host::create(*std::move(server), {.proofs = true});
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
    ASSERT_EQ(host->server().set_visible(*host->client(peers[i]), 0, visible), Status::ok);
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
    ASSERT_EQ(host->server().publish(0, 0, std::as_const(texture).view()), Status::ok);
    ASSERT_EQ(host->update(now, now), Status::ok);
    for (std::size_t i = 0; i < clients.size(); ++i) {
      for (const Message& message : host->take_messages(peers[i])) {
        if (update == 4 && i == 1) continue;
        ASSERT_EQ(clients[i].receive(message), Status::ok);
      }
      for (const Message& reply : clients[i].take_replies()) host->receive(peers[i], reply, now);
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

TEST(HevcStreaming, RefusesWhatPicturesCannotDo) {
  const HevcBackend backend;
  auto server = Server::create(server_options(backend));
  ASSERT_TRUE(server.ok());
  const VolumeDesc volume = probes_of({{"color", ddgi_irradiance(kGrid)}});
  const auto early = server->connect(Delivery::shared);
  ASSERT_TRUE(early.ok());
  EXPECT_EQ(server->add_volume(volume, {kGrid}).status(), Status::unsupported_backend);
  ASSERT_EQ(server->disconnect(*early), Status::ok);
  ASSERT_TRUE(server->add_volume(volume, {kGrid}).ok());
  EXPECT_EQ(server->connect(Delivery::shared).status(), Status::unsupported_backend);
  EXPECT_EQ(server->scroll(0, {1, 0, 0}), Status::unsupported_backend);

  HevcSettings settings;
  settings.lossy_qp = 20;
  const HevcBackend lossy(settings);
  auto other = Server::create(server_options(lossy));
  ASSERT_TRUE(other.ok());
  EXPECT_EQ(other->add_volume(volume, {kGrid}).status(), Status::unsupported_backend);
}

}  // namespace
}  // namespace gicodec
