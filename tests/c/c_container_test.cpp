// Containers through the C interface: memory, callers' functions, descriptions, metadata.
#include "c_support.h"

#include <gicodec/gicodec.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string>
#include <vector>

namespace gicodec {
namespace {

using namespace test;

/// A file in memory by the functions of a caller, which fail on demand.
struct CFile {
  std::vector<std::uint8_t> bytes;
  std::size_t position = 0;
  gicodec_status failure = GICODEC_OK;
  std::uint64_t prefetched = 0;  ///< bytes

  static std::uint32_t prefetch(void* self, const gicodec_range* ranges, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      static_cast<CFile*>(self)->prefetched += ranges[i].size;
    }
    return 1;
  }
  static gicodec_status write(void* self, const void* from, std::size_t size) {
    CFile& file = *static_cast<CFile*>(self);
    if (file.failure != GICODEC_OK) return file.failure;
    const auto* const at = static_cast<const std::uint8_t*>(from);
    file.bytes.insert(file.bytes.end(), at, at + size);
    return GICODEC_OK;
  }
  static gicodec_status read(void* self, void* into, std::size_t size, std::size_t* got) {
    CFile& file = *static_cast<CFile*>(self);
    if (file.failure != GICODEC_OK) return file.failure;
    *got = std::min(size, file.bytes.size() - file.position);
    std::memcpy(into, file.bytes.data() + file.position, *got);
    file.position += *got;
    return *got == size ? GICODEC_OK : GICODEC_END;
  }
  static gicodec_status seek(void* self, std::uint64_t offset) {
    static_cast<CFile*>(self)->position = static_cast<std::size_t>(offset);
    return GICODEC_OK;
  }
  static std::uint64_t size(void* self) { return static_cast<CFile*>(self)->bytes.size(); }

  [[nodiscard]] gicodec_sink sink() {
    auto out = sized<gicodec_sink>();
    out.self = this;
    out.write = write;
    return out;
  }
  [[nodiscard]] gicodec_source source(bool seeks) {
    auto out = sized<gicodec_source>();
    out.self = this;
    out.read = read;
    if (seeks) {
      out.seek = seek;
      out.size = size;
    }
    return out;
  }
};

/// Frames 10, 12, 14, ... of a volume of one texture.
struct CRecording {
  explicit CRecording(const gicodec_sink* sink) : desc(irradiance()), texture(desc) {
    volume = room(desc);
    container = made<OwnedContainer>([](auto out) { return gicodec_container_create(out); });
    EXPECT_EQ(gicodec_container_add_volume(container.get(), "room", volume.get()), GICODEC_OK);
    const auto geometry = geometry_of(desc);
    EXPECT_EQ(gicodec_container_set_geometry(container.get(), 0, &geometry), GICODEC_OK);
    EXPECT_EQ(gicodec_container_add_metadata(container.get(), GICODEC_METADATA_TEXTURE, 0, "note",
                                             "of a \"lamp\""),
              GICODEC_OK);
    EXPECT_EQ(gicodec_container_set_scene(container.get(), "villa", 99), GICODEC_OK);
    writer = made<OwnedWriter>(
        [&](auto out) { return gicodec_writer_create(sink, container.get(), out); });
    encoder = made<OwnedVolumeEncoder>(
        [&](auto out) { return gicodec_volume_encoder_create(volume.get(), nullptr, out); });
  }
  gicodec_status add(unsigned frame) {
    texture.paint(frame);
    const auto view = texture.const_view();
    EXPECT_EQ(
        gicodec_volume_encoder_encode(encoder.get(), &view, 1, GICODEC_SELECT_CHANGED, nullptr, 0),
        GICODEC_OK);
    states.push_back(texture.bytes);
    return again(frame);
  }
  gicodec_status again(unsigned frame) {
    std::size_t size = 0;
    const std::uint8_t* const packet = gicodec_volume_encoder_packet(encoder.get(), 0, &size);
    return gicodec_writer_add(writer.get(), 10 + 2 * frame, packet, size);
  }

