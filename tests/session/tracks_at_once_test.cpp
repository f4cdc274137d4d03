// A viewer that stood still takes many updates at once.
#include "session/any_volume.h"

#include <gicodec/client.h>
#include <gicodec/probes.h>
#include <gicodec/track_publisher.h>
#include <gicodec/track_receiver.h>

#include <gtest/gtest.h>

#include <map>
#include <utility>
#include <vector>

namespace gicodec {
namespace {

using namespace test;

const TextureDesc kRoom = probe_texture(Format::R16_SFLOAT, {4, 2, 2}, 2, 0);

/// A publisher of two regions, and a viewer.
struct Room {
  Room() {
    texture.fill(Fill::noise, random);
    const NamedTexture color{"color", kRoom};
    EXPECT_TRUE(server.add_volume("room", *probe_volume({&color, 1}), {kRoom.grid}).ok());
    EXPECT_EQ(receiver.take(*client.hello()), Status::ok);
  }

  /// An update with a change of these blocks, of which the viewer gets all but snapshots.
  void update(const std::vector<std::uint32_t>& blocks) {
    for (const std::uint32_t block : blocks) texture.fill_block(block, Fill::noise, random);
    ASSERT_EQ(server.publish(0, 0, std::as_const(texture).view()), Status::ok);
    now += 0.1;
    ASSERT_EQ(publisher.update(now, now), Status::ok);
    for (const TrackMessage& message : publisher.messages()) {
      if (message.type == TrackMessage::Type::list) list = message.bytes;
      if (message.type == TrackMessage::Type::object)
        objects[{message.stream, message.number}] = message.bytes;
      if (message.type == TrackMessage::Type::object && message.number == 0) continue;
      ASSERT_EQ(receiver.receive(message.bytes), Status::ok);
    }
  }

  void exchange() {
    const auto messages = receiver.take_messages();
    ASSERT_TRUE(messages.ok());
    for (const Message& message : *messages) ASSERT_EQ(client.receive(message), Status::ok);
    for (const Message& message : client.take_messages())
      ASSERT_EQ(receiver.take(message), Status::ok);
  }

  /// Returns how much was asked for.
  std::size_t fetch() {
    const TrackRequests requests = *receiver.take_requests();
    if (requests.list && !list.empty()) {
      EXPECT_EQ(receiver.receive(list), Status::ok);
    }
    for (const auto& [stream, number] : requests.objects) {
      const auto found = objects.find({stream, number});
      if (found == objects.end()) continue;
      EXPECT_EQ(receiver.receive(found->second), Status::ok);
    }
    return requests.objects.size();
  }

  void expect_shown() {
    EXPECT_TRUE(receiver.complete());
    EXPECT_TRUE(client.consistent());
    EXPECT_EQ(client.frame().update, server.updates());
    const ClientTexture& shown = client.frame().volumes[0].textures[0];
    for (std::uint32_t block = 0; block < block_count(kRoom); ++block) {
      EXPECT_EQ(block_of(shown.desc, shown.texels, block), texture.block(block)) << block;
    }
  }

  Random random{1};
  Texture texture{kRoom};
  Server server = *Server::create({.backend = "native", .region = {2, 2, 2}, .epoch = 1});
  TrackPublisher publisher = *TrackPublisher::create(server, {.snapshot_share = 0.9});
  TrackReceiver receiver = *TrackReceiver::create();
  Client client = *Client::create({.delivery = Delivery::shared});
  double now = 0;
  Message list;
  std::map<std::pair<StreamId, std::uint32_t>, Message> objects;
};

TEST(TracksAtOnce, WhatChangedBeforeSnapshotsIsThere) {
  Room room;
  for (int i = 0; i < 12; ++i) {
    room.update({0});
    room.exchange();
    room.fetch();
    room.exchange();
  }
  room.expect_shown();
  for (int burst = 0; burst < 4; ++burst) {
    const std::uint64_t snapshots = room.publisher.statistics().snapshots;
    room.update({0, 2});  // both regions
    for (int i = 0; i < 15; ++i) room.update({0});
    EXPECT_GT(room.publisher.statistics().snapshots, snapshots + 1);
    room.exchange();
    EXPECT_EQ(room.fetch(), 0U);
    room.expect_shown();
  }
}

}  // namespace
}  // namespace gicodec
