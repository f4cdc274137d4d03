// Instruction sets of servers and clients: none runs a kernel of another set than the one that it
// was given.
#include "session/server/distributor.h"
#include "support.h"
#include "trap_kernels.h"
#include "volumes.h"

#include <gicodec/streaming.h>

#include <gtest/gtest.h>

#include <cstdlib>

namespace gicodec {
namespace {

using namespace test;

TEST(SessionIsa, TheBestIsUsed) {
  EXPECT_EQ(ServerOptions{}.settings.isa, best_isa());
  EXPECT_EQ(ClientOptions{}.isa, best_isa());
}

TEST(SessionIsa, ASetThatTheMachineLacksIsRefused) {
  constexpr auto kUnknown = static_cast<Isa>(200);
  ServerOptions server;
  server.settings.isa = kUnknown;
  EXPECT_EQ(Server::create(server).status(), Status::invalid_settings);
  ClientOptions client;
  client.isa = kUnknown;
  EXPECT_EQ(Client::create(client).status(), Status::invalid_settings);
}

#if defined(GICODEC_TRAPS)

/// What a decoder holds after these packets.
Bytes last_of(Isa isa, const TextureDesc& desc, const std::vector<Packet>& packets) {
  DecoderOptions options;
  options.isa = isa;
  auto decoder = *Decoder::create(desc, options);
  for (const auto& packet : packets) {
    if (decoder.decode(packet) != Status::ok) std::abort();
  }
  return contents(decoder);
}

/// A server and a client's decoder: publish, packets, texels.
void stream_with(Isa isa) {
  Random random(62);
  const auto desc = ddgi_irradiance({4, 2, 3});
  Texture texture(desc);
  texture.fill(Fill::noise, random);
  DistributorOptions options;
  options.settings.isa = isa;
  auto distributor = *Distributor::create(options);
  const auto volume = *distributor.add_volume(probes_of({{"color", desc}}), {desc.grid});
  const auto client = *distributor.connect();
  const std::vector<std::uint8_t> visible(block_count(desc), 1);
  if (distributor.set_visible(client, volume, visible) != Status::ok ||
      distributor.publish(volume, 0, std::as_const(texture).view()) != Status::ok ||
      distributor.update() != Status::ok || distributor.packets(client).empty()) {
    std::abort();
  }
  std::vector<Packet> packets;
  for (const auto& packet : distributor.packets(client)) packets.push_back(*packet.packet);
  if (last_of(isa, desc, packets) != texture.blocks()) std::abort();
}

class SessionIsaOf : public testing::TestWithParam<Isa> {};

TEST_P(SessionIsaOf, ServersUseItAndNoOther) {
  const auto with_traps_in_the_others = [] {
    for (const Isa other : supported_isas()) {
      if (other != GetParam()) trap_kernels(other);
    }
    stream_with(GetParam());
    std::_Exit(0);
  };
  EXPECT_EXIT(with_traps_in_the_others(), testing::ExitedWithCode(0), "");
}

INSTANTIATE_TEST_SUITE_P(All, SessionIsaOf, testing::ValuesIn(supported_isas()),
                         [](const auto& test) { return std::string(to_string(test.param)); });

#endif

}  // namespace
}  // namespace gicodec
