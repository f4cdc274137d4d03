// A server and its clients through the C interface.
#include "c_support.h"

#include <gtest/gtest.h>

#include <cstring>

namespace gicodec {
namespace {

using namespace test;

/// A server of one volume, and a client whose messages a test carries.
struct CSession {
  explicit CSession(const gicodec_server_options* serving = nullptr,
                    const gicodec_client_options* viewing = nullptr)
      : desc(irradiance()), texture(desc) {
    server = made<OwnedServer>([&](auto out) { return gicodec_server_create(serving, out); });
    client = made<OwnedClient>([&](auto out) { return gicodec_client_create(viewing, out); });
    volume = room(desc);
    const auto geometry = geometry_of(desc);
    EXPECT_EQ(
        gicodec_server_add_volume(server.get(), "room", volume.get(), &geometry, nullptr, 0, &id),
        GICODEC_OK);
  }
  void connect() {
    ASSERT_EQ(gicodec_server_connect(server.get(), now, "peer", &connection), GICODEC_OK);
    ASSERT_EQ(gicodec_client_hello(client.get()), GICODEC_OK);
  }
  void to_server() {
    std::size_t size = 0;
    while (const std::uint8_t* const message = gicodec_client_message(client.get(), &size)) {
      ASSERT_EQ(gicodec_server_receive(server.get(), connection, message, size, now), GICODEC_OK);
    }
  }
  gicodec_status to_client() {
    std::size_t size = 0;
    gicodec_status status = GICODEC_OK;
    while (const std::uint8_t* const message =
               gicodec_server_message(server.get(), connection, &size)) {
      if (status == GICODEC_OK) status = gicodec_client_receive(client.get(), message, size);
    }
    return status;
  }
  /// An update of what changed; returns what the client says.
  gicodec_status update() {
    now += 1.0 / 30;
    to_server();
    const auto view = texture.const_view();
    EXPECT_EQ(gicodec_server_publish(server.get(), id, 0, &view, nullptr, 0), GICODEC_OK);
    EXPECT_EQ(gicodec_server_update(server.get(), now, now), GICODEC_OK);
    return to_client();
  }
  [[nodiscard]] gicodec_client_state state() const {
    auto out = sized<gicodec_client_state>();
    EXPECT_EQ(gicodec_client_get_state(client.get(), &out), GICODEC_OK);
    return out;
  }
  [[nodiscard]] std::vector<gicodec_event> events() const {
    std::vector<gicodec_event> found;
    auto event = sized<gicodec_event>();
    while (gicodec_server_event(server.get(), &event) == GICODEC_OK) found.push_back(event);
    return found;
  }

