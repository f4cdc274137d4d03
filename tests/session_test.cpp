// Encoder and decoder over sequences: exact texels for every format, backend, selection and view.
#include "distinct_formats.h"
#include "shapes.h"
#include "support.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <numeric>
#include <optional>

namespace gicodec {
namespace {

using namespace test;

/// One encoder, two decoders (one with its own layout and a view), and what they should hold.
class Stream {
 public:
  Stream(const TextureDesc& desc, const EncoderOptions& options, Random& random)
      : random_(random),
        texture_(desc, chance(random, 2) ? 0 : random() % 40, random() % 2 * (random() % 90),
                 random() % 2 * (random() % 50)),
        model_(desc),
        encoder_(*Encoder::create(desc, options)),
        decoder_(*Decoder::create(desc, with_any_isa(random))),
        other_(*Decoder::create(with_any_layout(desc, random), with_any_isa(random))),
        out_(other_.desc(), random() % 24),
        presence_(any_presence(random, desc)),
        sent_presence_(presence_.size()),
        gop_(options.gop) {
    EXPECT_EQ(encoder_.set_presence(presence_), Status::ok);
  }

  /// Changes some blocks: records, or guard bands only, or nothing at all.
  void mutate() {
    constexpr Fill kFills[] = {Fill::zero, Fill::noise, Fill::small, Fill::special};
    const auto& desc = texture_.desc();
    for (const auto block : random_selection(random_, block_count(desc))) {
      if (!chance(random_, 4)) texture_.fill_block(block, kFills[random_() % 4], random_);
      if (!chance(random_, 3))
        texture_.fill_band(block);  // Otherwise stale, if the records changed.
      if (desc.guard_band == 1 && chance(random_, 5)) {
        texture_.record(block, pick(random_, 0, desc.block.x + 1U), 0)[0] ^= std::byte{0x10};
      }
    }
    if (presence_.empty() || chance(random_, 3)) return;
    // Another presence for some blocks.
    const auto other = any_presence(random_, desc);
    for (const auto block : random_selection(random_, block_count(desc))) {
      copy_presence(other, block, presence_);
    }
    EXPECT_EQ(encoder_.set_presence(presence_), Status::ok);
  }

  /// A frame: the packet goes through both decoders.
  void step() {
    mutate();
    const auto total = block_count(texture_.desc());
    const bool wants_keyframe = chance(random_, 6);
    if (wants_keyframe) encoder_.request_keyframe();
    if (chance(random_, 5)) {
      active_.resize(chance(random_, 3) ? 0 : total);
      for (auto& flag : active_) flag = static_cast<std::uint8_t>(random_() % 3);
      ASSERT_EQ(encoder_.set_active(active_), Status::ok);
    }
    const bool keyframe = first_ || wants_keyframe || (gop_ > 0 && since_keyframe_ == gop_);
    std::vector<std::uint32_t> blocks, expected;
    const auto kind = random_() % 4;
    Selection selection = kind == 0 ? Selection::all() : Selection::changed();
    if (kind == 0) {
      expected.resize(total);
      std::iota(expected.begin(), expected.end(), 0U);
    } else if (kind == 1) {
      expected = random_selection(random_, total);
      blocks = expected;
      if (chance(random_, 2)) std::ranges::shuffle(blocks, random_);
      selection = blocks;
    } else {
      expected = changed(keyframe);
    }
    const auto packet = encode(selection, expected.size());
    ASSERT_FALSE(packet.empty());
    const auto info = peek(packet);
    ASSERT_TRUE(info.ok());
    EXPECT_EQ(is_keyframe(info->type), keyframe);
    EXPECT_EQ(info->sequence, encoder_.sequence());
    EXPECT_EQ(info->reference, keyframe ? 0 : encoder_.sequence() - 1);
    EXPECT_FALSE(info->lossy);
    EXPECT_EQ(info->header_size + info->index_size + info->guard_band_size + info->payload_size,
              packet.size());
    model_.apply(texture_, keyframe, expected, presence_);
    for (const auto block : expected) copy_presence(presence_, block, sent_presence_);
    decode(packet, expected);
    if (chance(random_, 3)) join_late();
    first_ = false;
    since_keyframe_ = keyframe ? 1 : since_keyframe_ + 1;
  }

