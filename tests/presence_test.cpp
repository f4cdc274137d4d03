// Records that do not exist, and blocks that were not received: both are zero, and both are told
// apart from zeros that were sent.
#include "shapes.h"
#include "support.h"

#include "texture/presence.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>

namespace gicodec {
namespace {

using namespace test;

/// A pool of 20 slots with 7×3×1 records of three bytes, of which some exist.
TextureDesc pool_of(Presence presence) {
  TextureDesc desc;
  desc.record = Format::R8G8B8_SNORM;
  desc.grid = {20, 1, 1};
  desc.block = {7, 3, 1};
  desc.space = Space::pool;
  desc.model = Model::none;
  desc.presence = presence;
  desc.layout = Tiling::blocks;
  return desc;
}
/// Of 20 bricks.
TextureDesc brick_pool(std::uint8_t side) {
  TextureDesc desc = pool_of(Presence::brick);
  desc.record = Format::E5B9G9R9_UFLOAT_PACK32;
  desc.block = {static_cast<std::uint8_t>(kVoxelDirections * side), side, side};
  desc.model = Model::octree;
  return desc;
}
constexpr Presence kPresences[] = {Presence::count, Presence::mask};

Bytes count_of(unsigned count) {
  return {static_cast<std::byte>(count & 255), static_cast<std::byte>(count >> 8)};
}

TEST(Presence, BytesPerBlock) {
  EXPECT_EQ(presence_bytes(pool_of(Presence::all)), 0U);
  EXPECT_EQ(presence_bytes(pool_of(Presence::count)), 2U);
  EXPECT_EQ(presence_bytes(pool_of(Presence::mask)), 3U);
  TextureDesc desc = pool_of(Presence::mask);
  desc.block = {4, 4, 1};
  EXPECT_EQ(presence_bytes(desc), 2U);
  desc.block = {32, 32, 32};
  EXPECT_EQ(presence_bytes(desc), 4096U);
  EXPECT_EQ(presence_bytes(brick_pool(2)), 9U);
  EXPECT_EQ(presence_bytes(brick_pool(4)), 16U);
  EXPECT_EQ(presence_bytes(brick_pool(8)), 72U);
}

TEST(Presence, OfBricks) {
  for (const std::uint8_t side : std::array<std::uint8_t, 3>{2, 4, 8}) {
    const TextureDesc desc = brick_pool(side);
    ASSERT_EQ(validate(desc), Status::ok);
    Bytes bytes(presence_bytes(desc), std::byte{0xFF});
    bytes[8] = std::byte{0b00000101};
    const BlockPresence presence(desc, bytes);
    EXPECT_TRUE(presence.is_sound());
    EXPECT_EQ(presence.count(), record_count(desc.block) - 6 * 6);
    for (std::uint32_t r = 0; r < record_count(desc.block); ++r) {
      EXPECT_EQ(presence.exists(r), r < 6 || (r >= 12 && r < 18) || r >= 48) << r;
    }
  }
  const auto changed = [](const auto& change) {
    TextureDesc desc = brick_pool(4);
    change(desc);
    return validate(desc);
  };
  EXPECT_EQ(changed([](auto& d) { d.block.x = 4; }), Status::invalid_description);
  EXPECT_EQ(changed([](auto& d) { d.block = {18, 3, 3}; }), Status::invalid_description);
  EXPECT_EQ(changed([](auto& d) { d.model = Model::none; }), Status::invalid_description);
  EXPECT_EQ(changed([](auto& d) { d.presence = Presence::mask; }), Status::invalid_description);
  EXPECT_EQ(changed([](auto& d) { d.space = Space::grid; }), Status::invalid_description);
  EXPECT_EQ(changed([](auto& d) { d.presence = static_cast<Presence>(4); }),
            Status::invalid_description);
}

TEST(Presence, WhatIsSound) {
  const TextureDesc counted = pool_of(Presence::count), masked = pool_of(Presence::mask);
  for (const unsigned count : {0U, 1U, 21U}) {
    const Bytes bytes = count_of(count);
    const BlockPresence presence(counted, bytes);
    EXPECT_TRUE(presence.is_sound());
    EXPECT_EQ(presence.count(), count);
    for (std::uint32_t r = 0; r < 21; ++r) EXPECT_EQ(presence.exists(r), r < count);
  }
  for (const unsigned count : {22U, 256U, 65535U}) {
    EXPECT_FALSE(BlockPresence(counted, count_of(count)).is_sound()) << count;
  }
  const Bytes some{std::byte{0b10000001}, std::byte{0}, std::byte{0b10000}};
  const BlockPresence presence(masked, some);
  EXPECT_TRUE(presence.is_sound());
  EXPECT_EQ(presence.count(), 3U);
  for (std::uint32_t r = 0; r < 21; ++r) EXPECT_EQ(presence.exists(r), r == 0 || r == 7 || r == 20);
  for (const unsigned bit : {21U, 22U, 23U}) {
    EXPECT_FALSE(BlockPresence(masked, flip_bit(some, bit)).is_sound()) << bit;
  }
  // Of all blocks, the last.
  Bytes many(60);
  EXPECT_TRUE(is_sound(masked, many));
  many.back() = std::byte{0x20};
  EXPECT_FALSE(is_sound(masked, many));
}

RC_GTEST_PROP(Presence, GatherAndScatterAreInverse, (std::uint64_t seed)) {
  Random random(seed);
  auto desc = any_desc(random, 2000);
  desc.presence = kPresences[random() % 2];
  desc.model = Model::none;
  const auto presence = any_presence(random, desc);
  const auto one = std::span(presence).first(presence_bytes(desc));
  const auto block = noise(random, block_bytes(desc));
  Bytes expected = block, cleared = block, gathered, back(block.size(), std::byte{0xEE});
  clear_absent_records(desc, one, expected);
  clear_absent(desc, one, cleared);
  RC_ASSERT(cleared == expected);
  gather_present(desc, one, block, gathered);
  RC_ASSERT(gathered.size() == BlockPresence(desc, one).count() * desc.record.bytes);
  const Exact exact{std::span(gathered)};
  RC_ASSERT(scatter_present(desc, one, exact.span(), back) == gathered.size());
  RC_ASSERT(back == expected);
}

/// Noise everywhere, records that exist by presence only.
struct Session {
  explicit Session(const TextureDesc& desc, const char* backend = "raw")
      : texture(desc),
        encoder(*Encoder::create(desc, {.backend = backend})),
        decoder(*Decoder::create(desc)) {}

