// Null in place of a handle, an output or a list gives a status.
#include "c_support.h"

#include <gtest/gtest.h>

#include <limits>
#include <utility>

namespace gicodec {
namespace {

using namespace test;

TEST(CNull, NullInPlaceOfAHandleOrAnOutput) {
  auto desc = irradiance();
  const auto volume = room(desc);
  CTexture texture(desc);
  auto view = texture.view();
  auto const_view = texture.const_view();
  std::size_t size = 0;
  std::uint32_t number = 0;
  std::uint64_t wide[4] = {};
  auto info = sized<gicodec_texture_info>();
  auto geometry = geometry_of(desc);

  EXPECT_EQ(gicodec_texture_desc_check(nullptr), kInvalid);
  EXPECT_NE(gicodec_texture_desc_problem(nullptr), nullptr);
  EXPECT_NE(gicodec_volume_desc_problem(nullptr), nullptr);
  EXPECT_EQ(gicodec_texture_desc_info(nullptr, &info), kInvalid);
  EXPECT_EQ(gicodec_texture_desc_info(&desc, nullptr), kInvalid);
  EXPECT_EQ(gicodec_texture_desc_complete(nullptr), kInvalid);
  EXPECT_EQ(gicodec_texture_desc_origin(&desc, 0, nullptr), kInvalid);
  EXPECT_EQ(gicodec_volume_desc_create(1, nullptr), kInvalid);
  EXPECT_EQ(gicodec_volume_desc_add_group(nullptr, 0), kInvalid);
  EXPECT_EQ(gicodec_volume_desc_add_texture(nullptr, "a", &desc), kInvalid);
  EXPECT_EQ(gicodec_volume_desc_add_texture(volume.get(), nullptr, &desc), kInvalid);
  EXPECT_EQ(gicodec_volume_desc_add_texture(volume.get(), "a", nullptr), kInvalid);
  EXPECT_EQ(gicodec_volume_desc_from_layout("rtxgi", 1, 1, 1, nullptr), kInvalid);
  EXPECT_EQ(gicodec_volume_desc_read(1, nullptr, 0, nullptr), kInvalid);
  EXPECT_EQ(gicodec_volume_desc_write(nullptr, nullptr, 0, &size), kInvalid);
  EXPECT_EQ(gicodec_volume_desc_write(volume.get(), nullptr, 9, &size), kInvalid);
  EXPECT_EQ(gicodec_volume_desc_write(volume.get(), nullptr, 0, nullptr), kInvalid);
  EXPECT_EQ(gicodec_volume_desc_copy(volume.get(), nullptr), kInvalid);
  EXPECT_EQ(gicodec_volume_desc_check(nullptr), kInvalid);
  EXPECT_EQ(gicodec_volume_desc_kind(nullptr), 0U);
  EXPECT_EQ(gicodec_volume_desc_groups(nullptr), 0U);
  EXPECT_EQ(gicodec_volume_desc_textures(nullptr), 0U);
  EXPECT_EQ(gicodec_volume_desc_texture_name(nullptr, 0), nullptr);
  EXPECT_EQ(gicodec_volume_desc_texture(nullptr, 0, &desc), kInvalid);
  EXPECT_EQ(gicodec_volume_desc_json(nullptr, nullptr, 0, &size), kInvalid);
  EXPECT_EQ(gicodec_volume_desc_json(volume.get(), nullptr, 0, nullptr), kInvalid);
  gicodec_volume_desc* no_volume = nullptr;
  EXPECT_EQ(gicodec_volume_desc_copy(nullptr, &no_volume), kInvalid);
  gicodec_volume_desc_destroy(nullptr);

  gicodec_encoder* encoder = nullptr;
  EXPECT_EQ(gicodec_encoder_create(nullptr, nullptr, &encoder), kInvalid);
  EXPECT_EQ(gicodec_encoder_create(&desc, nullptr, nullptr), kInvalid);
  EXPECT_EQ(gicodec_encoder_bound(nullptr, 1), 0U);
  EXPECT_EQ(gicodec_encoder_encode(nullptr, &const_view, 0, nullptr, 0, nullptr, 0, &size),
            kInvalid);
  EXPECT_EQ(gicodec_encoder_snapshot(nullptr, nullptr, 0, &size), kInvalid);
  EXPECT_EQ(gicodec_encoder_request_keyframe(nullptr), kInvalid);
  EXPECT_EQ(gicodec_encoder_set_preset(nullptr, "fast"), kInvalid);
  EXPECT_EQ(gicodec_encoder_set_active(nullptr, nullptr, 0), kInvalid);
  EXPECT_EQ(gicodec_encoder_set_presence(nullptr, nullptr, 0), kInvalid);
  EXPECT_EQ(gicodec_encoder_read(nullptr, &view), kInvalid);
  EXPECT_EQ(gicodec_encoder_sequence(nullptr), 0U);
  gicodec_encoder_destroy(nullptr);
  ASSERT_EQ(gicodec_encoder_create(&desc, nullptr, &encoder), GICODEC_OK);
  EXPECT_EQ(gicodec_encoder_encode(encoder, nullptr, 0, nullptr, 0, nullptr, 0, &size), kInvalid);
  EXPECT_EQ(gicodec_encoder_encode(encoder, &const_view, 0, nullptr, 0, nullptr, 0, nullptr),
            kInvalid);
  EXPECT_EQ(gicodec_encoder_encode(encoder, &const_view, 0, nullptr, 0, nullptr, 9, &size),
            kInvalid);
  EXPECT_EQ(gicodec_encoder_encode(encoder, &const_view, GICODEC_SELECT_LIST, nullptr, 2, &number,
                                   4, &size),
            kInvalid);
  EXPECT_EQ(gicodec_encoder_set_active(encoder, nullptr, 2), kInvalid);
  EXPECT_EQ(gicodec_encoder_set_presence(encoder, nullptr, 2), kInvalid);
  EXPECT_EQ(gicodec_encoder_set_presence(encoder, &number, 4), GICODEC_MASK_MISMATCH);
  EXPECT_EQ(gicodec_encoder_set_preset(encoder, "slow"), GICODEC_INVALID_SETTINGS);
  EXPECT_EQ(gicodec_encoder_read(encoder, nullptr), kInvalid);
  gicodec_encoder_destroy(encoder);

  gicodec_volume_encoder* volumes = nullptr;
  EXPECT_EQ(gicodec_volume_encoder_create(nullptr, nullptr, &volumes), kInvalid);
  EXPECT_EQ(gicodec_volume_encoder_create(volume.get(), nullptr, nullptr), kInvalid);
  EXPECT_EQ(gicodec_volume_encoder_encode(nullptr, &const_view, 1, 0, nullptr, 0), kInvalid);
  EXPECT_EQ(gicodec_volume_encoder_snapshot(nullptr), kInvalid);
  EXPECT_EQ(gicodec_volume_encoder_packets(nullptr), 0U);
  EXPECT_EQ(gicodec_volume_encoder_packet(nullptr, 0, &size), nullptr);
  EXPECT_EQ(gicodec_volume_encoder_request_keyframe(nullptr), kInvalid);
  EXPECT_EQ(gicodec_volume_encoder_set_preset(nullptr, 0, "fast"), kInvalid);
  EXPECT_EQ(gicodec_volume_encoder_set_active(nullptr, 0, nullptr, 0), kInvalid);
  EXPECT_EQ(gicodec_volume_encoder_read(nullptr, 0, &view), kInvalid);
  gicodec_volume_encoder_destroy(nullptr);
  ASSERT_EQ(gicodec_volume_encoder_create(volume.get(), nullptr, &volumes), GICODEC_OK);
  EXPECT_EQ(gicodec_volume_encoder_encode(volumes, nullptr, 1, 0, nullptr, 0), kInvalid);
  EXPECT_EQ(gicodec_volume_encoder_encode(volumes, &const_view, 0, 0, nullptr, 0), kInvalid);
  EXPECT_EQ(gicodec_volume_encoder_encode(volumes, &const_view, 256, 0, nullptr, 0), kInvalid);
  EXPECT_EQ(gicodec_volume_encoder_snapshot(volumes), GICODEC_OUT_OF_ORDER);
  EXPECT_EQ(gicodec_volume_encoder_packet(volumes, 0, nullptr), nullptr);
  EXPECT_EQ(gicodec_volume_encoder_set_preset(volumes, 256, "fast"), GICODEC_UNKNOWN_TEXTURE);
  EXPECT_EQ(gicodec_volume_encoder_set_active(volumes, 1, nullptr, 0), GICODEC_UNKNOWN_GROUP);
  EXPECT_EQ(gicodec_volume_encoder_set_active(volumes, 256, nullptr, 0), GICODEC_UNKNOWN_GROUP);
  EXPECT_EQ(gicodec_volume_encoder_read(volumes, 256, &view), GICODEC_UNKNOWN_TEXTURE);
  EXPECT_EQ(gicodec_volume_encoder_request_keyframe(volumes), GICODEC_OK);
  gicodec_volume_encoder_destroy(volumes);

  gicodec_decoder* decoder = nullptr;
  EXPECT_EQ(gicodec_decoder_create(nullptr, nullptr, &decoder), kInvalid);
  EXPECT_EQ(gicodec_decoder_create(&desc, nullptr, nullptr), kInvalid);
  EXPECT_EQ(gicodec_decoder_decode(nullptr, nullptr, 0, nullptr), kInvalid);
  gicodec_decoder_cancel(nullptr, 1);
  EXPECT_EQ(gicodec_decoder_set_presence(nullptr, nullptr, 0), kInvalid);
  EXPECT_EQ(gicodec_decoder_read(nullptr, &view, nullptr, 0), kInvalid);
  EXPECT_EQ(gicodec_decoder_changed(nullptr, &size), nullptr);
  EXPECT_EQ(gicodec_decoder_records(nullptr, &size), nullptr);
  EXPECT_EQ(gicodec_decoder_received(nullptr, &size), nullptr);
  EXPECT_EQ(gicodec_decoder_sequence(nullptr), 0U);
  EXPECT_EQ(gicodec_decoder_state_hash(nullptr), 0U);
  gicodec_decoder_destroy(nullptr);
  ASSERT_EQ(gicodec_decoder_create(&desc, nullptr, &decoder), GICODEC_OK);
  EXPECT_EQ(gicodec_decoder_decode(decoder, nullptr, 5, nullptr), kInvalid);
  EXPECT_NE(gicodec_decoder_decode(decoder, nullptr, 0, nullptr), GICODEC_OK);
  EXPECT_EQ(gicodec_decoder_set_presence(decoder, nullptr, 5), kInvalid);
  EXPECT_EQ(gicodec_decoder_read(decoder, &view, nullptr, 5), kInvalid);
  EXPECT_EQ(gicodec_decoder_read(decoder, nullptr, nullptr, 0), kInvalid);
  EXPECT_NE(gicodec_decoder_records(decoder, nullptr), nullptr);
  gicodec_decoder_destroy(decoder);

  gicodec_volume_decoder* decoders = nullptr;
  EXPECT_EQ(gicodec_volume_decoder_create(nullptr, nullptr, &decoders), kInvalid);
  EXPECT_EQ(gicodec_volume_decoder_create(volume.get(), nullptr, nullptr), kInvalid);
  EXPECT_EQ(gicodec_volume_decoder_decode(nullptr, nullptr, 0), kInvalid);
  gicodec_volume_decoder_cancel(nullptr, 1);
  EXPECT_EQ(gicodec_volume_decoder_read(nullptr, 0, &view, nullptr, 0), kInvalid);
  EXPECT_EQ(gicodec_volume_decoder_changed(nullptr, 0, &size), nullptr);
  EXPECT_EQ(gicodec_volume_decoder_records(nullptr, 0, &size), nullptr);
  gicodec_volume_decoder_destroy(nullptr);
  ASSERT_EQ(gicodec_volume_decoder_create(volume.get(), nullptr, &decoders), GICODEC_OK);
  EXPECT_EQ(gicodec_volume_decoder_decode(decoders, nullptr, 5), kInvalid);
  EXPECT_EQ(gicodec_volume_decoder_read(decoders, 256, &view, nullptr, 0), GICODEC_UNKNOWN_TEXTURE);
  EXPECT_EQ(gicodec_volume_decoder_records(decoders, 1, &size), nullptr);
  EXPECT_EQ(gicodec_volume_decoder_changed(decoders, 256, &size), nullptr);
  gicodec_volume_decoder_destroy(decoders);
  auto head = sized<gicodec_packet_info>();
  EXPECT_EQ(gicodec_packet_peek(nullptr, 9, &head), kInvalid);
  EXPECT_NE(gicodec_packet_peek(nullptr, 0, &head), GICODEC_OK);

  gicodec_container* container = nullptr;
  EXPECT_EQ(gicodec_container_create(nullptr), kInvalid);
  ASSERT_EQ(gicodec_container_create(&container), GICODEC_OK);
  EXPECT_EQ(gicodec_container_add_volume(nullptr, "a", volume.get()), kInvalid);
  EXPECT_EQ(gicodec_container_add_volume(container, "a", nullptr), kInvalid);
  EXPECT_EQ(gicodec_container_add_volume(container, "\xFF", volume.get()), GICODEC_INVALID_NAME);
  EXPECT_EQ(gicodec_container_set_geometry(nullptr, 0, &geometry), kInvalid);
  EXPECT_EQ(gicodec_container_set_geometry(container, 0, &geometry), GICODEC_UNKNOWN_VOLUME);
  ASSERT_EQ(gicodec_container_add_volume(container, nullptr, volume.get()), GICODEC_OK);
  EXPECT_EQ(gicodec_container_set_geometry(container, 0, nullptr), kInvalid);
  geometry.spacing[0] = 0;
  EXPECT_EQ(gicodec_container_set_geometry(container, 0, &geometry), GICODEC_INVALID_GEOMETRY);
  geometry.spacing[0] = 1;
  ++geometry.grid[0];
  EXPECT_EQ(gicodec_container_set_geometry(container, 0, &geometry), GICODEC_INVALID_GEOMETRY);
  EXPECT_EQ(gicodec_container_geometry(container, 0, &geometry), GICODEC_END);
  EXPECT_EQ(gicodec_container_geometry(nullptr, 0, &geometry), kInvalid);
  EXPECT_EQ(gicodec_container_geometry(container, 1, &geometry), GICODEC_UNKNOWN_VOLUME);
  EXPECT_EQ(gicodec_container_set_largest_error(nullptr, 0, 0), kInvalid);
  EXPECT_EQ(gicodec_container_set_largest_error(container, 1, 0), GICODEC_UNKNOWN_TEXTURE);
  EXPECT_EQ(gicodec_container_set_largest_error(container, 0, -1), GICODEC_INVALID_BOUND);
  EXPECT_EQ(gicodec_container_add_metadata(nullptr, 0, 0, "a", "b"), kInvalid);
  EXPECT_EQ(gicodec_container_add_metadata(container, 0, 0, nullptr, "b"), kInvalid);
  EXPECT_EQ(gicodec_container_add_metadata(container, 0, 0, "a", nullptr), kInvalid);
  EXPECT_EQ(gicodec_container_add_metadata(container, 0, 1, "a", "b"), kInvalid);
  EXPECT_EQ(gicodec_container_add_metadata(container, 3, 0, "a", "b"), kInvalid);
  EXPECT_EQ(gicodec_container_add_metadata(container, GICODEC_METADATA_VOLUME, 1, "a", "b"),
            kInvalid);
  EXPECT_EQ(gicodec_container_add_metadata(container, 0, 0, "\xFF", "b"), GICODEC_INVALID_NAME);
  EXPECT_EQ(gicodec_container_metadata_count(nullptr, 0, 0), 0U);
  EXPECT_EQ(gicodec_container_metadata_name(nullptr, 0, 0, 0), nullptr);
  EXPECT_EQ(gicodec_container_metadata_value(nullptr, 0, 0, 0, &size), nullptr);
  EXPECT_EQ(gicodec_container_set_scene(nullptr, "a", 0), kInvalid);
  EXPECT_EQ(gicodec_container_set_scene(container, "\xFF", 0), GICODEC_INVALID_NAME);
  EXPECT_STREQ(gicodec_container_scene(nullptr, wide), "");
  EXPECT_EQ(gicodec_container_volumes(nullptr), 0U);
  EXPECT_EQ(gicodec_container_textures(nullptr), 0U);
  EXPECT_EQ(gicodec_container_volume_name(nullptr, 0), nullptr);
  EXPECT_EQ(gicodec_container_volume(nullptr, 0, &no_volume), kInvalid);
  EXPECT_EQ(gicodec_container_volume(container, 0, nullptr), kInvalid);
  EXPECT_EQ(gicodec_container_volume(container, 1, &no_volume), GICODEC_UNKNOWN_VOLUME);
  EXPECT_EQ(gicodec_container_texture_name(nullptr, 0), nullptr);
  EXPECT_EQ(gicodec_container_texture(nullptr, 0, &desc, nullptr), kInvalid);
  EXPECT_EQ(gicodec_container_texture(container, 1, &desc, nullptr), GICODEC_UNKNOWN_TEXTURE);
  EXPECT_EQ(gicodec_container_largest_error(container, 1), std::numeric_limits<float>::infinity());
  EXPECT_EQ(gicodec_container_json(nullptr, nullptr, 0, &size), kInvalid);
  std::uint32_t major = 0;
  EXPECT_EQ(gicodec_container_version(nullptr, 10, &major, &major, &major), kInvalid);
  EXPECT_EQ(gicodec_container_version("", 0, nullptr, &major, &major), kInvalid);
  EXPECT_EQ(gicodec_container_version("", 0, &major, nullptr, &major), kInvalid);
  EXPECT_EQ(gicodec_container_version("", 0, &major, &major, nullptr), kInvalid);
  EXPECT_EQ(gicodec_container_version("", 0, &major, &major, &major), GICODEC_TRUNCATED);

  gicodec_writer* writer = nullptr;
  auto sink = sized<gicodec_sink>();
  EXPECT_EQ(gicodec_writer_create(nullptr, nullptr, &writer), kInvalid);
  EXPECT_EQ(gicodec_writer_create(nullptr, container, nullptr), kInvalid);
  EXPECT_EQ(gicodec_writer_create(&sink, container, &writer), kInvalid);
  EXPECT_EQ(gicodec_writer_add(nullptr, 0, &number, 4), kInvalid);
  EXPECT_EQ(gicodec_writer_flush(nullptr), kInvalid);
  EXPECT_EQ(gicodec_writer_finish(nullptr), kInvalid);
  EXPECT_EQ(gicodec_writer_bytes(nullptr, &size), nullptr);
  EXPECT_EQ(gicodec_writer_take(nullptr), kInvalid);
  gicodec_writer_destroy(nullptr);
  ASSERT_EQ(gicodec_writer_create(nullptr, container, &writer), GICODEC_OK);
  EXPECT_EQ(gicodec_writer_add(writer, 0, nullptr, 4), kInvalid);
  EXPECT_NE(gicodec_writer_add(writer, 0, &number, 4), GICODEC_OK);
  const std::uint8_t* const bytes = gicodec_writer_bytes(writer, &size);

  gicodec_player* player = nullptr;
  auto source = sized<gicodec_source>();
  EXPECT_EQ(gicodec_player_open(nullptr, nullptr, &player), kInvalid);
  EXPECT_EQ(gicodec_player_open(&source, nullptr, &player), kInvalid);
  EXPECT_EQ(gicodec_player_open_memory(nullptr, 9, nullptr, &player), kInvalid);
  EXPECT_NE(gicodec_player_open_memory(nullptr, 0, nullptr, &player), GICODEC_OK);
  EXPECT_EQ(gicodec_player_open_memory(bytes, size, nullptr, nullptr), kInvalid);
  EXPECT_EQ(gicodec_player_container(nullptr), nullptr);
  EXPECT_EQ(gicodec_player_select(nullptr, nullptr, 0), kInvalid);
  EXPECT_EQ(gicodec_player_set_growing(nullptr, 1), kInvalid);
  EXPECT_EQ(gicodec_player_set_layout(nullptr, 0, &desc), kInvalid);
  EXPECT_EQ(gicodec_player_next(nullptr), kInvalid);
  EXPECT_EQ(gicodec_player_finished(nullptr), 0U);
  EXPECT_EQ(gicodec_player_seekable(nullptr), 0U);
  const std::uint32_t corner[3] = {};
  EXPECT_EQ(gicodec_player_select_box(nullptr, 0, corner, corner), GICODEC_INVALID_ARGUMENT);
  EXPECT_EQ(gicodec_player_memory(nullptr), 0U);
  EXPECT_EQ(gicodec_player_seek(nullptr, 0), kInvalid);
  EXPECT_EQ(gicodec_player_frame(nullptr), 0U);
  const std::uint64_t* frames = nullptr;
  EXPECT_EQ(gicodec_player_frames(nullptr, &frames, &size), kInvalid);
  EXPECT_EQ(gicodec_player_read(nullptr, 0, &view), kInvalid);
  EXPECT_EQ(gicodec_player_read_changed(nullptr, 0, &view), kInvalid);
  std::size_t count = 0;
  EXPECT_EQ(gicodec_player_changed(nullptr, 0, &count), nullptr);
  gicodec_player_destroy(nullptr);
  (void)gicodec_writer_bytes(writer, &size);
  ASSERT_EQ(gicodec_player_open_memory(bytes, size, nullptr, &player), GICODEC_OK);
  EXPECT_EQ(gicodec_player_select(player, nullptr, 3), kInvalid);
  EXPECT_EQ(gicodec_player_set_layout(player, 0, nullptr), kInvalid);
  EXPECT_EQ(gicodec_player_set_layout(player, 256, &desc), GICODEC_UNKNOWN_TEXTURE);
  EXPECT_EQ(gicodec_player_frames(player, nullptr, &size), kInvalid);
  EXPECT_EQ(gicodec_player_read(player, 256, &view), GICODEC_UNKNOWN_TEXTURE);
  EXPECT_EQ(gicodec_player_read_changed(player, 0, nullptr), kInvalid);
  EXPECT_EQ(gicodec_player_changed(player, 256, &count), nullptr);
  gicodec_player_destroy(player);
  gicodec_writer_destroy(writer);
  gicodec_container_destroy(container);
  gicodec_container_destroy(nullptr);
}

TEST(CNull, NullInPlaceOfAClientOrServer) {
  const auto desc = irradiance();
  const auto volume = room(desc);
  CTexture texture(desc);
  auto view = texture.view();
  auto const_view = texture.const_view();
  auto geometry = geometry_of(desc);
  std::size_t size = 0;
  std::uint32_t number = 0;
  std::uint64_t wide = 0;
  const std::uint32_t* blocks = nullptr;

  gicodec_client* client = nullptr;
  auto state = sized<gicodec_client_state>();
  auto viewpoint = sized<gicodec_viewpoint>();
  EXPECT_EQ(gicodec_client_create(nullptr, nullptr), kInvalid);
  auto viewing = sized<gicodec_client_options>();
  viewing.delivery = 2;
  EXPECT_EQ(gicodec_client_create(&viewing, &client), kInvalid);
  EXPECT_EQ(gicodec_client_hello(nullptr), kInvalid);
  EXPECT_EQ(gicodec_client_receive(nullptr, &number, 4), kInvalid);
  EXPECT_EQ(gicodec_client_message(nullptr, &size), nullptr);
  gicodec_client_cancel(nullptr, 1);
  EXPECT_EQ(gicodec_client_set_viewpoint(nullptr, &viewpoint), kInvalid);
  EXPECT_EQ(gicodec_client_subscribe(nullptr, 0, 0, nullptr, 0), kInvalid);
  EXPECT_EQ(gicodec_client_disconnect(nullptr), kInvalid);
  EXPECT_EQ(gicodec_client_get_state(nullptr, &state), kInvalid);
  EXPECT_EQ(gicodec_client_volume(nullptr, 0, &number, &wide), kInvalid);
  gicodec_volume_desc* no_volume = nullptr;
  EXPECT_EQ(gicodec_client_volume_desc(nullptr, 0, &no_volume), kInvalid);
  EXPECT_EQ(gicodec_client_volume_name(nullptr, 0), nullptr);
  EXPECT_EQ(gicodec_client_geometry(nullptr, 0, &geometry), kInvalid);
  EXPECT_EQ(gicodec_client_texels(nullptr, 0, 0, &size), nullptr);
  EXPECT_EQ(gicodec_client_changed(nullptr, 0, 0, 0, &blocks, &size), kInvalid);
  EXPECT_EQ(gicodec_client_read(nullptr, 0, 0, 0, &view), kInvalid);
  gicodec_client_destroy(nullptr);
  ASSERT_EQ(gicodec_client_create(nullptr, &client), GICODEC_OK);
  EXPECT_EQ(gicodec_client_message(client, &size), nullptr);
  EXPECT_EQ(gicodec_client_receive(client, nullptr, 4), kInvalid);
  EXPECT_NE(gicodec_client_receive(client, &number, 4), GICODEC_OK);
  EXPECT_EQ(gicodec_client_set_viewpoint(client, nullptr), kInvalid);
  EXPECT_EQ(gicodec_client_subscribe(client, 0, 0, nullptr, 3), kInvalid);
  EXPECT_EQ(gicodec_client_subscribe(client, 65536, 0, nullptr, 0), GICODEC_UNKNOWN_VOLUME);
  EXPECT_EQ(gicodec_client_subscribe(client, 0, 256, nullptr, 0), GICODEC_UNKNOWN_GROUP);
  EXPECT_EQ(gicodec_client_get_state(client, nullptr), kInvalid);
  EXPECT_EQ(gicodec_client_volume(client, 0, nullptr, nullptr), kInvalid);
  EXPECT_EQ(gicodec_client_volume(client, 0, &number, nullptr), GICODEC_UNKNOWN_VOLUME);
  EXPECT_EQ(gicodec_client_volume_desc(client, 0, nullptr), kInvalid);
  EXPECT_EQ(gicodec_client_volume_desc(client, 65536, &no_volume), GICODEC_UNKNOWN_VOLUME);
  EXPECT_EQ(gicodec_client_geometry(client, 0, &geometry), GICODEC_UNKNOWN_VOLUME);
  EXPECT_EQ(gicodec_client_changed(client, 0, 0, 0, &blocks, nullptr), kInvalid);
  EXPECT_EQ(gicodec_client_changed(client, 0, 0, 0, &blocks, &size), GICODEC_UNKNOWN_VOLUME);
  EXPECT_EQ(gicodec_client_read(client, 0, 256, 0, &view), GICODEC_UNKNOWN_TEXTURE);
  gicodec_client_destroy(client);

  gicodec_server* server = nullptr;
  auto event = sized<gicodec_event>();
  auto connection = sized<gicodec_connection_state>();
  EXPECT_EQ(gicodec_server_create(nullptr, nullptr), kInvalid);
  auto server_options = sized<gicodec_server_options>();
  server_options.preset = "slow";
  EXPECT_EQ(gicodec_server_create(&server_options, &server), GICODEC_INVALID_SETTINGS);
  server_options.preset = "strong";
  EXPECT_EQ(gicodec_server_create(&server_options, &server), GICODEC_OK);
  gicodec_server_destroy(std::exchange(server, nullptr));
  EXPECT_EQ(gicodec_server_add_volume(nullptr, "a", volume.get(), &geometry, nullptr, 0, &number),
            kInvalid);
  EXPECT_EQ(gicodec_server_remove_volume(nullptr, 0), kInvalid);
  EXPECT_EQ(gicodec_server_publish(nullptr, 0, 0, &const_view, nullptr, 0), kInvalid);
  EXPECT_EQ(gicodec_server_scroll(nullptr, 0, 0, 0, 0), kInvalid);
  EXPECT_EQ(gicodec_server_set_active(nullptr, 0, 0, nullptr, 0), kInvalid);
  EXPECT_EQ(gicodec_server_connect(nullptr, 0, nullptr, &number), kInvalid);
  EXPECT_EQ(gicodec_server_receive(nullptr, 0, &number, 4, 0), kInvalid);
  EXPECT_EQ(gicodec_server_disconnect(nullptr, 0, 0), kInvalid);
  EXPECT_EQ(gicodec_server_drop(nullptr, 0, 0), kInvalid);
  EXPECT_EQ(gicodec_server_set_visible(nullptr, 0, 0, 0, nullptr, 0), kInvalid);
  EXPECT_EQ(gicodec_server_update(nullptr, 0, 0), kInvalid);
  EXPECT_EQ(gicodec_server_report_update_time(nullptr, 0, 0), kInvalid);
  EXPECT_EQ(gicodec_server_tick(nullptr, 0), kInvalid);
  EXPECT_EQ(gicodec_server_message(nullptr, 0, &size), nullptr);
  EXPECT_EQ(gicodec_server_event(nullptr, &event), kInvalid);
  EXPECT_EQ(gicodec_server_viewpoint(nullptr, 0, &viewpoint), kInvalid);
  EXPECT_EQ(gicodec_server_connection(nullptr, 0, &connection), kInvalid);
  gicodec_server_destroy(nullptr);
  ASSERT_EQ(gicodec_server_create(nullptr, &server), GICODEC_OK);
  EXPECT_EQ(gicodec_server_event(server, &event), GICODEC_END);
  EXPECT_EQ(gicodec_server_add_volume(server, "a", nullptr, &geometry, nullptr, 0, &number),
            kInvalid);
  EXPECT_EQ(gicodec_server_add_volume(server, "a", volume.get(), nullptr, nullptr, 0, &number),
            kInvalid);
  EXPECT_EQ(gicodec_server_add_volume(server, "a", volume.get(), &geometry, nullptr, 1, &number),
            kInvalid);
  EXPECT_EQ(gicodec_server_add_volume(server, "a", volume.get(), &geometry, nullptr, 0, nullptr),
            kInvalid);
  EXPECT_EQ(gicodec_server_publish(server, 0, 0, &const_view, nullptr, 0), GICODEC_UNKNOWN_VOLUME);
  EXPECT_EQ(gicodec_server_publish(server, 65536, 0, &const_view, nullptr, 0),
            GICODEC_UNKNOWN_VOLUME);
  ASSERT_EQ(gicodec_server_add_volume(server, "a", volume.get(), &geometry, nullptr, 0, &number),
            GICODEC_OK);
  EXPECT_EQ(gicodec_server_publish(server, number, 256, &const_view, nullptr, 0),
            GICODEC_UNKNOWN_TEXTURE);
  EXPECT_EQ(gicodec_server_publish(server, number, 0, nullptr, nullptr, 0), kInvalid);
  EXPECT_EQ(gicodec_server_publish(server, number, 0, &const_view, nullptr, 1), kInvalid);
  EXPECT_EQ(gicodec_server_set_active(server, number, 0, nullptr, 1), kInvalid);
  EXPECT_EQ(gicodec_server_set_active(server, number, 256, nullptr, 0), GICODEC_UNKNOWN_GROUP);
  EXPECT_EQ(gicodec_server_scroll(server, 65536, 0, 0, 0), GICODEC_UNKNOWN_VOLUME);
  EXPECT_EQ(gicodec_server_connect(server, 0, nullptr, nullptr), kInvalid);
  EXPECT_EQ(gicodec_server_receive(server, 0, nullptr, 4, 0), kInvalid);
  EXPECT_EQ(gicodec_server_drop(server, 0, 99), kInvalid);
  EXPECT_EQ(gicodec_server_set_visible(server, 9, number, 0, nullptr, 0),
            GICODEC_UNKNOWN_CONNECTION);
  EXPECT_EQ(gicodec_server_viewpoint(server, 9, &viewpoint), GICODEC_UNKNOWN_CONNECTION);
  EXPECT_EQ(gicodec_server_connection(server, 9, &connection), GICODEC_UNKNOWN_CONNECTION);
  EXPECT_EQ(gicodec_server_update(server, 0, std::numeric_limits<double>::infinity()),
            GICODEC_INVALID_TIME);
  EXPECT_EQ(gicodec_server_tick(server, 1), GICODEC_OK);
  EXPECT_EQ(gicodec_server_report_update_time(server, 0.001, 0.01), GICODEC_OK);
  gicodec_server_destroy(server);
}

TEST(CNull, NullInPlaceOfWhatTracksNeed) {
  std::uint32_t number = 0;
  std::size_t size = 0;
  const gicodec_track track{0, 0, 0};
  auto name = sized<gicodec_track_name>();
  auto message = sized<gicodec_track_message>();
  const gicodec_track* tracks = nullptr;
  const gicodec_track_object* objects = nullptr;
  auto state = sized<gicodec_track_receiver_state>();

  gicodec_track_publisher* publisher = nullptr;
  EXPECT_EQ(gicodec_track_publisher_create(nullptr, nullptr, &publisher), kInvalid);
  EXPECT_EQ(gicodec_track_publisher_update(nullptr, 0, 0), kInvalid);
  EXPECT_EQ(gicodec_track_publisher_message(nullptr, &message), kInvalid);
  EXPECT_EQ(gicodec_track_publisher_name(nullptr, &track, &name), kInvalid);
  EXPECT_EQ(gicodec_track_publisher_kept_seconds(nullptr), 0);
  EXPECT_EQ(gicodec_track_publisher_repeat_snapshots(nullptr), kInvalid);
  gicodec_track_publisher_destroy(nullptr);
  auto serving = sized<gicodec_server_options>();
  const auto drawn =
      made<OwnedServer>([&](auto out) { return gicodec_server_create(&serving, out); });
  EXPECT_EQ(gicodec_track_publisher_create(drawn.get(), nullptr, &publisher), kInvalid);
  serving.epoch = 1;
  const auto server =
      made<OwnedServer>([&](auto out) { return gicodec_server_create(&serving, out); });
  EXPECT_EQ(gicodec_track_publisher_create(server.get(), nullptr, nullptr), kInvalid);
  const auto owned = made<OwnedPublisher>(
      [&](auto out) { return gicodec_track_publisher_create(server.get(), nullptr, out); });
  EXPECT_EQ(gicodec_track_publisher_message(owned.get(), &message), GICODEC_END);
  EXPECT_EQ(gicodec_track_publisher_name(owned.get(), nullptr, &name), kInvalid);

  EXPECT_EQ(gicodec_track_receiver_create(nullptr, nullptr), kInvalid);
  EXPECT_EQ(gicodec_track_receiver_receive(nullptr, &number, 4), kInvalid);
  EXPECT_EQ(gicodec_track_receiver_take(nullptr, &number, 4), kInvalid);
  EXPECT_EQ(gicodec_track_receiver_message(nullptr, &size), nullptr);
  EXPECT_EQ(gicodec_track_receiver_wanted(nullptr, &tracks, &size), kInvalid);
  EXPECT_EQ(gicodec_track_receiver_requests(nullptr, &number, &objects, &size), kInvalid);
  EXPECT_EQ(gicodec_track_receiver_name(nullptr, &track, &name), kInvalid);
  EXPECT_EQ(gicodec_track_receiver_get_state(nullptr, &state), kInvalid);
  gicodec_track_receiver_destroy(nullptr);
  const auto receiver =
      made<OwnedReceiver>([](auto out) { return gicodec_track_receiver_create(nullptr, out); });
  EXPECT_EQ(gicodec_track_receiver_receive(receiver.get(), nullptr, 4), kInvalid);
  EXPECT_EQ(gicodec_track_receiver_take(receiver.get(), nullptr, 4), kInvalid);
  EXPECT_EQ(gicodec_track_receiver_take(receiver.get(), &number, 4), kInvalid);
  EXPECT_EQ(gicodec_track_receiver_message(receiver.get(), nullptr), nullptr);
  EXPECT_EQ(gicodec_track_receiver_wanted(receiver.get(), nullptr, &size), kInvalid);
  EXPECT_EQ(gicodec_track_receiver_requests(receiver.get(), nullptr, &objects, &size), kInvalid);
  EXPECT_EQ(gicodec_track_receiver_requests(receiver.get(), &number, nullptr, &size), kInvalid);
  EXPECT_EQ(gicodec_track_receiver_requests(receiver.get(), &number, &objects, nullptr), kInvalid);
  EXPECT_EQ(gicodec_track_receiver_name(receiver.get(), nullptr, &name), kInvalid);
  EXPECT_EQ(gicodec_track_receiver_get_state(receiver.get(), nullptr), kInvalid);
}

}  // namespace
}  // namespace gicodec