 private:
  static DecoderOptions with_any_isa(Random& random) {
    DecoderOptions options;
    options.isa = any_isa(random);
    return options;
  }
  static TextureDesc with_any_layout(TextureDesc desc, Random& random) {
    desc.layout = any_layout(random, desc);
    return desc;
  }

  [[nodiscard]] std::span<const std::byte> presence_of(const Bytes& all,
                                                       std::uint32_t block) const {
    const std::size_t size = presence_bytes(texture_.desc());
    return std::span(all).subspan(block * size, size);
  }
  void copy_presence(const Bytes& from, std::uint32_t block, Bytes& to) const {
    const auto one = presence_of(from, block);
    std::ranges::copy(one, to.begin() + static_cast<std::ptrdiff_t>(block * one.size()));
  }

  /// The blocks that Selection::changed() means.
  [[nodiscard]] std::vector<std::uint32_t> changed(bool keyframe) const {
    std::vector<std::uint32_t> blocks;
    for (std::uint32_t block = 0; block < block_count(texture_.desc()); ++block) {
      if (!active_.empty() && active_[block] == 0) continue;
      auto now = texture_.block(block);
      const auto exists = presence_of(presence_, block);
      if (!exists.empty()) clear_absent_records(texture_.desc(), exists, now);
      bool same = false;
      if (!keyframe && model_.received()[block] != 0) {
        same = std::ranges::equal(now, model_.block(block)) &&
               std::ranges::equal(exists, presence_of(sent_presence_, block));
      } else if (active_.empty()) {
        same = std::ranges::all_of(now, [](auto b) { return b == std::byte{0}; });
      }
      if (!same) blocks.push_back(block);
    }
    return blocks;
  }

  /// By one of the three ways to encode.
  Bytes encode(Selection selection, std::size_t blocks) {
    const auto bound = encoder_.bound(blocks);
    const auto view = std::as_const(texture_).view();
    Bytes packet;
    if (chance(random_, 2)) {
      auto made = encoder_.encode(view, selection);
      EXPECT_TRUE(made.ok()) << made.status();
      if (made.ok()) packet = *std::move(made);
    } else if (chance(random_, 2)) {
      packet.assign(99, std::byte{1});
      EXPECT_EQ(encoder_.encode_to(view, selection, packet), Status::ok);
    } else {
      Exact room(bound);
      const auto size = encoder_.encode_to(view, selection, room.span());
      EXPECT_TRUE(size.ok()) << size.status();
      if (size.ok()) packet.assign(room.span().begin(), room.span().begin() + *size);
    }
    EXPECT_LE(packet.size(), bound);
    return packet;
  }

  void expect_model(const Decoder& decoder) const {
    EXPECT_TRUE(contents(decoder) == model_.blocks());
    EXPECT_TRUE(std::ranges::equal(decoder.records(), model_.records()));
    EXPECT_TRUE(std::ranges::equal(decoder.received(), model_.received()));
    EXPECT_EQ(decoder.state_hash(), decoder_.state_hash());
  }

