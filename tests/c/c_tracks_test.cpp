// Tracks through the C interface: a publisher, a broker that keeps what it is told to, and
// receivers.
#include "c_support.h"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <set>
#include <string>
#include <tuple>

namespace gicodec {
namespace {

using namespace test;
using Bytes = std::vector<std::uint8_t>;

/// A receiver and its client, whose messages are carried at once.
struct Viewer {
  explicit Viewer(
      const gicodec_track_receiver_options& options = sized<gicodec_track_receiver_options>()) {
    auto viewing = sized<gicodec_client_options>();
    viewing.delivery = GICODEC_DELIVERY_SHARED;
    client = made<OwnedClient>([&](auto out) { return gicodec_client_create(&viewing, out); });
    tracks =
        made<OwnedReceiver>([&](auto out) { return gicodec_track_receiver_create(&options, out); });
    EXPECT_EQ(gicodec_client_hello(client.get()), GICODEC_OK);
    answer();
  }
  void receive(const Bytes& message) const {
    ASSERT_EQ(gicodec_track_receiver_receive(tracks.get(), message.data(), message.size()),
              GICODEC_OK);
  }
  /// What the client says goes to the receiver.
  void answer() const {
    std::size_t size = 0;
    while (const std::uint8_t* const message = gicodec_client_message(client.get(), &size))
      ASSERT_EQ(gicodec_track_receiver_take(tracks.get(), message, size), GICODEC_OK);
  }
  void advance() const {
    std::size_t size = 0;
    while (const std::uint8_t* const message = gicodec_track_receiver_message(tracks.get(), &size))
      ASSERT_EQ(gicodec_client_receive(client.get(), message, size), GICODEC_OK);
    answer();
  }
  [[nodiscard]] gicodec_track_receiver_state state() const {
    auto out = sized<gicodec_track_receiver_state>();
    EXPECT_EQ(gicodec_track_receiver_get_state(tracks.get(), &out), GICODEC_OK);
    return out;
  }
  [[nodiscard]] std::vector<std::string> wanted() const {
    const gicodec_track* first = nullptr;
    std::size_t count = 0;
    EXPECT_EQ(gicodec_track_receiver_wanted(tracks.get(), &first, &count), GICODEC_OK);
    std::vector<std::string> names;
    for (std::size_t i = 0; i < count; ++i) {
      auto name = sized<gicodec_track_name>();
      EXPECT_EQ(gicodec_track_receiver_name(tracks.get(), &first[i], &name), GICODEC_OK);
      names.push_back(std::string(name.volume) + "." + name.texture + "." +
                      std::to_string(name.place[0]));
    }
    return names;
  }
  [[nodiscard]] Bytes texels() const {
    std::size_t size = 0;
    const std::uint8_t* const first = gicodec_client_texels(client.get(), 0, 0, &size);
    return {first, first + size};
  }

