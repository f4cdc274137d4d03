// Containers of every kind, whole and cut into regions, played: forward, from any frame on, some of
// the textures, and what is damaged.
#include "container_support.h"
#include "payload_conformance.h"
#include "session/server/distributor.h"

#include <gicodec/encoder.h>
#include <gicodec/player.h>
#include <gicodec/textures.h>

#include "texture/copy_block.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

namespace gicodec {
namespace {

using namespace test;

/// What a server sent a client that sees everything, as a container, and what was published.
struct Recorded {
  Bytes bytes;
  std::vector<std::uint64_t> frames;
  std::vector<Contents> contents;  ///< by frame
};

constexpr const Kind* kKinds[] = {&kScenes};

Recorded record(const VolumeDesc& volume, Delivery delivery, Generator& random) {
  constexpr Grid kRegion{2, 2, 1};
  auto distributor = *Distributor::create({.backend = "lz4", .region = kRegion});
  const auto textures = textures_of(volume);
  EXPECT_TRUE(distributor.add_volume(volume, {textures[0]->desc.grid}).ok());
  ClientId client = 0;
  const auto join = [&] {
    client = *distributor.connect(delivery);
    for (std::uint8_t group = 0; group < volume.groups.size(); ++group) {
      const BlockMask all(block_count(volume.groups[group].textures[0].desc), 1);
      EXPECT_EQ(distributor.set_visible(client, 0, all, group), Status::ok);
    }
  };
  join();
  ContainerDescription description;
  EXPECT_EQ(add_volume(description, "volume", volume, kKinds), Status::ok);
  if (delivery == Delivery::shared) description.volumes[0].region = kRegion;
  MemorySink sink;
  auto writer = *ContainerWriter::create(sink, description, kKinds);
  Recorded recorded;
  Contents contents = blank(volume);
  for (std::uint64_t frame = 3; frame < 20; frame += 1 + random() % 3) {
    change(volume, contents, random);
    for (std::uint8_t t = 0; t < textures.size(); ++t) {
      const ConstTextureView view(contents[t]);
      EXPECT_EQ(distributor.publish(0, t, view), Status::ok);
    }
    if (delivery == Delivery::unicast && random() % 4 == 0) {  // Keyframes in between.
      EXPECT_EQ(distributor.disconnect(client), Status::ok);
      join();
    }
    EXPECT_EQ(distributor.update(), Status::ok);
    bool some = false;
    for (const OutgoingPacket& packet : distributor.packets(client)) {
      EXPECT_EQ(writer.add(frame, *packet.packet, packet.stream.region), Status::ok);
      some = true;
    }
    if (!some) continue;
    recorded.frames.push_back(frame);
    recorded.contents.push_back(contents);
  }
  EXPECT_EQ(writer.finish(), Status::ok);
  recorded.bytes = std::move(sink.bytes);
  return recorded;
}

/// The player's textures, as a client would show them.
ClientVolume shown_by(const ContainerPlayer& player, const VolumeDesc& volume) {
  ClientVolume shown;
  for (const NamedTexture* texture : textures_of(volume)) {
    const auto id = static_cast<std::uint8_t>(shown.textures.size());
    ClientTexture& made = shown.textures.emplace_back();
    made.desc = texture->desc;
    made.texels.resize(static_cast<std::size_t>(texture_bytes(texture->desc)));
    made.changed.assign(block_count(texture->desc), 1);
    EXPECT_EQ(player.read(id, TextureView{made.texels}), Status::ok);
  }
  return shown;
}

class PlayerOfKinds : public testing::TestWithParam<Delivery> {};

TEST_P(PlayerOfKinds, PlaysWhatWasPublished) {
  Generator random(7);
  for (const Row& row : payload_rows()) {
    SCOPED_TRACE(row.name);
    const Recorded recorded = record(row.volume, GetParam(), random);
    MemorySource source(recorded.bytes);
    auto player = ContainerPlayer::open(source, {.kinds = {&kScenes}});
    ASSERT_TRUE(player.ok());
    // Textures that are brought up to date by what changed.
    Contents followed = blank(row.volume);
    const auto follow = [&] {
      ClientVolume shown = shown_by(*player, row.volume);
      for (std::uint8_t t = 0; t < followed.size(); ++t) {
        ASSERT_EQ(player->read_changed(t, TextureView{followed[t]}), Status::ok);
        ASSERT_EQ(followed[t], shown.textures[t].texels);
      }
    };
    for (std::size_t i = 0; i < recorded.frames.size(); ++i) {
      ASSERT_EQ(player->next(), Status::ok);
      EXPECT_EQ(player->frame(), recorded.frames[i]);
      EXPECT_EQ(compare(row.volume, recorded.contents[i], shown_by(*player, row.volume)), "");
      follow();
    }
    EXPECT_EQ(player->next(), Status::end);
    EXPECT_TRUE(player->finished());
    ASSERT_TRUE(player->seekable());
    for (int tries = 0; tries < 20; ++tries) {
      const std::size_t i = random() % recorded.frames.size();
      ASSERT_EQ(player->seek(recorded.frames[i]), Status::ok);
      ASSERT_EQ(player->next(), Status::ok);
      EXPECT_EQ(player->frame(), recorded.frames[i]);
      EXPECT_EQ(compare(row.volume, recorded.contents[i], shown_by(*player, row.volume)), "");
      follow();
      if (i + 1 == recorded.frames.size()) continue;
      ASSERT_EQ(player->next(), Status::ok);
      EXPECT_EQ(compare(row.volume, recorded.contents[i + 1], shown_by(*player, row.volume)), "");
      follow();
    }
    EXPECT_EQ(player->seek(1000), Status::unknown_frame);
  }
}

// However the bytes arrive, no frame is ended before all its packets are there.
TEST_P(PlayerOfKinds, PlaysWhileTheFileGrows) {
  Generator random(9);
  for (const Row& row : payload_rows()) {
    SCOPED_TRACE(row.name);
    const Recorded recorded = record(row.volume, GetParam(), random);
    GrowingSource source(recorded.bytes, 0);
    std::optional<ContainerPlayer> player;
    std::size_t played = 0;
    Status status = Status::ok;
    for (; status != Status::end; source.visible += 1 + random() % 60) {
      source.visible = std::min(source.visible, recorded.bytes.size());
      if (!player) {
        ASSERT_EQ(source.seek(0), Status::ok);
        auto opened = ContainerPlayer::open(source, {.kinds = {&kScenes}});
        if (opened.status() == Status::truncated) continue;
        ASSERT_TRUE(opened.ok());
        player.emplace(*std::move(opened));
        player->set_growing(true);
      }
      while ((status = player->next()) == Status::ok) {
        ASSERT_LT(played, recorded.frames.size());
        EXPECT_EQ(player->frame(), recorded.frames[played]);
        EXPECT_EQ(compare(row.volume, recorded.contents[played], shown_by(*player, row.volume)),
                  "");
        ++played;
      }
      ASSERT_TRUE(status == Status::truncated || status == Status::end) << status;
    }
    EXPECT_EQ(played, recorded.frames.size());
  }
}

TEST_P(PlayerOfKinds, SurvivesDamage) {
  Generator random(8);
  const VolumeDesc volume = payload_rows().front().volume;
  const Recorded recorded = record(volume, GetParam(), random);
  for (std::size_t cut = 0; cut < recorded.bytes.size(); cut += 1 + random() % 40) {
    const Exact prefix(std::span(recorded.bytes).first(cut));
    MemorySource source(prefix.span());
    auto player = ContainerPlayer::open(source, {.kinds = {&kScenes}});
    if (!player) continue;
    Status status = Status::ok;
    while (status == Status::ok) status = player->next();
    EXPECT_EQ(status, Status::truncated);
  }
  for (int flips = 0; flips < 300; ++flips) {
    const Bytes flipped = flip_bit(recorded.bytes, random() % (8 * recorded.bytes.size()));
    MemorySource source(flipped);
    auto player = ContainerPlayer::open(source, {.kinds = {&kScenes}});
    for (int frames = 0; player.ok() && frames < 40; ++frames) {
      const Status status = player->next();
      if (status == Status::end || status == Status::truncated) break;
      static_cast<void>(shown_by(*player, volume));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Deliveries, PlayerOfKinds,
                         testing::Values(Delivery::unicast, Delivery::shared));

TEST(ContainerPlayer, PlaysSomeTextures) {
  Generator random(9);
  const VolumeDesc volume = payload_rows().front().volume;
  const auto textures = textures_of(volume);
  ASSERT_GT(textures.size(), 1U);
  const Recorded recorded = record(volume, Delivery::shared, random);
  MemorySource source(recorded.bytes);
  auto player = ContainerPlayer::open(source, {.kinds = {&kScenes}});
  ASSERT_TRUE(player.ok());
  const std::uint8_t none[] = {200}, second[] = {1};
  EXPECT_EQ(player->select(none), Status::unknown_texture);
  ASSERT_EQ(player->select(second), Status::ok);
  while (player->next() == Status::ok) EXPECT_TRUE(player->changed(0).empty());
  const ClientVolume shown = shown_by(*player, volume);
  EXPECT_TRUE(
      std::ranges::all_of(shown.textures[0].texels, [](std::byte b) { return b == std::byte{}; }));
  EXPECT_FALSE(
      std::ranges::all_of(shown.textures[1].texels, [](std::byte b) { return b == std::byte{}; }));
}

/// A texture of little blocks, every block in a region of its own.
struct ManyRegions {
  TextureDesc desc = probe_texture(Format::R8G8B8A8_UNORM, {70, 50, 20}, 1, 0);
  Bytes bytes;

  explicit ManyRegions(std::uint32_t packets, std::uint64_t frames = 1) {
    ContainerDescription description =
        probe_description(std::vector<ProbeTexture>{{"t", desc}, {"u", desc}});
    description.volumes[0].region = {1, 1, 1};
    const TextureDesc part = region_texture(desc, {1, 1, 1}, 0);
    MemorySink sink;
    auto writer = *ContainerWriter::create(sink, description);
    for (std::uint64_t frame = 0; frame < frames; ++frame) {
      for (std::uint8_t texture = 0; texture < 2; ++texture) {
        EncoderOptions options;
        options.texture_id = texture;
        auto encoder = *Encoder::create(part, options);
        const Bytes texels(4, static_cast<std::byte>(1 + frame));
        const Packet packet = *encoder.encode(ConstTextureView(texels));
        for (std::uint32_t region = 0; region < packets; ++region) {
          EXPECT_EQ(writer.add(frame, packet, region), Status::ok);
        }
      }
    }
    EXPECT_EQ(writer.finish(), Status::ok);
    bytes = std::move(sink.bytes);
  }
};

TEST(ContainerPlayer, PlaysOneTextureOfVeryManyRegions) {
  const ManyRegions many(300);
  ASSERT_GT(block_count(many.desc), 65536U);
  MemorySource source(many.bytes);
  auto player = *ContainerPlayer::open(source);
  const std::uint8_t second[] = {1};
  ASSERT_EQ(player.select(second), Status::ok);
  ASSERT_EQ(player.next(), Status::ok);
  EXPECT_TRUE(player.changed(0).empty());
  EXPECT_EQ(player.changed(1).size(), 300U);
  EXPECT_EQ(player.packets().size(), 300U);
  Bytes read(static_cast<std::size_t>(texture_bytes(many.desc)), std::byte{9}), followed(read);
  ASSERT_EQ(player.read(1, TextureView{read}), Status::ok);
  EXPECT_EQ(std::ranges::count(read, std::byte{1}), 4 * 300);
  EXPECT_EQ(std::ranges::count(read, std::byte{0}), std::ssize(read) - 4 * 300);
  ASSERT_EQ(player.read_changed(1, TextureView{followed}), Status::ok);
  EXPECT_EQ(std::ranges::count(followed, std::byte{1}), 4 * 300);
  EXPECT_EQ(std::ranges::count(followed, std::byte{9}), std::ssize(read) - 4 * 300);
  EXPECT_EQ(player.next(), Status::end);
}

TEST(ContainerPlayer, SkipsFrames) {
  Generator random(11);
  const VolumeDesc volume = payload_rows().front().volume;
  const Recorded recorded = record(volume, Delivery::unicast, random);
  MemorySource source(recorded.bytes), beside(recorded.bytes);
  auto player = *ContainerPlayer::open(source);
  auto reader = *ContainerReader::open(beside);
  ContainerPacket expected;
  ASSERT_EQ(reader.next(expected), Status::ok);
  for (const std::uint64_t frame : recorded.frames) {
    ASSERT_EQ(player.skip(), Status::ok);
    EXPECT_EQ(player.frame(), frame);
    ASSERT_FALSE(player.packets().empty());
    for (const ContainerPacket& packet : player.packets()) {
      EXPECT_EQ(packet.frame, frame);
      EXPECT_EQ(packet.texture_id, expected.texture_id);
      EXPECT_EQ(packet.bytes, expected.bytes);
      if (reader.next(expected) != Status::ok) expected = {};
    }
    EXPECT_TRUE(player.changed(0).empty());
  }
  EXPECT_EQ(player.memory(), 0U);
  EXPECT_EQ(player.skip(), Status::end);
}

/// A little texture, and packets of two frames of it, the second of which builds on the first.
struct TwoFrames {
  TextureDesc desc = probe_texture(Format::R8G8B8A8_UNORM, {2, 2, 2}, 4, 1);
  ContainerDescription description = probe_description(std::vector<ProbeTexture>{{"t", desc}});
  Packet first, second;

  TwoFrames() {
    Bytes texels(static_cast<std::size_t>(texture_bytes(desc)));
    auto encoder = *Encoder::create(desc, {});
    first = *encoder.encode(ConstTextureView(texels));
    texels.assign(texels.size(), std::byte{1});
    second = *encoder.encode(ConstTextureView(texels));
  }
  /// A container of them with these frame numbers.
  [[nodiscard]] Bytes container(std::span<const std::uint64_t> frames) const {
    Bytes bytes = head_of(description);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const Packet& packet = i == 0 ? first : second;
      bytes = bytes + packet_entry({frames[i], kWhole, 0, i == 0, {packet.begin(), packet.end()}});
    }
    return bytes;
  }
};

TEST(ContainerPlayer, WhatBuildsOnASkippedFrameIsNotShown) {
  const std::uint64_t frames[] = {3, 4};
  const Bytes bytes = TwoFrames().container(frames);
  MemorySource source(bytes);
  auto player = *ContainerPlayer::open(source);
  ASSERT_EQ(player.skip(), Status::ok);
  EXPECT_EQ(player.next(), Status::reference_missing);
  EXPECT_EQ(player.where().frame, 4U);
  EXPECT_EQ(player.where().part, TextureRegion{});
  EXPECT_EQ(player.next(), Status::ok);  // The rest of that frame.
  EXPECT_EQ(player.next(), Status::truncated);
  EXPECT_FALSE(player.where().part);
}

TEST(ContainerPlayer, ViewsLieAsTheyAreTold) {
  Generator random(12);
  for (const Delivery delivery : {Delivery::unicast, Delivery::shared}) {
    const VolumeDesc volume = payload_rows().front().volume;
    const Recorded recorded = record(volume, delivery, random);
    MemorySource source(recorded.bytes);
    auto player = *ContainerPlayer::open(source);
    const TextureDesc told = textures_of(volume)[0]->desc;
    TextureDesc other = told;
    other.layout = told.layout.tiling == Tiling::blocks ? Tiling::atlas_xy_z : Tiling::blocks;
    EXPECT_EQ(player.set_layout(200, other.layout), Status::unknown_texture);
    EXPECT_EQ(player.set_layout(0, static_cast<Tiling>(99)), Status::invalid_description);
    ASSERT_EQ(player.set_layout(0, other.layout), Status::ok);
    while (player.next() == Status::ok) continue;
    EXPECT_EQ(player.set_layout(0, told.layout), Status::out_of_order);
    Bytes texels(static_cast<std::size_t>(texture_bytes(other)));
    ASSERT_EQ(player.read(0, TextureView{texels}), Status::ok);
    Bytes back(static_cast<std::size_t>(texture_bytes(told)));
    const auto from = check_view(other, ConstTextureView(texels));
    const auto to = check_view(told, TextureView{back});
    for (std::uint32_t block = 0; block < block_count(told); ++block) {
      copy_block(other, *from, block, told, *to, block);
    }
    EXPECT_EQ(back, recorded.contents.back()[0]);
  }
}

TEST(ContainerPlayer, DamageIsToldAfterWhatComesBefore) {
  Generator random(13);
  const VolumeDesc volume = payload_rows().front().volume;
  const Recorded recorded = record(volume, Delivery::unicast, random);
  std::size_t damaged = 0;
  for (std::size_t bit = 0; bit < 8 * recorded.bytes.size(); bit += 101) {
    const Bytes flipped = flip_bit(recorded.bytes, bit);
    PipeSource source(flipped);  // It has no index to look into.
    auto player = ContainerPlayer::open(source);
    if (!player) continue;
    std::size_t frames = 0;
    Status status = Status::ok;
    for (; (status = player->next()) == Status::ok; ++frames) {
      ASSERT_EQ(player->frame(), recorded.frames[frames]);
    }
    if (status == Status::end || player->where().part) continue;
    ++damaged;
    EXPECT_EQ(player->where().frame, frames == 0 ? 0 : recorded.frames[frames - 1]);
    EXPECT_EQ(player->next(), Status::end);
  }
  EXPECT_GT(damaged, 10U);
}

TEST(ContainerPlayer, ASecondPacketInAFrameIsRefused) {
  const std::uint64_t frames[] = {3, 3, 4};
  const Bytes bytes = TwoFrames().container(frames);
  MemorySource source(bytes);
  auto player = *ContainerPlayer::open(source);
  EXPECT_EQ(player.next(), Status::corrupt);
  EXPECT_EQ(player.where().frame, 3U);
  EXPECT_EQ(player.where().part, TextureRegion{});
  EXPECT_EQ(player.next(), Status::ok);  // The rest of that frame.
  EXPECT_EQ(player.frame(), 3U);
  EXPECT_TRUE(player.packets().empty());
  EXPECT_EQ(player.next(), Status::reference_missing);
  EXPECT_EQ(player.frame(), 4U);
}

TEST(ContainerPlayer, PacketsOfAFrameKeepToTheLimit) {
  const ManyRegions many(2000);
  PlayerOptions options;
  options.limits.max_total_bytes = 30000;
  MemorySource source(many.bytes);
  auto player = *ContainerPlayer::open(source, options);
  EXPECT_EQ(player.skip(), Status::limit_exceeded);
  EXPECT_GT(player.where().memory, 30000U);
  EXPECT_EQ(player.where().part->texture_id, 0);
  EXPECT_EQ(player.memory(), 0U);
}

TEST(ContainerPlayer, MisuseIsNamed) {
  Generator random(10);
  const VolumeDesc volume = payload_rows().front().volume;
  const Recorded recorded = record(volume, Delivery::unicast, random);
  const auto open = [&](PlayerOptions options) {
    static std::vector<std::unique_ptr<MemorySource>> sources;
    sources.push_back(std::make_unique<MemorySource>(recorded.bytes));
    options.kinds = {&kScenes};
    return ContainerPlayer::open(*sources.back(), options);
  };
  EXPECT_EQ(open({.threads = 0}).status(), Status::invalid_settings);
  auto player = open({});
  ASSERT_TRUE(player.ok());
  Bytes texels(10);
  EXPECT_EQ(player->read(200, TextureView{texels}), Status::unknown_texture);
  EXPECT_EQ(player->read_changed(200, TextureView{texels}), Status::unknown_texture);
  EXPECT_EQ(player->read(0, TextureView{texels}), Status::view_too_small);
  auto strict = open({.limits = {.max_total_bytes = 1000}});
  ASSERT_TRUE(strict.ok());
  EXPECT_EQ(strict->next(), Status::limit_exceeded);
  EXPECT_EQ(strict->where().frame, recorded.frames[0]);
  // Of a kind that is not known nothing can be shown, but all is checked.
  const auto all = payload_rows();
  const auto is_strange = [](const Row& row) { return row.volume.kind == kKindScenes; };
  const auto strange = std::ranges::find_if(all, is_strange);
  ASSERT_NE(strange, all.end());
  const Recorded other = record(strange->volume, Delivery::shared, random);
  MemorySource source(other.bytes);
  auto ignorant = ContainerPlayer::open(source);
  ASSERT_TRUE(ignorant.ok());
  Status status = Status::ok;
  while (status == Status::ok) status = ignorant->next();
  EXPECT_EQ(status, Status::end);
  EXPECT_EQ(ignorant->read(0, TextureView{texels}), Status::unknown_texture);
}

/// What says which records exist may have a later keyframe than what goes by it.
TEST(ContainerPlayer, SeeksToWhatKeyframesGoBy) {
  const auto all = payload_rows();
  const auto has_counts = [](const Row& row) {
    const TextureGroup& group = row.volume.groups.front();
    return group.presence == 0 && group.textures.size() > 1 &&
           group.textures[1].desc.presence != Presence::all;
  };
  const auto row = std::ranges::find_if(all, has_counts);
  ASSERT_NE(row, all.end());
  Generator random(14);
  const VolumeDesc& volume = row->volume;
  const auto textures = textures_of(volume);
  ContainerDescription description;
  ASSERT_EQ(add_volume(description, "volume", volume, kKinds), Status::ok);
  MemorySink sink;
  auto writer = *ContainerWriter::create(sink, description, kKinds);
  std::vector<Encoder> encoders;
  for (std::uint8_t t = 0; t < textures.size(); ++t) {
    encoders.push_back(*Encoder::create(textures[t]->desc, {.gop = 0, .texture_id = t}));
  }
  Contents contents = blank(volume);
  const std::size_t parts = volume.groups.front().textures.size();
  for (std::uint64_t frame = 0; frame < 4; ++frame) {
    change(volume, contents, random);
    if (frame == 2) encoders[0].request_keyframe();
    for (std::size_t t = 0; t < parts; ++t) {
      if (textures[t]->desc.presence != Presence::all) {
        ASSERT_EQ(encoders[t].set_presence(contents[0]), Status::ok);
      }
      const auto packet = encoders[t].encode(ConstTextureView(contents[t]), Selection::all());
      ASSERT_TRUE(packet.ok());
      ASSERT_EQ(writer.add(frame, *packet), Status::ok);
    }
  }
  ASSERT_EQ(writer.finish(), Status::ok);
  MemorySource source(sink.bytes), again(sink.bytes);
  PlayerOptions options;
  options.kinds = {&kScenes};
  auto player = *ContainerPlayer::open(source, options);
  ASSERT_EQ(player.seek(3), Status::ok);
  ASSERT_EQ(player.next(), Status::ok);
  auto in_order = *ContainerPlayer::open(again, options);
  for (int frame = 0; frame < 4; ++frame) ASSERT_EQ(in_order.next(), Status::ok);
  for (std::uint8_t t = 0; t < parts; ++t) {
    Bytes sought(contents[t].size()), played(contents[t].size());
    ASSERT_EQ(player.read(t, TextureView{sought}), Status::ok);
    ASSERT_EQ(in_order.read(t, TextureView{played}), Status::ok);
    EXPECT_EQ(sought, played) << "texture " << int{t};
  }
}

/// Who reads over a network pays for each byte.
TEST(ContainerPlayer, AFrameCostsItsOwnBytes) {
  const TextureDesc desc = map_texture(Format::R8_UINT, {256, 256, 1}, {8, 8, 1});
  TextureGroup group;
  group.textures = {{"first", desc, {}, {}}, {"second", desc, {}, {}}};
  ContainerDescription description;
  ASSERT_EQ(add_volume(description, "volume", *texture_volume(std::span(&group, 1))), Status::ok);
  MemorySink sink;
  auto writer = *ContainerWriter::create(sink, description);
  Bytes texels(static_cast<std::size_t>(texture_bytes(desc)), std::byte{7});
  for (std::uint64_t frame = 0; frame < 4; ++frame) {
    for (std::uint8_t t = 0; t < 2; ++t) {
      auto encoder = *Encoder::create(desc, {.backend = "raw", .texture_id = t});
      ASSERT_EQ(writer.add(frame, *encoder.encode(ConstTextureView(texels))), Status::ok);
    }
  }
  ASSERT_EQ(writer.finish(), Status::ok);
  GrowingSource source(sink.bytes, sink.bytes.size());
  auto player = *ContainerPlayer::open(source);
  EXPECT_LT(source.read_bytes, texels.size());
  for (const std::uint64_t frame : {2, 1, 3}) {
    ASSERT_EQ(player.seek(frame), Status::ok);
    source.read_bytes = 0;
    ASSERT_EQ(player.next(), Status::ok);
    EXPECT_EQ(player.packets().size(), 2U);
    EXPECT_LT(source.read_bytes, 2 * texels.size() + 1000) << "frame " << frame;
  }
  ASSERT_EQ(player.seek(0), Status::ok);
  source.read_bytes = 0;
  for (int frame = 0; frame < 4; ++frame) ASSERT_EQ(player.next(), Status::ok);
  EXPECT_EQ(player.next(), Status::end);
}

/// After seek() nothing is left of what came later.
TEST(ContainerPlayer, SeeksToBeforeATexture) {
  const TextureDesc desc = map_texture(Format::R8_UINT, {4, 4, 1}, {4, 4, 1});
  TextureGroup group;
  group.textures = {{"first", desc, {}, {}}, {"later", desc, {}, {}}};
  ContainerDescription description;
  ASSERT_EQ(add_volume(description, "volume", *texture_volume({&group, 1})), Status::ok);
  MemorySink sink;
  auto writer = *ContainerWriter::create(sink, description);
  auto first = *Encoder::create(desc, {.texture_id = 0}),
       later = *Encoder::create(desc, {.texture_id = 1});
  const Bytes sevens(16, std::byte{7});
  ASSERT_EQ(writer.add(0, *first.encode(ConstTextureView(sevens))), Status::ok);
  ASSERT_EQ(writer.add(1, *later.encode(ConstTextureView(sevens))), Status::ok);
  ASSERT_EQ(writer.finish(), Status::ok);
  MemorySource source(sink.bytes), again(sink.bytes);
  auto player = *ContainerPlayer::open(source, {}), fresh = *ContainerPlayer::open(again, {});
  for (int frame = 0; frame < 2; ++frame) ASSERT_EQ(player.next(), Status::ok);
  Bytes played(16, std::byte{1});
  ASSERT_EQ(player.read(1, TextureView{played}), Status::ok);
  ASSERT_EQ(played, sevens);
  ASSERT_EQ(player.seek(0), Status::ok);
  ASSERT_EQ(player.next(), Status::ok);
  ASSERT_EQ(fresh.next(), Status::ok);
  Bytes sought(16, std::byte{1}), expected(16, std::byte{1});
  EXPECT_EQ(player.read(1, TextureView{sought}), fresh.read(1, TextureView{expected}));
  EXPECT_EQ(sought, expected);
  EXPECT_NE(sought, sevens);
}

/// Descriptions cost nothing, after seek() neither.
TEST(ContainerPlayer, TexturesWithoutPacketsCostNothing) {
  const TextureDesc small = map_texture(Format::R8_UINT, {4, 4, 1}, {4, 4, 1});
  const TextureDesc large = map_texture(Format::R8_UINT, {2048, 2048, 1}, {1, 1, 1});
  TextureGroup first, second;
  first.textures = {{"small", small, {}, {}}};
  second.textures = {{"large", large, {}, {}}};
  ContainerDescription description;
  const TextureGroup groups[] = {first, second};
  ASSERT_EQ(add_volume(description, "volume", *texture_volume(groups)), Status::ok);
  MemorySink sink;
  auto writer = *ContainerWriter::create(sink, description);
  auto encoder = *Encoder::create(small);
  ASSERT_EQ(writer.add(0, *encoder.encode(ConstTextureView(Bytes(16, std::byte{7})))), Status::ok);
  ASSERT_EQ(writer.finish(), Status::ok);
  MemorySource source(sink.bytes);
  auto player = *ContainerPlayer::open(source, {.limits = {.max_total_bytes = 8 << 20}});
  ASSERT_EQ(player.seek(0), Status::ok);
  ASSERT_EQ(player.next(), Status::ok);
  EXPECT_EQ(player.changed(0).size(), 1U);
  EXPECT_TRUE(player.changed(1).empty());
  EXPECT_LT(player.memory(), std::uint64_t{8} << 20);
}

}  // namespace
}  // namespace gicodec