  void decode(const Bytes& packet, const std::vector<std::uint32_t>& expected) {
    const Exact bytes{std::span(packet)};
    for (Decoder* decoder : {&decoder_, &other_}) {
      ASSERT_EQ(decoder->set_presence(sent_presence_), Status::ok);
    }
    ASSERT_EQ(decoder_.decode(bytes.span()), Status::ok);
    EXPECT_EQ(listed_blocks(decoder_, packet), expected);
    EXPECT_EQ(decoder_.changed().size(),
              is_keyframe(peek(packet)->type) ? block_count(decoder_.desc()) : expected.size());
    EXPECT_EQ(decoder_.sequence(), encoder_.sequence());
    expect_model(decoder_);
    EXPECT_TRUE(contents(encoder_) == model_.blocks());
    ASSERT_EQ(other_.decode(bytes.span(), out_.view()), Status::ok);
    EXPECT_TRUE(out_.blocks() == model_.blocks());
    EXPECT_TRUE(out_.padding_untouched());
    expect_model(other_);
    if (late_) {
      ASSERT_EQ(late_->decode(bytes.span()), Status::ok);
      expect_model(*late_);
    }
    EXPECT_TRUE(texture_.padding_untouched());
  }

  /// Another decoder takes a snapshot instead of all packets so far, and then the packets that
  /// come.
  void join_late() {
    auto packet = encoder_.snapshot();
    ASSERT_TRUE(packet.ok()) << packet.status();
    const auto info = peek(*packet);
    ASSERT_TRUE(info.ok());
    EXPECT_EQ(info->type, PacketType::snapshot);
    EXPECT_EQ(info->sequence, encoder_.sequence());
    EXPECT_LE(packet->size(), encoder_.bound(SIZE_MAX));
    auto made = Decoder::create(texture_.desc());
    ASSERT_TRUE(made.ok());
    late_ = *std::move(made);
    ASSERT_EQ(late_->set_presence(sent_presence_), Status::ok);
    ASSERT_EQ(late_->decode(*packet), Status::ok);
    EXPECT_EQ(late_->sequence(), encoder_.sequence());
    expect_model(*late_);
    EXPECT_TRUE(contents(encoder_) == model_.blocks());
  }