  OwnedClient client;
  OwnedReceiver tracks;
};

/// A server of one volume in regions of two probes, and all that its publisher said.
struct Publisher {
  Publisher() : desc(irradiance(8, 2, 2)), texture(desc) {
    auto serving = sized<gicodec_server_options>();
    serving.region[0] = serving.region[1] = serving.region[2] = 2;
    serving.epoch = 7;
    server = made<OwnedServer>([&](auto out) { return gicodec_server_create(&serving, out); });
    auto options = sized<gicodec_track_publisher_options>();
    options.snapshot_seconds = 1;
    publisher = made<OwnedPublisher>(
        [&](auto out) { return gicodec_track_publisher_create(server.get(), &options, out); });
    const auto volume = room(desc);
    const auto geometry = geometry_of(desc);
    EXPECT_EQ(
        gicodec_server_add_volume(server.get(), "room", volume.get(), &geometry, nullptr, 0, &id),
        GICODEC_OK);
  }
  /// Publishes an update; returns its messages.
  std::vector<Bytes> update() {
    now += 0.1;
    texture.paint(++painted);
    const auto view = texture.const_view();
    EXPECT_EQ(gicodec_server_publish(server.get(), id, 0, &view, nullptr, 0), GICODEC_OK);
    EXPECT_EQ(gicodec_track_publisher_update(publisher.get(), now, now), GICODEC_OK);
    std::vector<Bytes> said;
    auto message = sized<gicodec_track_message>();
    while (gicodec_track_publisher_message(publisher.get(), &message) == GICODEC_OK) {
      said.emplace_back(message.bytes, message.bytes + message.size);
      types.insert(message.type);
      kept[{message.type, message.track.region, message.number}] = said.back();
    }
    return said;
  }
  /// Brings what the receiver asks for.
  void fetch(const Viewer& viewer) const {
    std::uint32_t list = 0;
    const gicodec_track_object* objects = nullptr;
    std::size_t count = 0;
    ASSERT_EQ(gicodec_track_receiver_requests(viewer.tracks.get(), &list, &objects, &count),
              GICODEC_OK);
    if (list != 0) {
      viewer.receive(kept.at({GICODEC_TRACKS_LIST, 0, 0}));
      viewer.receive(kept.at({GICODEC_TRACKS_TICK, 0, 0}));
    }
    for (const gicodec_track_object* one = objects; one != objects + count; ++one) {
      const auto found = kept.find({GICODEC_TRACKS_OBJECT, one->track.region, one->number});
      if (found != kept.end()) viewer.receive(found->second);
    }
  }
  /// All that the receiver asks for, and asks for because of that.
  void settle(const Viewer& viewer) const {
    for (int trip = 0; trip < 4; ++trip) {
      fetch(viewer);
      viewer.advance();
    }
  }