  gicodec_texture_desc desc;
  CTexture texture;
  OwnedVolume volume;
  OwnedContainer container;
  OwnedWriter writer;
  OwnedVolumeEncoder encoder;
  std::vector<std::vector<std::uint8_t>> states;
};

TEST(CContainer, DistantSourcesAreToldWhatWillBeRead) {
  CFile file;
  const auto sink = file.sink();
  CRecording recording(&sink);
  for (unsigned frame = 0; frame < 5; ++frame) ASSERT_EQ(recording.add(frame), GICODEC_OK);
  ASSERT_EQ(gicodec_writer_finish(recording.writer.get()), GICODEC_OK);
  auto source = file.source(true);
  source.prefetch = CFile::prefetch;
  const auto player =
      made<OwnedPlayer>([&](auto out) { return gicodec_player_open(&source, nullptr, out); });
  ASSERT_TRUE(player);
  EXPECT_EQ(gicodec_player_seekable(player.get()), 1U);
  ASSERT_EQ(gicodec_player_seek(player.get(), 14), GICODEC_OK);
  const std::uint64_t before = file.prefetched;
  ASSERT_EQ(gicodec_player_next(player.get()), GICODEC_OK);
  EXPECT_GT(file.prefetched, before + 100);  // packets
  EXPECT_LE(file.prefetched, file.bytes.size());
  // A pipe cannot be sought.
  file.position = 0;
  const auto pipe = file.source(false);
  const auto other =
      made<OwnedPlayer>([&](auto out) { return gicodec_player_open(&pipe, nullptr, out); });
  ASSERT_TRUE(other);
  EXPECT_EQ(gicodec_player_seekable(other.get()), 0U);
}

TEST(CContainer, FramesComeBackInAnyOrder) {
  CRecording recording(nullptr);
  for (unsigned frame = 0; frame < 5; ++frame) ASSERT_EQ(recording.add(frame), GICODEC_OK);
  ASSERT_EQ(gicodec_writer_finish(recording.writer.get()), GICODEC_OK);
  EXPECT_EQ(recording.again(9), GICODEC_OUT_OF_ORDER);
  std::size_t size = 0;
  const std::uint8_t* const bytes = gicodec_writer_bytes(recording.writer.get(), &size);
  const auto player = made<OwnedPlayer>(
      [&](auto out) { return gicodec_player_open_memory(bytes, size, nullptr, out); });
  ASSERT_TRUE(player);
  const std::uint64_t* frames = nullptr;
  std::size_t count = 0;
  ASSERT_EQ(gicodec_player_frames(player.get(), &frames, &count), GICODEC_OK);
  EXPECT_EQ(std::vector<std::uint64_t>(frames, frames + count),
            (std::vector<std::uint64_t>{10, 12, 14, 16, 18}));
  CTexture texture(recording.desc);
  const auto view = texture.view();
  for (const unsigned frame : {4U, 0U, 3U, 1U}) {
    ASSERT_EQ(gicodec_player_seek(player.get(), 10 + 2 * frame), GICODEC_OK);
    ASSERT_EQ(gicodec_player_next(player.get()), GICODEC_OK);
    EXPECT_EQ(gicodec_player_frame(player.get()), 10 + 2 * frame);
    ASSERT_EQ(gicodec_player_read(player.get(), 0, &view), GICODEC_OK);
    EXPECT_EQ(texture.bytes, recording.states[frame]);
    (void)gicodec_player_changed(player.get(), 0, &count);
    EXPECT_EQ(count, 24U);
  }
  ASSERT_EQ(gicodec_player_next(player.get()), GICODEC_OK);
  ASSERT_EQ(gicodec_player_read_changed(player.get(), 0, &view), GICODEC_OK);
  EXPECT_EQ(texture.bytes, recording.states[2]);
  EXPECT_EQ(gicodec_player_seek(player.get(), 11), GICODEC_UNKNOWN_FRAME);
  EXPECT_EQ(gicodec_player_read(player.get(), 1, &view), GICODEC_UNKNOWN_TEXTURE);
}

TEST(CContainer, DescriptionsComeBack) {
  CRecording recording(nullptr);
  ASSERT_EQ(recording.add(0), GICODEC_OK);
  std::size_t size = 0;
  const std::uint8_t* const bytes = gicodec_writer_bytes(recording.writer.get(), &size);
  const auto player = made<OwnedPlayer>(
      [&](auto out) { return gicodec_player_open_memory(bytes, size, nullptr, out); });
  ASSERT_TRUE(player);
  const gicodec_container* const container = gicodec_player_container(player.get());
  EXPECT_EQ(gicodec_container_volumes(container), 1U);
  EXPECT_EQ(gicodec_container_textures(container), 1U);
  EXPECT_STREQ(gicodec_container_volume_name(container, 0), "room");
  EXPECT_STREQ(gicodec_container_texture_name(container, 0), "color");
  EXPECT_EQ(gicodec_container_largest_error(container, 0), 0);
  std::uint64_t geometry_of_scene = 0;
  EXPECT_STREQ(gicodec_container_scene(container, &geometry_of_scene), "villa");
  EXPECT_EQ(geometry_of_scene, 99U);
  auto desc = sized<gicodec_texture_desc>();
  std::uint32_t volume = 7;
  ASSERT_EQ(gicodec_container_texture(container, 0, &desc, &volume), GICODEC_OK);
  EXPECT_EQ(std::memcmp(&desc, &recording.desc, sizeof desc), 0);
  EXPECT_EQ(volume, 0U);
  auto geometry = sized<gicodec_geometry>();
  ASSERT_EQ(gicodec_container_geometry(container, 0, &geometry), GICODEC_OK);
  EXPECT_EQ(geometry.grid[1], 3U);
  ASSERT_EQ(gicodec_container_metadata_count(container, GICODEC_METADATA_TEXTURE, 0), 1U);
  EXPECT_STREQ(gicodec_container_metadata_name(container, GICODEC_METADATA_TEXTURE, 0, 0), "note");
  EXPECT_STREQ(gicodec_container_metadata_value(container, GICODEC_METADATA_TEXTURE, 0, 0, &size),
               "of a \"lamp\"");
  EXPECT_EQ(gicodec_container_metadata_name(container, GICODEC_METADATA_TEXTURE, 0, 1), nullptr);
  const auto copy =
      made<OwnedVolume>([&](auto out) { return gicodec_container_volume(container, 0, out); });
  EXPECT_EQ(gicodec_volume_desc_textures(copy.get()), 1U);
  (void)gicodec_container_json(container, nullptr, 0, &size);
  std::vector<char> json(size);
  ASSERT_EQ(gicodec_container_json(container, json.data(), size, &size), GICODEC_OK);
  EXPECT_NE(std::strstr(json.data(), R"(["note","of a \"lamp\""])"), nullptr) << json.data();
  EXPECT_NE(std::strstr(json.data(), R"("spacing":[1,1,1],"scroll":[0,0,0])"), nullptr);
}

TEST(CContainer, CallersFunctions) {
  CFile file;
  const auto sink = file.sink();
  CRecording recording(&sink);
  ASSERT_TRUE(recording.writer);
  ASSERT_EQ(recording.add(0), GICODEC_OK);
  const std::size_t before = file.bytes.size();
  file.failure = GICODEC_CANCELLED;
  EXPECT_EQ(recording.add(1), GICODEC_CANCELLED);
  file.failure = 7;  // A number that this library does not know.
  EXPECT_EQ(recording.again(1), GICODEC_IO_FAILED);
  file.failure = GICODEC_OK;
  EXPECT_EQ(file.bytes.size(), before);
  EXPECT_EQ(recording.again(1), GICODEC_OK);
  ASSERT_EQ(gicodec_writer_finish(recording.writer.get()), GICODEC_OK);

  CTexture texture(recording.desc);
  const auto view = texture.view();
  for (const bool seeks : {false, true}) {
    file.position = 0;
    const auto source = file.source(seeks);
    const auto player =
        made<OwnedPlayer>([&](auto out) { return gicodec_player_open(&source, nullptr, out); });
    ASSERT_TRUE(player);
    for (unsigned frame = 0; frame < 2; ++frame) {
      ASSERT_EQ(gicodec_player_next(player.get()), GICODEC_OK);
      ASSERT_EQ(gicodec_player_read(player.get(), 0, &view), GICODEC_OK);
      EXPECT_EQ(texture.bytes, recording.states[frame]);
    }
    EXPECT_EQ(gicodec_player_next(player.get()), GICODEC_END);
    EXPECT_EQ(gicodec_player_seek(player.get(), 10), seeks ? GICODEC_OK : GICODEC_UNKNOWN_FRAME);
    file.failure = GICODEC_IO_FAILED;
    EXPECT_NE(gicodec_player_next(player.get()), GICODEC_OK);
    file.failure = GICODEC_OK;
  }
  file.bytes.resize(file.bytes.size() / 2);
  file.position = 0;
  const auto source = file.source(true);
  gicodec_player* player = nullptr;
  const gicodec_status status = gicodec_player_open(&source, nullptr, &player);
  if (status == GICODEC_OK) {
    gicodec_status last = GICODEC_OK;
    while (last == GICODEC_OK) last = gicodec_player_next(player);
    EXPECT_EQ(last, GICODEC_TRUNCATED);
  }
  gicodec_player_destroy(player);
}

TEST(CContainer, JsonNamesEveryFloat) {
  CRecording recording(nullptr);
  std::vector<float> values{0.F,    -0.F,      0.1F,          1.F / 3, 16777216.F, 123456792.F,
                            1e-45F, 1.17e-38F, 3.4028235e38F, 1e-5F,   0.00012F,   -2.5e12F};
  std::minstd_rand random(11);
  while (values.size() < 3000) {
    const float value =
        std::bit_cast<float>(static_cast<std::uint32_t>(random() * 2 + random() % 2));
    if (std::isfinite(value)) values.push_back(value);
  }
  auto geometry = geometry_of(recording.desc);
  for (std::size_t i = 0; i < values.size(); i += 3) {
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(i), 3, geometry.origin);
    ASSERT_EQ(gicodec_container_set_geometry(recording.container.get(), 0, &geometry), GICODEC_OK);
    std::vector<char> json(4096);
    std::size_t size = 0;
    ASSERT_EQ(gicodec_container_json(recording.container.get(), json.data(), json.size(), &size),
              GICODEC_OK);
    const char* at = std::strstr(json.data(), R"("origin":[)") + 9;
    for (const float value : geometry.origin) {
      char* end = nullptr;
      EXPECT_EQ(std::bit_cast<std::uint32_t>(std::strtof(at + 1, &end)),
                std::bit_cast<std::uint32_t>(value))
          << std::string_view(at, 40);
      at = end;
    }
  }
}

