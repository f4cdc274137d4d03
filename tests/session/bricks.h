// A kind of an application for tests of sessions, and a server with a client that know it.
#pragma once

#include "../messages.h"
#include "session/any_volume.h"
#include "support.h"
#include "volumes.h"

#include <gicodec/client.h>
#include <gicodec/server.h>

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <optional>

namespace gicodec::test {

using namespace test;

/// A texture of blocks of so many records of a format, in a row.
inline NamedTexture texture(const char* name, Format format, std::uint8_t records, Grid grid,
                            Space space = Space::grid) {
  TextureDesc desc;
  desc.record = format;
  desc.block = {records, 1, 1};
  desc.grid = grid;
  desc.space = space;
  desc.model = Model::none;
  desc.layout = Tiling::blocks;
  return {name, desc};
}

/// What was sent for a client in the last update: blocks by texture.
inline std::map<std::uint8_t, std::vector<std::uint32_t>> sent_by(
    Distributor& distributor, ClientId client, std::map<StreamId, Decoder>& decoders,
    const VolumeDesc& volume) {
  std::map<std::uint8_t, std::vector<std::uint32_t>> sent;
  const auto textures = textures_of(volume);
  for (const OutgoingPacket& packet : distributor.packets(client)) {
    TextureDesc desc = textures[packet.stream.texture]->desc;
    if (packet.stream.region != StreamId::kWholeVolume) {
      desc = region_texture(desc, distributor.options().region, packet.stream.region);
    }
    const auto it = decoders.try_emplace(packet.stream, *Decoder::create(desc)).first;
    EXPECT_EQ(it->second.decode(*packet.packet), Status::ok);
    auto& blocks = sent[packet.stream.texture];
    const auto listed = listed_blocks(it->second, *packet.packet);
    blocks.insert(blocks.end(), listed.begin(), listed.end());
  }
  return sent;
}

inline Distributor make_distributor(const char* backend = "raw") {
  DistributorOptions options;
  options.backend = backend;
  return *Distributor::create(options);
}

// A kind of an application: bricks of up to four lights, counted, in a pool; and cells of a grid,
// each of which names a brick. The brightest bricks come first.

inline constexpr std::uint8_t kKindBricks = 200;
inline constexpr std::uint32_t kNoBrick = UINT32_MAX;

inline std::size_t brick_of(std::span<const std::byte> cell, std::span<std::uint32_t> out) {
  std::uint32_t brick = 0;
  std::memcpy(&brick, cell.data(), sizeof brick);
  if (brick == kNoBrick) return 0;
  if (!out.empty()) out[0] = brick;
  return 1;
}

inline float lights_of(std::span<const std::byte> count) {
  return std::to_integer<std::uint8_t>(count[0]);
}

inline VolumeDesc bricks(std::uint32_t pool, Grid cells, Presence presence = Presence::count) {
  VolumeDesc volume{kKindBricks, {{}, {}}};
  NamedTexture lights =
      texture("lights", Format::E5B9G9R9_UFLOAT_PACK32, 4, {pool, 1, 1}, Space::pool);
  lights.desc.presence = presence;
  const bool count = presence == Presence::count;
  TextureGroup& group = volume.groups[0];
  group.textures = {texture("exists", Format::R8_UINT, count ? 2 : 1, {pool, 1, 1}, Space::pool),
                    lights};
  group.bundled = true;
  group.presence = 0;
  group.rank = lights_of;
  volume.groups[1].textures = {texture("cells", Format::R32_UINT, 1, cells)};
  volume.groups[1].depends_on = 0;
  volume.groups[1].dependencies = brick_of;
  return volume;
}

inline Status write_bricks(const VolumeDesc& volume, std::vector<std::byte>& out) {
  const TextureDesc& pool = volume.groups[0].textures[0].desc;
  const TextureDesc& cells = volume.groups[1].textures[0].desc;
  for (const std::uint32_t side : {pool.grid.x, cells.grid.x, cells.grid.y, cells.grid.z}) {
    out.push_back(static_cast<std::byte>(side));
  }
  return Status::ok;
}

inline Result<VolumeDesc> read_bricks(std::span<const std::byte> in) {
  if (in.size() != 4) return Status::corrupt;
  const auto side = [&](std::size_t i) { return std::to_integer<std::uint32_t>(in[i]); };
  const VolumeDesc volume = bricks(side(0), {side(1), side(2), side(3)});
  if (validate(volume) != Status::ok) return Status::corrupt;
  return volume;
}

inline constexpr Kind kBricks{kKindBricks, "bricks", write_bricks, read_bricks, nullptr};

/// Bricks and cells to be published.
struct World {
  explicit World(std::uint32_t pool, Grid grid, Presence presence = Presence::count)
      : volume(bricks(pool, grid, presence)),
        exists(volume.groups[0].textures[0].desc),
        lights(volume.groups[0].textures[1].desc),
        cells(volume.groups[1].textures[0].desc) {
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
  template <typename To>  // A Server or a Distributor.
  void publish(To& to) {
    ASSERT_EQ(to.publish(0, 0, std::as_const(exists).view()), Status::ok);
    ASSERT_EQ(to.publish(0, 1, std::as_const(lights).view()), Status::ok);
    ASSERT_EQ(to.publish(0, 2, std::as_const(cells).view()), Status::ok);
  }
  VolumeDesc volume;
  Random random{5};
  Texture exists, lights, cells;
};

/// A server and a client that know the kind.
class Pair {
 public:
  explicit Pair(const World& world, ClientOptions options = {}, ServerOptions server_options = {}) {
    server_options.kinds = {&kBricks};
    server_options.proofs = true;
    server_options.limits.resyncs_per_second = 100;
    server_options.backend = "raw";
    server_.emplace(*Server::create(server_options));
    EXPECT_TRUE(
        server_->add_volume("bricks", world.volume, {world.volume.groups[0].textures[0].desc.grid})
            .ok());
    options.kinds = {&kBricks};
    client_.emplace(*Client::create(options));
    connect();
    for (std::uint8_t group = 0; group < world.volume.groups.size(); ++group) look(group, {});
  }
  void connect() {
    connection_ = *server_->connect(now_);
    server_->receive(connection_, *client_->hello(), now_);
  }
  void look(std::uint8_t group, const BlockMask& visible) {
    ASSERT_EQ(server_->set_visible(connection_, 0, visible, group), Status::ok);
  }
  /// An update, and its messages to the client unless they get lost.
  void update(bool lost = false) {
    now_ += 0.1;
    ASSERT_EQ(server_->update(now_, now_), Status::ok);
    for (const Message& message : joined(server_->take_messages(connection_))) {
      if (lost) break;
      ASSERT_EQ(client_->receive(message), Status::ok);
    }
    for (const Message& reply : client_->take_messages())
      server_->receive(connection_, reply, now_);
    EXPECT_EQ(client_->statistics().failed_proofs, 0U);
  }
  [[nodiscard]] Server& server() { return *server_; }
  [[nodiscard]] Client& client() { return *client_; }
  [[nodiscard]] ConnectionId connection() const { return connection_; }
  [[nodiscard]] const ClientVolume& volume() const { return client_->frame().volumes[0]; }
  [[nodiscard]] Bytes held(std::size_t id, std::uint32_t block) const {
    return block_of(volume().textures[id].desc, volume().textures[id].texels, block);
  }

 private:
  double now_ = 0;
  std::optional<Server> server_;
  std::optional<Client> client_;
  ConnectionId connection_ = 0;
};

}  // namespace gicodec::test