  gicodec_texture_desc desc;
  CTexture texture;
  OwnedServer server;
  OwnedClient client;
  OwnedVolume volume;
  std::uint32_t id = 9, connection = 0;
  double now = 0;
};

TEST(CSession, TheClientHoldsWhatTheServerPublished) {
  for (const std::uint32_t delivery : {GICODEC_DELIVERY_UNICAST, GICODEC_DELIVERY_SHARED}) {
    auto viewing = sized<gicodec_client_options>();
    viewing.delivery = delivery;
    CSession session(nullptr, &viewing);
    session.connect();
    session.texture.paint(1);
    for (int i = 0; i < 20; ++i) ASSERT_EQ(session.update(), GICODEC_OK);
    const auto first = session.state();
    EXPECT_TRUE(first.connected != 0 && first.consistent != 0 && first.resumed == 0);
    EXPECT_EQ(first.volumes, 1U);
    std::uint32_t volume = 0;
    std::uint64_t instance = 0;
    ASSERT_EQ(gicodec_client_volume(session.client.get(), 0, &volume, &instance), GICODEC_OK);
    EXPECT_EQ(volume, session.id);
    EXPECT_STREQ(gicodec_client_volume_name(session.client.get(), volume), "room");
    const auto desc = made<OwnedVolume>(
        [&](auto out) { return gicodec_client_volume_desc(session.client.get(), volume, out); });
    EXPECT_STREQ(gicodec_volume_desc_texture_name(desc.get(), 0), "color");
    std::size_t size = 0;
    const std::uint8_t* const texels =
        gicodec_client_texels(session.client.get(), volume, 0, &size);
    ASSERT_EQ(size, session.texture.bytes.size());
    EXPECT_EQ(std::memcmp(texels, session.texture.bytes.data(), size), 0);

    // One probe changes.
    CTexture copy(session.desc);
    const auto view = copy.view();
    ASSERT_EQ(gicodec_client_read(session.client.get(), volume, 0, 0, &view), GICODEC_OK);
    session.texture.bytes[5 * 10 * 4 + 12 * 10 * 4 * 3] ^= 1;
    for (int i = 0; i < 3; ++i) ASSERT_EQ(session.update(), GICODEC_OK);
    const std::uint32_t* blocks = nullptr;
    std::size_t count = 0;
    ASSERT_EQ(
        gicodec_client_changed(session.client.get(), volume, 0, first.serial, &blocks, &count),
        GICODEC_OK);
    ASSERT_EQ(count, 1U);
    EXPECT_EQ(blocks[0], 5U);
    ASSERT_EQ(gicodec_client_read(session.client.get(), volume, 0, first.serial, &view),
              GICODEC_OK);
    EXPECT_EQ(copy.bytes, session.texture.bytes);

    auto connection = sized<gicodec_connection_state>();
    ASSERT_EQ(gicodec_server_connection(session.server.get(), session.connection, &connection),
              GICODEC_OK);
    EXPECT_EQ(connection.delivery, delivery);
    EXPECT_EQ(connection.pending, 0U);
  }
}

TEST(CSession, EventsViewpointsAndInterest) {
  CSession session;
  session.connect();
  ASSERT_EQ(session.update(), GICODEC_OK);
  const std::uint64_t before = session.state().serial;
  auto viewpoint = sized<gicodec_viewpoint>();
  EXPECT_EQ(gicodec_server_viewpoint(session.server.get(), session.connection, &viewpoint),
            GICODEC_END);
  viewpoint.eye[0] = 3;
  viewpoint.target[2] = -1;
  viewpoint.up[1] = 1;
  viewpoint.fov_y = 190;
  viewpoint.aspect = 1;
  EXPECT_EQ(gicodec_client_set_viewpoint(session.client.get(), &viewpoint),
            GICODEC_INVALID_ARGUMENT);
  viewpoint.fov_y = 60;
  ASSERT_EQ(gicodec_client_set_viewpoint(session.client.get(), &viewpoint), GICODEC_OK);
  std::vector<std::uint8_t> wanted(24);
  wanted[3] = 1;
  ASSERT_EQ(gicodec_client_subscribe(session.client.get(), session.id, 0, wanted.data(), 24),
            GICODEC_OK);
  EXPECT_EQ(gicodec_client_subscribe(session.client.get(), session.id, 0, wanted.data(), 23),
            GICODEC_MASK_MISMATCH);
  session.texture.paint(4);
  for (int i = 0; i < 5; ++i) ASSERT_EQ(session.update(), GICODEC_OK);
  auto told = sized<gicodec_viewpoint>();
  ASSERT_EQ(gicodec_server_viewpoint(session.server.get(), session.connection, &told), GICODEC_OK);
  EXPECT_EQ(told.eye[0], 3);
  std::vector<std::uint32_t> types;
  for (const gicodec_event& event : session.events()) {
    types.push_back(event.type);
    EXPECT_EQ(event.connection, session.connection);
  }
  EXPECT_EQ(types, (std::vector<std::uint32_t>{GICODEC_EVENT_JOINED, GICODEC_EVENT_VIEWPOINT,
                                               GICODEC_EVENT_SUBSCRIBED}));
  const std::uint32_t* blocks = nullptr;
  std::size_t count = 0;
  ASSERT_EQ(gicodec_client_changed(session.client.get(), session.id, 0, before, &blocks, &count),
            GICODEC_OK);
  EXPECT_EQ(std::vector<std::uint32_t>(blocks, blocks + count), std::vector<std::uint32_t>{3});
}

TEST(CSession, ALostConnectionIsResumed) {
  CSession session;
  session.connect();
  session.texture.paint(1);
  for (int i = 0; i < 10; ++i) ASSERT_EQ(session.update(), GICODEC_OK);
  ASSERT_EQ(gicodec_server_disconnect(session.server.get(), session.connection, session.now),
            GICODEC_OK);
  session.texture.paint(2);
  session.connect();
  for (int i = 0; i < 10; ++i) ASSERT_EQ(session.update(), GICODEC_OK);
  EXPECT_NE(session.state().resumed, 0U);
  std::size_t size = 0;
  const std::uint8_t* const texels =
      gicodec_client_texels(session.client.get(), session.id, 0, &size);
  ASSERT_EQ(size, session.texture.bytes.size());
  EXPECT_EQ(std::memcmp(texels, session.texture.bytes.data(), size), 0);
}

TEST(CSession, StrangersAreTurnedAway) {
  auto serving = sized<gicodec_server_options>();
  serving.token = "open sesame";
  for (const char* const token : {"open sesame", "guess", static_cast<const char*>(nullptr)}) {
    auto viewing = sized<gicodec_client_options>();
    viewing.token = token;
    CSession session(&serving, &viewing);
    session.connect();
    session.to_server();
    const bool knows = token == std::string_view("open sesame").data() ||
                       (token != nullptr && std::strcmp(token, serving.token) == 0);
    EXPECT_EQ(session.update(), knows ? GICODEC_OK : GICODEC_END);
    if (!knows) {
      EXPECT_STREQ(gicodec_reason_text(session.state().reason), gicodec_reason_text(2));
    }
  }
  // Bytes that are no message.
  CSession session;
  session.connect();
  ASSERT_EQ(gicodec_server_receive(session.server.get(), session.connection, "nonsense", 8, 0),
            GICODEC_OK);
  const auto events = session.events();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].type, GICODEC_EVENT_DROPPED);
  EXPECT_NE(gicodec_client_receive(session.client.get(), "nonsense", 8), GICODEC_OK);
}

