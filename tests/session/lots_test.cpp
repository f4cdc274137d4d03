// Sets of textures: those that travel together, presence, names, ranks, and kinds that clients know
// or do not.
#include "session/any_volume.h"
#include "volumes.h"

#include <gicodec/client.h>
#include <gicodec/host.h>
#include <gicodec/irradiance_vectors.h>

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <optional>
#include <set>

namespace gicodec {
namespace {

using namespace test;

/// A texture of blocks of so many records of a format, in a row.
NamedTexture texture(const char* name, Format format, std::uint8_t records, Grid grid,
                     Space space = Space::grid) {
  TextureDesc desc;
  desc.record = format;
  desc.block = {records, 1, 1};
  desc.grid = grid;
  desc.space = space;
  desc.prediction = {};
  desc.layout = Tiling::blocks;
  return {name, desc};
}

/// What was sent for a client in the last update: blocks by texture.
std::map<std::uint8_t, std::vector<std::uint32_t>> sent_by(Server& server, ClientId client,
                                                           std::map<StreamId, Decoder>& decoders,
                                                           const VolumeDesc& volume) {
  std::map<std::uint8_t, std::vector<std::uint32_t>> sent;
  std::vector<TextureDesc> descs;
  for (const BlockSet& set : volume.sets) {
    for (const NamedTexture& one : set.textures) descs.push_back(one.desc);
  }
  for (const OutgoingPacket& packet : server.packets(client)) {
    TextureDesc desc = descs[packet.stream.texture];
    if (packet.stream.region != StreamId::kWholeVolume) {
      desc = region_texture(desc, server.options().region, packet.stream.region);
    }
    const auto it = decoders.try_emplace(packet.stream, *Decoder::create(desc)).first;
    EXPECT_EQ(it->second.decode(*packet.packet), Status::ok);
    auto& blocks = sent[packet.stream.texture];
    blocks.insert(blocks.end(), it->second.updated().begin(), it->second.updated().end());
  }
  return sent;
}

Server make_server(const char* backend = "raw") {
  ServerOptions options;
  options.backend = backend;
  return *Server::create(options);
}

class TogetherOver : public testing::TestWithParam<Delivery> {};

TEST_P(TogetherOver, ABlockComesInAllTexturesOrInNone) {
  constexpr Grid kGrid{4, 3, 2};
  constexpr std::uint32_t kBlocks = 24, kBudget = 6;
  const VolumeDesc volume = *irradiance_vector_volume(kGrid);
  Server server = make_server("zstd");
  ASSERT_TRUE(server.add_volume(volume, {kGrid}).ok());
  const ClientId client = *server.connect(GetParam(), {kBudget, 0});
  ASSERT_EQ(server.set_visible(client, 0, BlockMask(kBlocks, 1)), Status::ok);
  Random random(4);
  Texture direction(volume.sets[0].textures[0].desc), color(volume.sets[0].textures[1].desc);
  direction.fill(Fill::noise, random);
  color.fill(Fill::noise, random);
  ASSERT_EQ(server.publish(0, 0, std::as_const(direction).view()), Status::ok);
  ASSERT_EQ(server.update(), Status::ok);
  EXPECT_TRUE(server.packets(client).empty()) << "one of them was not published yet";
  ASSERT_EQ(server.publish(0, 1, std::as_const(color).view()), Status::ok);
  std::map<StreamId, Decoder> decoders;
  std::uint32_t updates_with_some = 0;
  for (int update = 0; update < 40; ++update) {
    if (update % 2 == 0) {  // Only one of them changes.
      color.fill_block(static_cast<std::uint32_t>(update) % kBlocks, Fill::noise, random);
      ASSERT_EQ(server.publish(0, 1, std::as_const(color).view()), Status::ok);
    }
    ASSERT_EQ(server.update(), Status::ok);
    auto sent = sent_by(server, client, decoders, volume);
    EXPECT_EQ(sent[0], sent[1]);
    if (GetParam() == Delivery::own) {
      EXPECT_LE(sent[0].size() + sent[1].size(), kBudget);
    }
    updates_with_some += sent[0].empty() ? 0 : 1;
  }
  EXPECT_GT(updates_with_some, 10U);
  for (auto& [stream, decoder] : decoders) {
    EXPECT_EQ(*server.state_hash(client, stream), decoder.state_hash());
  }
}

INSTANTIATE_TEST_SUITE_P(Deliveries, TogetherOver,
                         testing::Values(Delivery::own, Delivery::shared));

TEST(Lots, NativeRefusesShapesThatItHasNoModelsFor) {
  Server server = make_server("native");
  EXPECT_EQ(server.add_volume(*irradiance_vector_volume({2, 2, 2}), {{2, 2, 2}}).status(),
            Status::unsupported_shape);
}

TEST(Lots, WhatTravelsTogetherOrNamesHasOneInterval) {
  const VolumeDesc vectors = *irradiance_vector_volume({2, 2, 2});
  const StreamedTexture uneven[] = {{1, 0}, {2, 0}}, even[] = {{2, 0}, {2, 0}};
  Server server = make_server();
  EXPECT_EQ(server.add_volume(vectors, {{2, 2, 2}}, uneven).status(), Status::invalid_argument);
  EXPECT_TRUE(server.add_volume(vectors, {{2, 2, 2}}, even).ok());
}

/// A block that is black is received all the same, once.
TEST(Lots, BlackBlocksAreSentOnce) {
  constexpr Grid kGrid{3, 2, 1};
  const VolumeDesc volume = probes_of({{"color", ddgi_irradiance(kGrid)}});
  for (const Delivery delivery : {Delivery::own, Delivery::shared}) {
    Server server = make_server();
    ASSERT_TRUE(server.add_volume(volume, {kGrid}).ok());
    const ClientId client = *server.connect(delivery);
    ASSERT_EQ(server.set_visible(client, 0, BlockMask(6, 1)), Status::ok);
    const Texture black(ddgi_irradiance(kGrid));
    ASSERT_EQ(server.publish(0, 0, black.view()), Status::ok);
    ASSERT_EQ(server.update(), Status::ok);
    std::map<StreamId, Decoder> decoders;
    EXPECT_EQ(sent_by(server, client, decoders, volume)[0].size(), 6U);
    for (const std::uint8_t received : decoders.begin()->second.received()) EXPECT_EQ(received, 1);
    ASSERT_EQ(server.publish(0, 0, black.view()), Status::ok);
    ASSERT_EQ(server.update(), Status::ok);
    EXPECT_TRUE(server.packets(client).empty());
    EXPECT_EQ(server.state(client)->owed, 0U);
  }
}

// A kind of an application: bricks of up to four lights, counted, in a pool; and cells of a grid,
// each of which names a brick. The brightest bricks come first.

constexpr std::uint8_t kKindBricks = 200;
constexpr std::uint32_t kNoBrick = UINT32_MAX;

std::size_t brick_of(std::span<const std::byte> cell, std::span<std::uint32_t> out) {
  std::uint32_t brick = 0;
  std::memcpy(&brick, cell.data(), sizeof brick);
  if (brick == kNoBrick) return 0;
  if (!out.empty()) out[0] = brick;
  return 1;
}

float lights_of(std::span<const std::byte> count) {
  return std::to_integer<std::uint8_t>(count[0]);
}

VolumeDesc bricks(std::uint32_t pool, Grid cells, Presence presence = Presence::count) {
  VolumeDesc volume{kKindBricks, {{}, {}}};
  NamedTexture lights =
      texture("lights", Format::E5B9G9R9_UFLOAT_PACK32, 4, {pool, 1, 1}, Space::pool);
  lights.desc.presence = presence;
  const bool count = presence == Presence::count;
  BlockSet& set = volume.sets[0];
  set.textures = {texture("exists", Format::R8_UINT, count ? 2 : 1, {pool, 1, 1}, Space::pool),
                  lights};
  set.together = true;
  set.presence = 0;
  set.rank = lights_of;
  volume.sets[1].textures = {texture("cells", Format::R32_UINT, 1, cells)};
  volume.sets[1].names = 0;
  volume.sets[1].named = brick_of;
  return volume;
}

Status write_bricks(const VolumeDesc& volume, std::vector<std::byte>& out) {
  const TextureDesc& pool = volume.sets[0].textures[0].desc;
  const TextureDesc& cells = volume.sets[1].textures[0].desc;
  for (const std::uint32_t side : {pool.grid.x, cells.grid.x, cells.grid.y, cells.grid.z}) {
    out.push_back(static_cast<std::byte>(side));
  }
  return Status::ok;
}

Result<VolumeDesc> read_bricks(std::span<const std::byte> in) {
  if (in.size() != 4) return Status::corrupt;
  const auto side = [&](std::size_t i) { return std::to_integer<std::uint32_t>(in[i]); };
  const VolumeDesc volume = bricks(side(0), {side(1), side(2), side(3)});
  if (validate(volume) != Status::ok) return Status::corrupt;
  return volume;
}

constexpr Kind kBricks{kKindBricks, "bricks", write_bricks, read_bricks, nullptr};

/// Bricks and cells to be published.
struct World {
  explicit World(std::uint32_t pool, Grid grid, Presence presence = Presence::count)
      : volume(bricks(pool, grid, presence)),
        exists(volume.sets[0].textures[0].desc),
        lights(volume.sets[0].textures[1].desc),
        cells(volume.sets[1].textures[0].desc) {
    for (std::uint32_t brick = 0; brick < pool; ++brick) set_lights(brick, 0);
    for (std::uint32_t cell = 0; cell < block_count(cells.desc()); ++cell) name(cell, kNoBrick);
  }
  void set_lights(std::uint32_t brick, std::uint8_t count) {
    Bytes bytes(exists.block(brick).size());
    bytes[0] = static_cast<std::byte>(count);
    exists.set_block(brick, bytes);
    lights.fill_block(brick, Fill::noise, random);
  }
  void name(std::uint32_t cell, std::uint32_t brick) {
    cells.set_block(cell, std::as_bytes(std::span(&brick, 1)));
  }
  void publish(Server& server) {
    ASSERT_EQ(server.publish(0, 0, std::as_const(exists).view()), Status::ok);
    ASSERT_EQ(server.publish(0, 1, std::as_const(lights).view()), Status::ok);
    ASSERT_EQ(server.publish(0, 2, std::as_const(cells).view()), Status::ok);
  }
  VolumeDesc volume;
  Random random{5};
  Texture exists, lights, cells;
};

TEST(Lots, WhatExistsIsPublishedFirst) {
  World world(4, {2, 2, 1});
  Server server = make_server();
  ASSERT_TRUE(server.add_volume(world.volume, {{4, 1, 1}}).ok());
  world.publish(server);
  ASSERT_EQ(server.update(), Status::ok);
  world.set_lights(1, 3);
  ASSERT_EQ(server.publish(0, 0, std::as_const(world.exists).view()), Status::ok);
  EXPECT_EQ(server.update(), Status::invalid_argument) << "the lights are those of before";
  ASSERT_EQ(server.publish(0, 1, std::as_const(world.lights).view()), Status::ok);
  EXPECT_EQ(server.update(), Status::ok);
  world.set_lights(2, 5);
  ASSERT_EQ(server.publish(0, 0, std::as_const(world.exists).view()), Status::ok);
  EXPECT_EQ(server.publish(0, 1, std::as_const(world.lights).view()), Status::invalid_argument)
      << "a brick has four";
}

/// Counts and masks over the wire: what does not exist is zero at the client, whatever is
/// published.
TEST(Lots, PresenceGoesOverTheWire) {
  for (const Presence presence : {Presence::count, Presence::mask}) {
    World world(6, {1, 1, 1}, presence);
    for (std::uint32_t brick = 0; brick < 6; ++brick) {
      world.set_lights(
          brick, static_cast<std::uint8_t>(presence == Presence::mask ? 2 * brick : brick % 5));
    }
    for (const Delivery delivery : {Delivery::own, Delivery::shared}) {
      Server server = make_server("zstd");
      ASSERT_TRUE(server.add_volume(world.volume, {{6, 1, 1}}).ok());
      const ClientId client = *server.connect(delivery);
      ASSERT_EQ(server.set_visible(client, 0, BlockMask(6, 1)), Status::ok);
      world.publish(server);
      ASSERT_EQ(server.update(), Status::ok);
      const auto packets = server.packets(client);
      ASSERT_EQ(packets.size(), 2U);
      ASSERT_EQ(packets[0].stream.texture, 0);
      auto existing = *Decoder::create(world.exists.desc());
      auto lights = *Decoder::create(world.lights.desc());
      ASSERT_EQ(existing.decode(*packets[0].packet), Status::ok);
      ASSERT_EQ(lights.set_presence(existing.records()), Status::ok);
      ASSERT_EQ(lights.decode(*packets[1].packet), Status::ok);
      for (std::uint32_t brick = 0; brick < 6; ++brick) {
        Bytes expected = world.lights.block(brick);
        clear_absent_records(world.lights.desc(), world.exists.block(brick), expected);
        EXPECT_EQ(block_of(world.lights.desc(), contents(lights), brick), expected);
      }
    }
  }
}

TEST(Lots, HigherRanksComeFirst) {
  World world(8, {1, 1, 1});
  for (std::uint32_t brick = 0; brick < 8; ++brick) {
    world.set_lights(brick, static_cast<std::uint8_t>(brick % 4));
  }
  Server server = make_server();
  ASSERT_TRUE(server.add_volume(world.volume, {{8, 1, 1}}).ok());
  const ClientId client = *server.connect(Delivery::own, {4, 0});  // Two bricks of two textures.
  ASSERT_EQ(server.set_visible(client, 0, BlockMask(8, 1)), Status::ok);
  world.publish(server);
  std::map<StreamId, Decoder> decoders;
  std::vector<std::vector<std::uint32_t>> order;
  for (int update = 0; update < 4; ++update) {
    ASSERT_EQ(server.update(), Status::ok);
    std::vector<std::uint32_t> sent;
    for (const OutgoingPacket& packet : server.packets(client)) {
      if (packet.stream.texture != 0) continue;
      auto it = decoders.try_emplace(packet.stream, *Decoder::create(world.exists.desc())).first;
      ASSERT_EQ(it->second.decode(*packet.packet), Status::ok);
      sent.assign(it->second.updated().begin(), it->second.updated().end());
    }
    order.push_back(sent);
  }
  EXPECT_EQ(order, (std::vector<std::vector<std::uint32_t>>{{3, 7}, {2, 6}, {1, 5}, {0, 4}}));
}

/// A host and a client that know the kind.
class Pair {
 public:
  explicit Pair(const World& world, ClientOptions options = {}, HostOptions host_options = {}) {
    host_options.kinds = {&kBricks};
    host_options.proofs = true;
    host_options.resyncs_per_second = 100;
    host_.emplace(*Host::create(make_server(), host_options));
    EXPECT_TRUE(
        host_->add_volume("bricks", world.volume, {world.volume.sets[0].textures[0].desc.grid})
            .ok());
    options.kinds = {&kBricks};
    client_.emplace(*Client::create(options));
    connect();
  }
  void connect() {
    peer_ = *host_->connect(now_);
    host_->receive(peer_, *client_->hello(), now_);
  }
  void look(std::uint8_t set, const BlockMask& visible) {
    ASSERT_EQ(host_->server().set_visible(*host_->client(peer_), 0, visible, set), Status::ok);
  }
  /// An update, and its messages to the client unless they get lost.
  void update(bool lost = false) {
    now_ += 0.1;
    ASSERT_EQ(host_->update(now_, now_), Status::ok);
    for (const Message& message : host_->take_messages(peer_)) {
      if (lost) break;
      ASSERT_EQ(client_->receive(message), Status::ok);
    }
    for (const Message& reply : client_->take_replies()) host_->receive(peer_, reply, now_);
    EXPECT_EQ(client_->statistics().failed_proofs, 0U);
  }
  [[nodiscard]] Host& host() { return *host_; }
  [[nodiscard]] Server& server() { return host_->server(); }
  [[nodiscard]] Client& client() { return *client_; }
  [[nodiscard]] PeerId peer() const { return peer_; }
  [[nodiscard]] const ClientVolume& volume() const { return client_->frame().volumes[0]; }
  [[nodiscard]] Bytes held(std::size_t id, std::uint32_t block) const {
    return block_of(volume().textures[id].desc, volume().textures[id].texels, block);
  }