  Packet encode(Selection selection = Selection::changed()) {
    auto packet = encoder.encode(std::as_const(texture).view(), selection);
    EXPECT_TRUE(packet.ok()) << packet.status();
    return packet.ok() ? *std::move(packet) : Packet{};
  }

  Texture texture;
  Encoder encoder;
  Decoder decoder;
};

TEST(Presence, AbsentRecordsAreZeroAndCostNothing) {
  Random random(91);
  for (const Presence kind : kPresences) {
    const TextureDesc desc = pool_of(kind);
    const Bytes presence = any_presence(random, desc);
    Session session(desc);
    session.texture.fill(Fill::noise, random);
    ASSERT_EQ(session.encoder.set_presence(presence), Status::ok);
    ASSERT_EQ(session.decoder.set_presence(presence), Status::ok);
    const auto packet = session.encode(Selection::all());
    Bytes expected;
    std::size_t exist = 0;
    for (std::uint32_t block = 0; block < block_count(desc); ++block) {
      auto now = session.texture.block(block);
      const auto one =
          std::span(presence).subspan(block * presence_bytes(desc), presence_bytes(desc));
      clear_absent_records(desc, one, now);
      exist += BlockPresence(desc, one).count();
      expected.insert(expected.end(), now.begin(), now.end());
    }
    EXPECT_EQ(peek(packet)->payload_size, 1 + exist * desc.record.bytes);
    ASSERT_EQ(session.decoder.decode(packet), Status::ok);
    EXPECT_EQ(contents(session.decoder), expected);
    EXPECT_EQ(contents(session.encoder), expected);
    // What stands where nothing exists is no change.
    for (std::uint32_t block = 0; block < block_count(desc); ++block) {
      const auto one =
          std::span(presence).subspan(block * presence_bytes(desc), presence_bytes(desc));
      for (std::uint32_t r = 0; r < 21; ++r) {
        if (BlockPresence(desc, one).exists(r)) continue;
        std::ranges::fill(session.texture.record(block, r % 7, r / 7), std::byte{0x55});
      }
    }
    EXPECT_EQ(peek(session.encode())->blocks, 0U);
  }
}

TEST(Presence, AChangeOfPresenceIsAChangeOfTheBlock) {
  const TextureDesc desc = pool_of(Presence::count);
  Random random(92);
  Session session(desc, "zstd");
  session.texture.fill(Fill::noise, random);
  Bytes presence;
  for (int block = 0; block < 20; ++block) {
    const auto one = count_of(9);
    presence.insert(presence.end(), one.begin(), one.end());
  }
  const auto step = [&] {
    EXPECT_EQ(session.encoder.set_presence(presence), Status::ok);
    EXPECT_EQ(session.decoder.set_presence(presence), Status::ok);
    const auto packet = session.encode();
    EXPECT_EQ(session.decoder.decode(packet), Status::ok);
    EXPECT_EQ(contents(session.decoder), contents(session.encoder));
    const auto changed = session.decoder.changed();
    return std::vector<std::uint32_t>(changed.begin(), changed.end());
  };
  EXPECT_EQ(step().size(), 20U);
  EXPECT_EQ(step().size(), 0U);
  presence[2 * 5] = std::byte{10};
  presence[2 * 11] = std::byte{0};
  EXPECT_EQ(step(), (std::vector<std::uint32_t>{5, 11}));
  const auto records = session.decoder.records();
  const Bytes fifth = session.texture.block(5);
  EXPECT_TRUE(std::ranges::equal(records.subspan(5 * 63, 30), std::span(fifth).first(30)));
  const auto none = records.subspan(11 * 63, 63);
  EXPECT_EQ(std::ranges::count(none, std::byte{0}), 63);
  // A record that appears holds what the texture holds, even if that was never sent.
  presence[2 * 11] = std::byte{21};
  EXPECT_EQ(step(), (std::vector<std::uint32_t>{11}));
  EXPECT_TRUE(std::ranges::equal(session.decoder.records().subspan(11 * 63, 63),
                                 Bytes(session.texture.block(11))));
}

TEST(Presence, UnsoundPresenceIsRefused) {
  for (const Presence kind : kPresences) {
    const TextureDesc desc = pool_of(kind);
    const std::size_t size = presence_bytes(desc);
    Random random(93);
    Session session(desc);
    session.texture.fill(Fill::noise, random);
    Bytes presence = any_presence(random, desc);
    ASSERT_EQ(session.encoder.set_presence(presence), Status::ok);
    // The encoder goes on with what it had.
    Bytes bad = presence;
    bad.back() = std::byte{0xFF};
    EXPECT_EQ(session.encoder.set_presence(bad), Status::presence_invalid);
    EXPECT_EQ(session.encoder.set_presence(std::span(presence).first(presence.size() - 1)),
              Status::mask_mismatch);
    EXPECT_EQ(session.encoder.set_presence({}), Status::mask_mismatch);
    const auto packet = session.encode(Selection::all());

    EXPECT_EQ(session.decoder.decode(packet), Status::out_of_order);  // Nothing is said yet.
    EXPECT_EQ(session.decoder.set_presence(std::span(presence).first(size)), Status::mask_mismatch);
    ASSERT_EQ(session.decoder.set_presence(bad), Status::ok);
    EXPECT_EQ(session.decoder.decode(packet), Status::corrupt);
    // Sound, but of other records than the packet has.
    Bytes other(presence.size());
    ASSERT_EQ(session.decoder.set_presence(other), Status::ok);
    EXPECT_EQ(session.decoder.decode(packet), Status::corrupt);
    EXPECT_EQ(session.decoder.sequence(), 0U);
    EXPECT_EQ(std::ranges::count(session.decoder.received(), 0), 20);
    ASSERT_EQ(session.decoder.set_presence(presence), Status::ok);
    EXPECT_EQ(session.decoder.decode(packet), Status::ok);
    // Blocks that are not in the packet may have any.
    const std::vector<std::uint32_t> some{3};
    session.texture.fill_block(3, Fill::noise, random);
    const auto update = session.encode(some);
    ASSERT_EQ(session.decoder.set_presence(bad), Status::ok);
    EXPECT_EQ(session.decoder.decode(update), Status::ok);
    EXPECT_EQ(contents(session.decoder), contents(session.encoder));
  }
}

TEST(Presence, NothingIsCodedBeforeItIsTold) {
  for (const Presence kind : kPresences) {
    const TextureDesc desc = pool_of(kind);
    Random random(95);
    Session session(desc);
    session.texture.fill(Fill::noise, random);
    const auto view = std::as_const(session.texture).view();
    EXPECT_EQ(session.encoder.encode(view).status(), Status::out_of_order);
    EXPECT_EQ(session.encoder.encode(view, Selection::all()).status(), Status::out_of_order);
    EXPECT_EQ(session.encoder.sequence(), 0U);
    // That nothing exists is told as well as anything else.
    ASSERT_EQ(session.encoder.set_presence(Bytes(20 * presence_bytes(desc))), Status::ok);
    const auto packet = peek(session.encode(Selection::all()));
    EXPECT_TRUE(packet->all_blocks);
    EXPECT_EQ(packet->payload_size, 1U);
  }
}

TEST(Presence, TexturesWithoutTakeNone) {
  const TextureDesc desc = pool_of(Presence::all);
  Session session(desc);
  EXPECT_EQ(session.encoder.set_presence({}), Status::ok);
  EXPECT_EQ(session.decoder.set_presence({}), Status::ok);
  EXPECT_EQ(session.encoder.set_presence(Bytes(20)), Status::mask_mismatch);
  EXPECT_EQ(session.decoder.set_presence(Bytes(20)), Status::mask_mismatch);
}

TEST(Presence, EveryBuiltInBackendCodesIt) {
  for (const Coding& coding : codings()) {
    for (const Presence kind : kPresences) {
      const TextureDesc desc = pool_of(kind);
      Random random(96);
      Session session(desc, coding.backend);
      for (int frame = 0; frame < 4; ++frame) {
        session.texture.fill(Fill::noise, random);
        const Bytes presence = any_presence(random, desc);
        ASSERT_EQ(session.encoder.set_presence(presence), Status::ok);
        ASSERT_EQ(session.decoder.set_presence(presence), Status::ok);
        ASSERT_EQ(session.decoder.decode(session.encode(Selection::all())), Status::ok);
        EXPECT_EQ(contents(session.decoder), contents(session.encoder)) << coding.backend;
      }
    }
  }
}

TEST(Received, BlackBlocksThatWereSentCount) {
  const TextureDesc desc = probe_texture(Format::R16G16_SFLOAT, {4, 1, 1}, 2, 1);
  for (const auto& coding : codings()) {
    Random random(94);
    Texture texture(desc);
    texture.fill_block(2, Fill::noise, random);
    texture.fill_band(2);
    auto encoder = *Encoder::create(desc, options_of(coding));
    auto decoder = *Decoder::create(desc);
    const auto send = [&](Selection selection) {
      const auto packet = encoder.encode(std::as_const(texture).view(), selection);
      EXPECT_EQ(decoder.decode(*packet), Status::ok);
    };
    using Flags = std::vector<std::uint8_t>;
    const auto received = [&] {
      return Flags(decoder.received().begin(), decoder.received().end());
    };
    EXPECT_EQ(received(), (Flags{0, 0, 0, 0}));
    EXPECT_EQ(decoder.state_hash(), 0U);
    // Zeros that were never sent are taken for held, unless it is said that they matter.
    send(Selection::changed());
    EXPECT_EQ(received(), (Flags{0, 0, 1, 0})) << coding.backend;
    const auto before = decoder.state_hash();
    const Bytes held = contents(decoder);
    ASSERT_EQ(encoder.set_active(Flags{1, 0, 1, 1}), Status::ok);
    send(Selection::changed());
    EXPECT_EQ(received(), (Flags{1, 0, 1, 1})) << coding.backend;
    EXPECT_EQ(contents(decoder), held);
    EXPECT_NE(decoder.state_hash(), before);
    send(Selection::changed());
    EXPECT_TRUE(decoder.changed().empty());
    // A keyframe begins anew.
    encoder.request_keyframe();
    send(std::vector<std::uint32_t>{1});
    EXPECT_EQ(received(), (Flags{0, 1, 0, 0})) << coding.backend;
    EXPECT_EQ(contents(decoder), Bytes(held.size()));
    // A block that becomes black was received all the same.
    send(Selection::all());
    EXPECT_EQ(received(), (Flags{1, 1, 1, 1}));
    texture.set_block(2, Bytes(guarded_bytes(desc)));
    send(Selection::changed());
    EXPECT_EQ(received(), (Flags{1, 1, 1, 1}));
    EXPECT_EQ(contents(decoder), Bytes(held.size()));
  }
}

}  // namespace
}  // namespace gicodec