  Random& random_;
  Texture texture_;
  ExpectedMirror model_;
  Encoder encoder_;
  Decoder decoder_, other_;
  std::optional<Decoder> late_;
  Texture out_;
  std::vector<std::uint8_t> active_;
  Bytes presence_, sent_presence_;  ///< the encoder's, and of the blocks as they were sent
  std::uint32_t gop_, since_keyframe_ = 0;
  bool first_ = true;
};

void run_stream(const TextureDesc& desc, const Coding& coding, Random& random, int frames) {
  auto options = options_of(coding);
  constexpr std::uint32_t kGops[] = {0, 1, 2, 5, 30};
  options.gop = kGops[random() % 5];
  options.texture_id = static_cast<std::uint8_t>(random());
  options.settings.isa = any_isa(random);
  Stream stream(desc, options, random);
  for (int frame = 0; frame < frames && !testing::Test::HasFailure(); ++frame) stream.step();
  if (testing::Test::HasFailure()) {
    ADD_FAILURE() << desc << " " << coding.backend << " level " << coding.level << " difference "
                  << coding.difference << " gop " << options.gop;
  }
}

TEST(Session, EveryFormatAndCoding) {
  Random random(11);
  test::Sweep sweep;
  for (const auto& info : test::distinct_formats()) {
    for (const auto& coding : codings()) {
      if (!sweep.takes()) continue;
      auto desc = probe_desc(random, coding.level > 12 ? 800 : 4000);
      desc.record = info.record;
      run_stream(desc, coding, random, 5);
      ASSERT_FALSE(HasFailure());
    }
  }
}

RC_GTEST_PROP(Session, AnyTextureAndSequence, (std::uint64_t seed)) {
  Random random(seed);
  const auto& coding = codings()[random() % codings().size()];
  auto desc = any_desc(random, coding.level > 12 ? 800 : 4000);
  run_stream(desc, coding, random, 7);
  RC_ASSERT(!testing::Test::HasFailure());
}

TEST(Session, GuardBandsGoStaleAndFreshAgain) {
  Random random(12);
  const TextureDesc desc =
      probe_texture(Format::R16G16_SFLOAT, {3, 2, 2}, 6, 1, Tiling::slices_xz_y);
  for (const auto& coding : codings()) {
    Texture texture(desc, 4);
    ExpectedMirror model(desc);
    auto encoder = *Encoder::create(desc, options_of(coding));
    auto decoder = *Decoder::create(desc);
    std::vector<std::uint32_t> all(block_count(desc));
    std::iota(all.begin(), all.end(), 0U);
    const auto send = [&](bool keyframe) {
      if (keyframe) encoder.request_keyframe();
      const auto packet = encoder.encode(std::as_const(texture).view(), Selection::all());
      ASSERT_TRUE(packet.ok());
      ASSERT_EQ(decoder.decode(*packet), Status::ok);
      model.apply(texture, keyframe, all);
      ASSERT_TRUE(contents(decoder) == model.blocks());
    };
    const auto guard_band_size = [&] {
      encoder.request_keyframe();
      return peek(*encoder.encode(std::as_const(texture).view(), Selection::all()))
          ->guard_band_size;
    };
    texture.fill(Fill::noise, random);
    send(true);
    for (const auto block : all) texture.fill_block(block, Fill::noise, random);
    send(false);  // All stale.
    send(true);
    for (const auto block : all) texture.fill_block(block, Fill::noise, random);
    send(false);  // Still stale, the bands unchanged.
    for (const auto block : all) texture.fill_band(block);
    send(false);  // Fresh again.
    EXPECT_EQ(guard_band_size(), 0U);
    ASSERT_FALSE(HasFailure()) << coding.backend;
  }
}

TEST(Session, InactiveBlocksAreZeroInAKeyframeAndKeptInAnUpdate) {
  Random random(13);
  const TextureDesc desc =
      probe_texture(Format::A2B10G10R10_UNORM_PACK32, {4, 1, 1}, 2, 1, Tiling::atlas_xy_z);
  Texture texture(desc);
  texture.fill(Fill::noise, random);
  ExpectedMirror model(desc);
  auto encoder = *Encoder::create(desc);
  auto decoder = *Decoder::create(desc);
  const std::vector<std::uint8_t> active{1, 0, 1, 0};
  ASSERT_EQ(encoder.set_active(active), Status::ok);
  ASSERT_EQ(decoder.decode(*encoder.encode(std::as_const(texture).view())), Status::ok);
  EXPECT_EQ(decoder.received()[1] + decoder.received()[3], 0);
  EXPECT_TRUE(std::ranges::equal(decoder.changed(), std::vector<std::uint32_t>{0, 1, 2, 3}));
  model.apply(texture, true, std::vector<std::uint32_t>{0, 2});
  EXPECT_TRUE(contents(decoder) == model.blocks());
  // A list overrides the mask.
  const std::vector<std::uint32_t> list{3};
  ASSERT_EQ(decoder.decode(*encoder.encode(std::as_const(texture).view(), list)), Status::ok);
  model.apply(texture, false, list);
  EXPECT_TRUE(contents(decoder) == model.blocks());
  // No mask: the others follow.
  ASSERT_EQ(encoder.set_active({}), Status::ok);
  ASSERT_EQ(decoder.decode(*encoder.encode(std::as_const(texture).view())), Status::ok);
  EXPECT_TRUE(std::ranges::equal(decoder.changed(), std::vector<std::uint32_t>{1}));
  EXPECT_TRUE(contents(decoder) == texture.blocks());
}

TEST(Session, NothingChangedIsATinyPacket) {
  Random random(14);
  const auto desc = ddgi_irradiance({4, 2, 3});
  Texture texture(desc);
  texture.fill(Fill::noise, random);
  for (const auto& coding : codings()) {
    auto encoder = *Encoder::create(desc, options_of(coding));
    auto decoder = *Decoder::create(desc);
    ASSERT_EQ(decoder.decode(*encoder.encode(std::as_const(texture).view())), Status::ok);
    const auto packet = encoder.encode(std::as_const(texture).view());
    ASSERT_TRUE(packet.ok());
    EXPECT_LT(packet->size(), 32U) << coding.backend;
    EXPECT_EQ(decoder.decode(*packet), Status::ok);
    EXPECT_TRUE(decoder.changed().empty());
    EXPECT_TRUE(contents(decoder) == texture.blocks());
  }
}

TEST(Session, KeyframesComeEveryGopPacketsAndOnRequest) {
  const TextureDesc desc = probe_texture(Format::R16_SFLOAT, {2, 1, 1}, 1, 0, Tiling::atlas_xy_z);
  const Texture texture(desc);
  for (const std::uint32_t gop : {0U, 1U, 3U}) {
    auto encoder = *Encoder::create(desc, {.backend = "raw", .gop = gop});
    for (std::uint32_t i = 0; i < 10; ++i) {
      if (i == 5) encoder.request_keyframe();
      const std::uint32_t after_keyframe = i < 5 ? i : i - 5;
      const auto info = peek(*encoder.encode(texture.view()));
      EXPECT_EQ(is_keyframe(info->type), gop == 0 ? after_keyframe == 0 : after_keyframe % gop == 0)
          << gop << " " << i;
    }
  }
}

TEST(Session, MovesKeepTheState) {
  Random random(15);
  const auto desc = ddgi_visibility({2, 2, 2});
  Texture texture(desc);
  texture.fill(Fill::special, random);
  auto encoder = *Encoder::create(desc);
  auto decoder = *Decoder::create(desc);
  ASSERT_EQ(decoder.decode(*encoder.encode(std::as_const(texture).view())), Status::ok);
  Encoder encoder2 = std::move(encoder);
  Decoder decoder2 = *Decoder::create(ddgi_irradiance({1, 1, 1}));
  decoder2 = std::move(decoder);
  texture.fill_block(3, Fill::noise, random);
  ASSERT_EQ(decoder2.decode(*encoder2.encode(std::as_const(texture).view())), Status::ok);
  EXPECT_EQ(decoder2.sequence(), 2U);
  EXPECT_TRUE(contents(decoder2) == texture.blocks());
}

TEST(Session, ReadOfSomeBlocksWritesOnlyThose) {
  Random random(16);
  const TextureDesc desc =
      probe_texture(Format::R32G32_SFLOAT, {3, 2, 1}, 3, 1, Tiling::atlas_xz_y);
  Texture texture(desc);
  texture.fill(Fill::noise, random);
  auto encoder = *Encoder::create(desc);
  auto decoder = *Decoder::create(desc);
  ASSERT_EQ(decoder.decode(*encoder.encode(std::as_const(texture).view())), Status::ok);
  Texture out(desc, 5);
  const std::vector<std::uint32_t> some{4, 1};
  ASSERT_EQ(decoder.read(out.view(), some), Status::ok);
  ExpectedMirror model(desc);
  model.apply(texture, false, some);
  EXPECT_TRUE(out.blocks() == model.blocks());
  EXPECT_TRUE(out.padding_untouched());
}

/// Whole textures are written by some hundred blocks at a time.
TEST(Session, ReadOfThousandsOfBlocksWritesAll) {
  Random random(17);
  const TextureDesc desc = probe_texture(Format::R16_SFLOAT, {20, 10, 6}, 1, 0, Tiling::atlas_xy_z);
  Texture texture(desc);
  texture.fill(Fill::noise, random);
  auto encoder = *Encoder::create(desc);
  auto decoder = *Decoder::create(desc);
  ASSERT_EQ(decoder.decode(*encoder.encode(std::as_const(texture).view())), Status::ok);
  Texture out(desc, 5);
  ASSERT_EQ(decoder.read(out.view()), Status::ok);
  EXPECT_TRUE(out.blocks() == texture.blocks());
  EXPECT_TRUE(out.padding_untouched());
}

}  // namespace
}  // namespace gicodec