 private:
  double now_ = 0;
  std::optional<Host> host_;
  std::optional<Client> client_;
  PeerId peer_ = 0;
};

/// Nothing that is named comes later than what names it, however little there is room for and
/// whatever is lost, and everything comes in the end.
TEST(Lots, NamedBlocksComeFirst) {
  constexpr std::uint32_t kPool = 8, kCells = 6;
  for (const Delivery delivery : {Delivery::own, Delivery::shared}) {
    for (const std::uint32_t budget : {0U, 1U, 5U}) {
      World world(kPool, {3, 2, 1});
      ClientOptions options;
      options.delivery = delivery;
      options.budget.blocks = budget;
      Pair pair(world, options);
      // It sees cells only; what they name it wants, too.
      pair.look(1, BlockMask(kCells, 1));
      std::uint32_t named = 0;
      for (std::uint32_t update = 0; update < 400; ++update) {
        if (update < 60 && update % 3 == 0) {
          const std::uint32_t brick = update * 5 % kPool;
          world.set_lights(brick, static_cast<std::uint8_t>(1 + update % 4));
          world.name(update % kCells, brick);
          world.publish(pair.server());
        }
        pair.update(update % 7 == 4);
        const ClientFrame& frame = pair.client().frame();
        if (frame.serial == 0 || !pair.client().consistent()) continue;
        for (std::uint32_t cell = 0; cell < kCells; ++cell) {
          const ClientVolume& volume = pair.volume();
          if (volume.textures[2].changed[cell] != frame.serial) continue;
          std::uint32_t brick = 0;
          if (brick_of(pair.held(2, cell), std::span(&brick, 1)) == 0) continue;
          ++named;
          for (std::size_t id : {0, 1}) EXPECT_NE(volume.textures[id].changed[brick], 0U);
          EXPECT_EQ(pair.held(0, brick), world.exists.block(brick));
        }
      }
      EXPECT_GE(named, kCells / 2);
      for (std::uint32_t cell = 0; cell < kCells; ++cell) {
        EXPECT_EQ(pair.held(2, cell), world.cells.block(cell));
      }
      EXPECT_EQ(pair.server().state(*pair.host().client(pair.peer()))->owed, 0U);
    }
  }
}

/// What a block names that is not sent at all is not waited for.
TEST(Lots, InactiveBlocksAreNotWaitedFor) {
  World world(4, {1, 1, 1});
  world.name(0, 2);
  for (const Delivery delivery : {Delivery::own, Delivery::shared}) {
    ClientOptions options;
    options.delivery = delivery;
    Pair pair(world, options);
    ASSERT_EQ(pair.server().set_active(0, BlockMask{1, 1, 0, 1}), Status::ok);
    pair.look(1, BlockMask(1, 1));
    world.publish(pair.server());
    pair.update();
    EXPECT_NE(pair.volume().textures[2].changed[0], 0U);
    EXPECT_EQ(pair.volume().textures[0].changed[2], 0U);
  }
}

/// A block waits for the regions that hold what it names, not for all that it might name.
TEST(Lots, OnlyRegionsThatHoldWhatIsNamedAreWaitedFor) {
  World world(8, {1, 1, 1});
  for (std::uint32_t brick = 0; brick < 8; ++brick) world.set_lights(brick, 4);
  world.name(0, 5);
  ServerOptions options;
  options.backend = "raw";
  options.region = {1, 1, 1};
  auto server = *Server::create(options);
  ASSERT_TRUE(server.add_volume(world.volume, {{8, 1, 1}}).ok());
  const ClientId client = *server.connect(Delivery::shared);
  ASSERT_EQ(server.set_visible(client, 0, BlockMask(1, 1), 1), Status::ok);
  server.set_extra_blocks(1);  // One region in an update.
  world.publish(server);
  std::set<std::uint32_t> bricks_there;
  bool cell_there = false;
  for (int update = 0; update < 100 && !cell_there; ++update) {
    ASSERT_EQ(server.update(), Status::ok);
    for (const OutgoingPacket& packet : server.packets(client)) {
      if (packet.stream.texture == 2) {
        cell_there = true;
      } else {
        bricks_there.insert(packet.stream.region);
      }
    }
  }
  EXPECT_TRUE(cell_there);
  EXPECT_TRUE(bricks_there.contains(5));
  EXPECT_LT(bricks_there.size(), 8U);
}

TEST(Lots, AKindOfTheApplicationsOwnGoesOverTheWire) {
  World world(5, {2, 1, 1});
  world.set_lights(3, 4);
  world.name(1, 3);
  ClientOptions options;
  Pair pair(world, options);
  pair.look(0, BlockMask(5, 1));
  pair.look(1, BlockMask(2, 1));
  world.publish(pair.server());
  pair.update();
  EXPECT_EQ(pair.volume().desc, world.volume);
  EXPECT_EQ(pair.held(1, 3), world.lights.block(3));
  EXPECT_EQ(pair.held(2, 1), world.cells.block(1));

  // A host that does not know it does not take it, nor does a client.
  auto ignorant = *Host::create(make_server());
  EXPECT_EQ(ignorant.add_volume("bricks", world.volume, {{5, 1, 1}}).status(),
            Status::unknown_kind);
  auto client = *Client::create();
  const PeerId peer = *pair.host().connect(1);
  pair.host().receive(peer, *client.hello(), 1);
  const auto messages = pair.host().take_messages(peer);
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(client.receive(messages[0]), Status::unknown_kind);
}

/// Who comes back to another run of the server begins anew, whatever it shows.
TEST(Lots, AnotherEpochOfThePublisherBeginsAnew) {
  World world(3, {1, 1, 1});
  std::optional<Client> client;
  std::uint64_t began = 0;
  for (const std::uint64_t epoch : {7U, 9U}) {
    HostOptions options;
    options.epoch = epoch;
    options.kinds = {&kBricks};
    auto host = *Host::create(make_server(), options);
    ASSERT_TRUE(host.add_volume("bricks", world.volume, {{3, 1, 1}}).ok());
    if (!client) {
      ClientOptions of_client;
      of_client.kinds = {&kBricks};
      client.emplace(*Client::create(of_client));
    }
    const PeerId peer = *host.connect(0);
    host.receive(peer, *client->hello(), 0);
    ASSERT_EQ(host.server().set_visible(*host.client(peer), 0, BlockMask(3, 1)), Status::ok);
    world.publish(host.server());
    ASSERT_EQ(host.update(0, 0), Status::ok);
    for (const Message& message : host.take_messages(peer)) {
      ASSERT_EQ(client->receive(message), Status::ok);
    }
    EXPECT_FALSE(client->resumed());
    EXPECT_TRUE(client->consistent());
    EXPECT_EQ(client->frame().publisher, epoch);
    EXPECT_GT(client->frame().began, began);
    began = client->frame().began;
  }
}

/// A server that claims to go on with a session of another epoch is not believed.
TEST(Lots, ASessionOfAnotherEpochDoesNotGoOn) {
  World world(3, {1, 1, 1});
  Pair pair(world);
  pair.update();
  ASSERT_TRUE(pair.client().consistent());
  pair.host().disconnect(pair.peer(), 1);
  pair.connect();
  auto messages = pair.host().take_messages(pair.peer());
  ASSERT_EQ(messages.size(), 1U);
  auto welcome = std::get<Welcome>(*read_message(messages[0]));
  ASSERT_TRUE(welcome.resumed);
  ++welcome.publisher;
  ASSERT_EQ(write_message(welcome, messages[0]), Status::ok);
  EXPECT_EQ(pair.client().receive(messages[0]), Status::corrupt);
}

/// Parts say in which updates their streams come.
TEST(Lots, PartsTellTheirTier) {
  constexpr Grid kGrid{8, 4, 8};
  Texture texture_of(ddgi_irradiance(kGrid));
  ServerOptions server_options;
  server_options.backend = "raw";
  server_options.region = {2, 4, 2};
  auto host = *Host::create(*Server::create(server_options));
  ASSERT_TRUE(host.add_volume("probes", probes_of({{"color", texture_of.desc()}}), {kGrid}).ok());
  ClientOptions options;
  options.delivery = Delivery::shared;
  options.budget.bytes = 8000;  // An eighth or less of what changes.
  auto client = *Client::create(options);
  const PeerId peer = *host.connect(0);
  host.receive(peer, *client.hello(), 0);
  ASSERT_EQ(host.server().set_visible(*host.client(peer), 0, BlockMask(256, 1)), Status::ok);
  Random random(3);
  std::map<StreamId, std::vector<std::pair<int, unsigned>>> seen;
  for (int update = 0; update < 100; ++update) {
    texture_of.fill(Fill::noise, random);
    ASSERT_EQ(host.server().publish(0, 0, std::as_const(texture_of).view()), Status::ok);
    const double now = 0.1 * update;
    ASSERT_EQ(host.update(now, now), Status::ok);
    for (const Message& message : host.take_messages(peer)) {
      const auto read = read_message(message);
      if (const auto* said = std::get_if<UpdateMessage>(&*read)) {
        for (const auto& part : said->parts) seen[part.stream].emplace_back(update, part.tier);
      }
      ASSERT_EQ(client.receive(message), Status::ok);
    }
    for (const Message& reply : client.take_replies()) host.receive(peer, reply, now);
  }
  std::uint32_t slow = 0;
  for (const auto& [stream, times] : seen) {
    for (std::size_t i = 1; i < times.size(); ++i) {
      if (times[i].second == 0 || times[i].second != times[i - 1].second) continue;
      EXPECT_EQ((times[i].first - times[i - 1].first) % (1 << times[i].second), 0);
      ++slow;
    }
  }
  EXPECT_GT(slow, 20U);
}

}  // namespace
}  // namespace gicodec