TEST(CContainer, AFrameOfAGrowingFileWaitsForItsEnd) {
  CFile file;
  const auto sink = file.sink();
  CRecording recording(&sink);
  ASSERT_EQ(recording.add(0), GICODEC_OK);
  ASSERT_EQ(recording.add(1), GICODEC_OK);
  const auto source = file.source(true);
  const auto player =
      made<OwnedPlayer>([&](auto out) { return gicodec_player_open(&source, nullptr, out); });
  ASSERT_TRUE(player);
  ASSERT_EQ(gicodec_player_set_growing(player.get(), 1), GICODEC_OK);
  EXPECT_EQ(gicodec_player_next(player.get()), GICODEC_OK);
  EXPECT_EQ(gicodec_player_next(player.get()), GICODEC_TRUNCATED);
  EXPECT_EQ(gicodec_player_next(player.get()), GICODEC_TRUNCATED);
  ASSERT_EQ(gicodec_player_set_growing(player.get(), 0), GICODEC_OK);
  EXPECT_EQ(gicodec_player_next(player.get()), GICODEC_OK);
  EXPECT_EQ(gicodec_player_frame(player.get()), 12U);
  EXPECT_EQ(gicodec_player_next(player.get()), GICODEC_TRUNCATED);
}

TEST(CContainer, BytesAreTakenInPieces) {
  CRecording whole(nullptr), pieces(nullptr);
  std::vector<std::uint8_t> taken;
  const auto take = [&] {
    std::size_t size = 0;
    const std::uint8_t* const bytes = gicodec_writer_bytes(pieces.writer.get(), &size);
    taken.insert(taken.end(), bytes, bytes + size);
    ASSERT_EQ(gicodec_writer_take(pieces.writer.get()), GICODEC_OK);
  };
  for (unsigned frame = 0; frame < 4; ++frame) {
    ASSERT_EQ(whole.add(frame), GICODEC_OK);
    ASSERT_EQ(pieces.add(frame), GICODEC_OK);
    if (frame == 2) {
      ASSERT_EQ(gicodec_writer_flush(whole.writer.get()), GICODEC_OK);
      ASSERT_EQ(gicodec_writer_flush(pieces.writer.get()), GICODEC_OK);
    }
    take();
  }
  ASSERT_EQ(gicodec_writer_finish(whole.writer.get()), GICODEC_OK);
  ASSERT_EQ(gicodec_writer_finish(pieces.writer.get()), GICODEC_OK);
  take();
  std::size_t size = 0;
  const std::uint8_t* const bytes = gicodec_writer_bytes(whole.writer.get(), &size);
  EXPECT_EQ(taken, std::vector<std::uint8_t>(bytes, bytes + size));
}