TEST(CSession, VolumesComeAndGo) {
  CSession session;
  session.connect();
  for (int i = 0; i < 3; ++i) ASSERT_EQ(session.update(), GICODEC_OK);
  auto slow = sized<gicodec_streamed_texture>();
  slow.interval = 2;
  const auto geometry = geometry_of(session.desc);
  std::uint32_t second = 0;
  ASSERT_EQ(gicodec_server_add_volume(session.server.get(), "hall", session.volume.get(), &geometry,
                                      &slow, 1, &second),
            GICODEC_OK);
  slow.texture = 1;
  std::uint32_t none = 77;
  EXPECT_EQ(gicodec_server_add_volume(session.server.get(), "hall", session.volume.get(), &geometry,
                                      &slow, 1, &none),
            GICODEC_UNKNOWN_TEXTURE);
  EXPECT_EQ(none, 77U);
  for (int i = 0; i < 3; ++i) ASSERT_EQ(session.update(), GICODEC_OK);
  EXPECT_EQ(session.state().volumes, 2U);
  ASSERT_EQ(gicodec_server_remove_volume(session.server.get(), session.id), GICODEC_OK);
  EXPECT_EQ(gicodec_server_remove_volume(session.server.get(), 65536 + second),
            GICODEC_UNKNOWN_VOLUME);
  session.id = second;
  for (int i = 0; i < 3; ++i) ASSERT_EQ(session.update(), GICODEC_OK);
  EXPECT_EQ(session.state().volumes, 1U);
  ASSERT_EQ(gicodec_server_scroll(session.server.get(), second, 1, 0, 0), GICODEC_OK);
  ASSERT_EQ(session.update(), GICODEC_OK);
  auto moved = sized<gicodec_geometry>();
  ASSERT_EQ(gicodec_client_geometry(session.client.get(), second, &moved), GICODEC_OK);
  EXPECT_EQ(moved.scroll[0], 1);
  ASSERT_EQ(gicodec_client_disconnect(session.client.get()), GICODEC_OK);
  session.to_server();
  EXPECT_EQ(session.events().back().type, GICODEC_EVENT_DROPPED);
}

}  // namespace
}  // namespace gicodec