  gicodec_texture_desc desc;
  CTexture texture;
  OwnedServer server;
  OwnedPublisher publisher;
  std::uint32_t id = 9, painted = 0;
  double now = 0;
  std::set<std::uint32_t> types;
  std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>, Bytes> kept;
};

TEST(CTracks, ALateViewerHoldsWhatIsPublished) {
  Publisher publisher;
  for (int i = 0; i < 25; ++i) ASSERT_FALSE(publisher.update().empty());
  EXPECT_EQ(publisher.types.size(), 3U);
  EXPECT_EQ(gicodec_track_publisher_kept_seconds(publisher.publisher.get()), 16);

  const Viewer viewer;
  publisher.settle(viewer);
  EXPECT_EQ(viewer.state().complete, 1U);
  EXPECT_EQ(viewer.wanted().size(), 4U);
  EXPECT_EQ(viewer.texels(), publisher.texture.bytes);
  for (int i = 0; i < 25; ++i) {
    for (const Bytes& message : publisher.update()) viewer.receive(message);
    viewer.advance();
    EXPECT_EQ(viewer.texels(), publisher.texture.bytes);
  }
  EXPECT_EQ(viewer.state().damaged, 0U);
  EXPECT_EQ(viewer.state().wants_hello, 0U);
}

TEST(CTracks, WithAReachTheNearOnesComeFirst) {
  Publisher publisher;
  for (int i = 0; i < 3; ++i) publisher.update();
  auto options = sized<gicodec_track_receiver_options>();
  options.reach = 2;
  const Viewer viewer(options);
  auto viewpoint = sized<gicodec_viewpoint>();
  viewpoint.eye[0] = 7;
  viewpoint.target[0] = 8;
  viewpoint.up[1] = 1;
  viewpoint.fov_y = 60;
  viewpoint.aspect = 1;
  ASSERT_EQ(gicodec_client_set_viewpoint(viewer.client.get(), &viewpoint), GICODEC_OK);
  publisher.settle(viewer);
  EXPECT_EQ(viewer.wanted(), (std::vector<std::string>{"room.color.3", "room.color.2"}));
  EXPECT_EQ(viewer.state().complete, 1U);
}

TEST(CTracks, NothingButWhatIsSubscribedTo) {
  Publisher publisher;
  for (int i = 0; i < 3; ++i) publisher.update();
  auto options = sized<gicodec_track_receiver_options>();
  options.subscribed_only = 1;
  const Viewer viewer(options);
  publisher.settle(viewer);
  EXPECT_TRUE(viewer.wanted().empty());
  std::vector<std::uint8_t> blocks(32);
  blocks[4] = 1;
  ASSERT_EQ(gicodec_client_subscribe(viewer.client.get(), 0, 0, blocks.data(), blocks.size()),
            GICODEC_OK);
  viewer.answer();
  publisher.settle(viewer);
  EXPECT_EQ(viewer.wanted(), std::vector<std::string>{"room.color.2"});
  EXPECT_EQ(viewer.state().complete, 1U);
}

TEST(CTracks, DamagedMessagesAreCountedAndFetchedAgain) {
  Publisher publisher;
  publisher.update();
  const Viewer viewer;
  for (int i = 0; i < 30; ++i) {
    for (Bytes message : publisher.update()) {
      if (i == 3) message[message.size() / 2] ^= 4;
      if (i == 8) message.resize(message.size() / 2);
      viewer.receive(message);
    }
    viewer.advance();
    publisher.fetch(viewer);
    viewer.advance();
  }
  EXPECT_GT(viewer.state().damaged, 0U);
  EXPECT_GT(viewer.state().requests, 0U);
  EXPECT_EQ(viewer.texels(), publisher.texture.bytes);
}

TEST(CTracks, TicksOfAnUnknownListAskForItAgain) {
  Publisher publisher;
  const Viewer viewer;
  const auto asks = [&] {
    std::uint32_t list = 0;
    const gicodec_track_object* objects = nullptr;
    std::size_t count = 0;
    EXPECT_EQ(gicodec_track_receiver_requests(viewer.tracks.get(), &list, &objects, &count),
              GICODEC_OK);
    return list != 0;
  };
  EXPECT_TRUE(asks());  // The answer is lost.
  EXPECT_FALSE(asks());
  for (int i = 0; i < 2; ++i) {
    publisher.update();
    EXPECT_FALSE(asks());
    viewer.receive(publisher.kept.at({GICODEC_TRACKS_TICK, 0, 0}));
  }
  EXPECT_TRUE(asks());
}

TEST(CTracks, WhatDoesNotExistIsSaid) {
  Publisher publisher;
  publisher.update();
  auto name = sized<gicodec_track_name>();
  for (const gicodec_track track : {gicodec_track{65536, 0, 0}, gicodec_track{0, 256, 0},
                                    gicodec_track{0, 0, 99}, gicodec_track{9, 0, 0}}) {
    EXPECT_EQ(gicodec_track_publisher_name(publisher.publisher.get(), &track, &name),
              GICODEC_UNKNOWN_REGION);
    const Viewer viewer;
    EXPECT_EQ(gicodec_track_receiver_name(viewer.tracks.get(), &track, &name),
              GICODEC_UNKNOWN_REGION);
  }
  const gicodec_track first{publisher.id, 0, 0};
  ASSERT_EQ(gicodec_track_publisher_name(publisher.publisher.get(), &first, &name), GICODEC_OK);
  EXPECT_STREQ(name.volume, "room");
  EXPECT_STREQ(name.texture, "color");

  auto options = sized<gicodec_track_receiver_options>();
  options.reach = -1;
  gicodec_track_receiver* receiver = nullptr;
  EXPECT_EQ(gicodec_track_receiver_create(&options, &receiver), kInvalid);
  auto shares = sized<gicodec_track_publisher_options>();
  shares.snapshot_share = 1;
  gicodec_track_publisher* second = nullptr;
  EXPECT_EQ(gicodec_track_publisher_create(publisher.server.get(), &shares, &second), kInvalid);
  EXPECT_EQ(gicodec_track_publisher_update(publisher.publisher.get(), 1,
                                           std::numeric_limits<double>::infinity()),
            GICODEC_INVALID_TIME);

  // The next update repeats all snapshots.
  EXPECT_EQ(gicodec_track_publisher_repeat_snapshots(publisher.publisher.get()), GICODEC_OK);
  std::size_t snapshots = 0;
  (void)publisher.update();
  for (const auto& [key, bytes] : publisher.kept)
    snapshots += std::get<0>(key) == GICODEC_TRACKS_OBJECT && std::get<2>(key) == 0 ? 1 : 0;
  EXPECT_EQ(snapshots, 4U);
}

}  // namespace
}  // namespace gicodec