TEST(CContainer, SelectionsAndLayouts) {
  auto first = irradiance(), second = irradiance();
  const auto volume = room(first);
  ASSERT_EQ(gicodec_volume_desc_add_texture(volume.get(), "other", &second), GICODEC_OK);
  const auto container =
      made<OwnedContainer>([](auto out) { return gicodec_container_create(out); });
  ASSERT_EQ(gicodec_container_add_volume(container.get(), "room", volume.get()), GICODEC_OK);
  const auto writer = made<OwnedWriter>(
      [&](auto out) { return gicodec_writer_create(nullptr, container.get(), out); });
  const auto encoder = made<OwnedVolumeEncoder>(
      [&](auto out) { return gicodec_volume_encoder_create(volume.get(), nullptr, out); });
  CTexture one(first), two(second);
  one.paint(1);
  two.paint(2);
  const gicodec_const_view views[] = {one.const_view(), two.const_view()};
  ASSERT_EQ(gicodec_volume_encoder_encode(encoder.get(), views, 2, GICODEC_SELECT_ALL, nullptr, 0),
            GICODEC_OK);
  std::size_t size = 0;
  for (std::uint32_t p = 0; p < 2; ++p) {
    const std::uint8_t* const packet = gicodec_volume_encoder_packet(encoder.get(), p, &size);
    ASSERT_EQ(gicodec_writer_add(writer.get(), 0, packet, size), GICODEC_OK);
  }
  const std::uint8_t* const bytes = gicodec_writer_bytes(writer.get(), &size);
  const auto player = made<OwnedPlayer>(
      [&](auto out) { return gicodec_player_open_memory(bytes, size, nullptr, out); });
  const std::uint32_t wanted[] = {1}, beyond[] = {2}, far[] = {256};
  EXPECT_EQ(gicodec_player_select(player.get(), beyond, 1), GICODEC_UNKNOWN_TEXTURE);
  EXPECT_EQ(gicodec_player_select(player.get(), far, 1), GICODEC_UNKNOWN_TEXTURE);
  ASSERT_EQ(gicodec_player_select(player.get(), wanted, 1), GICODEC_OK);
  auto layout = second;
  layout.tiling = GICODEC_TILING_SLICES_XZ_Y;
  ASSERT_EQ(gicodec_player_set_layout(player.get(), 1, &layout), GICODEC_OK);
  // The file is not finished.
  ASSERT_EQ(gicodec_player_next(player.get()), GICODEC_OK);
  EXPECT_EQ(gicodec_player_select(player.get(), wanted, 1), GICODEC_OUT_OF_ORDER);
  EXPECT_EQ(gicodec_player_set_layout(player.get(), 1, &layout), GICODEC_OUT_OF_ORDER);
  auto told = sized<gicodec_texture_desc>();
  ASSERT_EQ(gicodec_container_texture(gicodec_player_container(player.get()), 1, &told, nullptr),
            GICODEC_OK);
  CTexture out(layout), unselected(first);
  const auto view = out.view(), empty = unselected.view();
  ASSERT_EQ(gicodec_player_read(player.get(), 1, &view), GICODEC_OK);
  ASSERT_EQ(gicodec_player_read(player.get(), 0, &empty), GICODEC_OK);
  EXPECT_TRUE(std::ranges::all_of(unselected.bytes, [](auto byte) { return byte == 0; }));
  std::uint64_t from[4], to[4];
  for (std::uint32_t block = 0; block < out.blocks; ++block) {
    ASSERT_EQ(gicodec_texture_desc_origin(&second, block, from), GICODEC_OK);
    ASSERT_EQ(gicodec_texture_desc_origin(&layout, block, to), GICODEC_OK);
    const std::size_t width = 4 * 3 * 10, wide = 4 * 10, slice = wide * 2 * 10;
    EXPECT_EQ(std::memcmp(&two.bytes[(from[1] * width + from[0]) * 4],
                          &out.bytes[(to[2] * slice + to[1] * wide + to[0]) * 4], 40),
              0);
  }
}

}  // namespace
}  // namespace gicodec
