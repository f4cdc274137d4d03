// Calls of the C interface when memory runs out: a failed call changes nothing and can be made
// again.
#include "../c/c_support.h"
#include "faults.h"

#include <cstring>

namespace gicodec {
namespace {

using namespace test;

/// Makes a call again until it does not fail.
template <typename Call>
gicodec_status repeat(Fault& fault, const Call& call) {
  gicodec_status status = fault(call);
  if (status == GICODEC_OUT_OF_MEMORY) status = call();
  return status;
}

TEST(CFaults, CodingContainersAndSessions) {
  const auto desc = irradiance();
  CTexture source(desc);
  source.paint(1);
  const auto view = source.const_view();
  const auto geometry = geometry_of(desc);
  const std::size_t faults = with_every_fault([&](Fault& fault) {
    gicodec_volume_desc* volume = nullptr;
    ASSERT_EQ(repeat(fault, [&] { return gicodec_volume_desc_create(1, &volume); }), GICODEC_OK);
    const OwnedVolume own_volume(volume);
    ASSERT_EQ(
        repeat(fault, [&] { return gicodec_volume_desc_add_texture(volume, "color", &desc); }),
        GICODEC_OK);
    std::size_t size = 0;
    char json[2000];
    ASSERT_EQ(
        repeat(fault, [&] { return gicodec_volume_desc_json(volume, json, sizeof json, &size); }),
        GICODEC_OK);
    gicodec_volume_encoder* encoder = nullptr;
    ASSERT_EQ(
        repeat(fault, [&] { return gicodec_volume_encoder_create(volume, nullptr, &encoder); }),
        GICODEC_OK);
    const OwnedVolumeEncoder own_encoder(encoder);
    gicodec_container* container = nullptr;
    ASSERT_EQ(repeat(fault, [&] { return gicodec_container_create(&container); }), GICODEC_OK);
    const OwnedContainer own_container(container);
    ASSERT_EQ(
        repeat(fault, [&] { return gicodec_container_add_volume(container, "room", volume); }),
        GICODEC_OK);
    ASSERT_EQ(repeat(fault, [&] { return gicodec_container_set_scene(container, "villa", 1); }),
              GICODEC_OK);
    gicodec_writer* writer = nullptr;
    ASSERT_EQ(repeat(fault, [&] { return gicodec_writer_create(nullptr, container, &writer); }),
              GICODEC_OK);
    const OwnedWriter own_writer(writer);
    ASSERT_EQ(repeat(fault,
                     [&] {
                       return gicodec_volume_encoder_encode(encoder, &view, 1,
                                                            GICODEC_SELECT_CHANGED, nullptr, 0);
                     }),
              GICODEC_OK);
    const std::uint8_t* const packet = gicodec_volume_encoder_packet(encoder, 0, &size);
    ASSERT_EQ(repeat(fault, [&] { return gicodec_writer_add(writer, 5, packet, size); }),
              GICODEC_OK);
    ASSERT_EQ(repeat(fault, [&] { return gicodec_writer_finish(writer); }), GICODEC_OK);
    const std::uint8_t* const bytes = gicodec_writer_bytes(writer, &size);
    gicodec_player* player = nullptr;
    ASSERT_EQ(
        repeat(fault, [&] { return gicodec_player_open_memory(bytes, size, nullptr, &player); }),
        GICODEC_OK);
    const OwnedPlayer own_player(player);
    const std::uint64_t* frames = nullptr;
    ASSERT_EQ(repeat(fault, [&] { return gicodec_player_frames(player, &frames, &size); }),
              GICODEC_OK);
    ASSERT_EQ(repeat(fault, [&] { return gicodec_player_next(player); }), GICODEC_OK);
    CTexture out(desc);
    const auto to = out.view();
    ASSERT_EQ(repeat(fault, [&] { return gicodec_player_read(player, 0, &to); }), GICODEC_OK);
    EXPECT_EQ(out.bytes, source.bytes);

    gicodec_server* server = nullptr;
    gicodec_client* client = nullptr;
    std::uint32_t id = 0, connection = 0;
    ASSERT_EQ(repeat(fault, [&] { return gicodec_server_create(nullptr, &server); }), GICODEC_OK);
    const OwnedServer own_server(server);
    ASSERT_EQ(repeat(fault,
                     [&] {
                       return gicodec_server_add_volume(server, "room", volume, &geometry, nullptr,
                                                        0, &id);
                     }),
              GICODEC_OK);
    ASSERT_EQ(repeat(fault, [&] { return gicodec_client_create(nullptr, &client); }), GICODEC_OK);
    const OwnedClient own_client(client);
    ASSERT_EQ(
        repeat(fault, [&] { return gicodec_server_connect(server, 0, nullptr, &connection); }),
        GICODEC_OK);
    ASSERT_EQ(repeat(fault, [&] { return gicodec_client_hello(client); }), GICODEC_OK);
    const auto has_all = [&] {
      std::size_t held = 0;
      const std::uint8_t* const texels = gicodec_client_texels(client, id, 0, &held);
      return held == source.bytes.size() && std::memcmp(texels, source.bytes.data(), held) == 0;
    };
    // A message that memory is missing for is there at the next call; what was lost is asked for.
    for (unsigned tick = 1; tick < 60 && !has_all(); ++tick) {
      const double now = tick / 30.0;
      const std::uint8_t* message = nullptr;
      const auto of_client = [&] { return message = gicodec_client_message(client, &size); };
      while (fault(of_client) != nullptr) {
        (void)fault([&] { return gicodec_server_receive(server, connection, message, size, now); });
      }
      ASSERT_EQ(
          repeat(fault, [&] { return gicodec_server_publish(server, id, 0, &view, nullptr, 0); }),
          GICODEC_OK);
      (void)fault([&] { return gicodec_server_update(server, now, now); });
      const auto of_server = [&] {
        return message = gicodec_server_message(server, connection, &size);
      };
      bool dropped = false;
      while (fault(of_server) != nullptr) {
        const gicodec_status status =
            fault([&] { return gicodec_client_receive(client, message, size); });
        ASSERT_TRUE(status == GICODEC_OK || status == GICODEC_OUT_OF_MEMORY ||
                    status == GICODEC_END);
        dropped = dropped || status != GICODEC_OK;
      }
      auto event = sized<gicodec_event>();
      while (fault([&] { return gicodec_server_event(server, &event); }) == GICODEC_OK) {
        dropped = dropped || event.type == GICODEC_EVENT_DROPPED;
      }
      auto state = sized<gicodec_connection_state>();
      if (tick > 2 && gicodec_server_connection(server, connection, &state) != GICODEC_OK) {
        dropped = true;
      }
      if (dropped) {  // the one peer that memory was missing for
        (void)gicodec_server_disconnect(server, connection, now);
        ASSERT_EQ(gicodec_server_connect(server, now, nullptr, &connection), GICODEC_OK);
        ASSERT_EQ(gicodec_client_hello(client), GICODEC_OK);
      }
    }
    EXPECT_TRUE(has_all());
  });
  EXPECT_GT(faults, 100U);
}

}  // namespace
}  // namespace gicodec
