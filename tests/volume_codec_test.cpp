// VolumeEncoder and VolumeDecoder: what holds among the textures of a volume. Each kind by each
// backend: payload_conformance_test.cpp.
#include "payload_conformance.h"
#include "support.h"

#include <gicodec/volume_decoder.h>
#include <gicodec/volume_encoder.h>

#include <gtest/gtest.h>

#include <algorithm>

namespace gicodec::test {
namespace {

/// Counts, which say how many records of the others exist, and two sets more.
class VolumeCodec : public testing::Test {
 protected:
  VolumeCodec() {
    for (unsigned update = 0; update < 4; ++update) {
      change(volume_, contents_, random_);
      all_.push_back(contents_);
    }
  }
  [[nodiscard]] static std::vector<ConstTextureView> views(const Contents& contents) {
    return {contents.begin(), contents.end()};
  }
  /// Updates that nothing disturbed.
  [[nodiscard]] std::vector<std::vector<Packet>> updates(const VolumeEncoderOptions& options = {}) {
    auto encoder = *VolumeEncoder::create(volume_, options);
    std::vector<std::vector<Packet>> packets;
    for (const Contents& contents : all_) packets.push_back(*encoder.encode(views(contents)));
    return packets;
  }
  [[nodiscard]] static std::vector<std::uint64_t> state_of(const VolumeDecoder& decoder) {
    std::vector<std::uint64_t> hashes;
    for (std::uint8_t t = 0; const Decoder* one = decoder.decoder(t); ++t) {
      hashes.push_back(one->state_hash());
    }
    return hashes;
  }

  Generator random_{21};
  const VolumeDesc volume_ = scene_volume(10);
  Contents contents_ = blank(volume_);
  std::vector<Contents> all_;
};

TEST_F(VolumeCodec, AFailedUpdateLeavesAllTexturesAsTheyWere) {
  const auto sound = updates();
  auto encoder = *VolumeEncoder::create(volume_);
  for (std::size_t update = 0; update < all_.size(); ++update) {
    Contents other = all_[update];
    for (auto& texture : other) std::ranges::reverse(texture);
    other.back().pop_back();
    EXPECT_EQ(encoder.encode(views(other)).status(), Status::view_too_small);
    other.pop_back();
    EXPECT_EQ(encoder.encode(views(other)).status(), Status::invalid_argument);
    const std::vector<std::uint32_t> beyond{0, 10};
    EXPECT_EQ(encoder.encode(views(all_[update]), beyond).status(), Status::block_out_of_range);
    EXPECT_EQ(*encoder.encode(views(all_[update])), sound[update]);
  }
}

TEST_F(VolumeCodec, PresenceOfSelectedBlocksHasToBeSound) {
  const VolumeDesc photons = *photon_volume(3, 16);
  auto encoder = *VolumeEncoder::create(photons);
  Contents contents = blank(photons);
  contents[0][2] = std::byte{17};
  EXPECT_EQ(encoder.encode(views(contents)).status(), Status::presence_invalid);
  const std::vector<std::uint32_t> others{0, 2};
  EXPECT_TRUE(encoder.encode(views(contents), others).ok());
}

TEST_F(VolumeCodec, SetsHaveSelectionsOfTheirOwn) {
  auto encoder = *VolumeEncoder::create(volume_);
  auto decoder = *VolumeDecoder::create(volume_);
  ASSERT_EQ(decoder.decode(*encoder.encode(views(all_[0]), Selection::all())), Status::ok);
  const std::vector<std::uint32_t> bricks{7, 2}, none;
  const Selection selections[] = {bricks, none, Selection::all()};
  ASSERT_EQ(decoder.decode(*encoder.encode(views(all_[1]), selections)), Status::ok);
  for (std::uint8_t t = 0; t < 3; ++t) {
    EXPECT_TRUE(std::ranges::equal(decoder.changed(t), std::vector<std::uint32_t>{2, 7}));
  }
  EXPECT_TRUE(decoder.changed(3).empty());
  EXPECT_EQ(decoder.changed(4).size(), 6U);
  EXPECT_EQ(encoder.encode(views(all_[2]), std::span(selections).first(2)).status(),
            Status::invalid_argument);
  const BlockMask active{1, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(encoder.set_active(3, active), Status::unknown_group);
  EXPECT_EQ(encoder.set_active(1, active), Status::mask_mismatch);
  ASSERT_EQ(encoder.set_active(0, active), Status::ok);
  Contents inverted = all_[2];
  for (auto& texture : inverted) {
    for (std::byte& byte : texture) byte = ~byte;
  }
  for (std::size_t at = 0; at < inverted[0].size(); ++at) inverted[0][at] = std::byte{0xFF};
  ASSERT_EQ(decoder.decode(*encoder.encode(views(inverted))), Status::ok);
  EXPECT_TRUE(std::ranges::equal(decoder.changed(2), std::vector<std::uint32_t>{0}));
}

TEST_F(VolumeCodec, StrangersPacketsAreRefused) {
  const auto sound = updates();
  auto decoder = *VolumeDecoder::create(volume_);
  ASSERT_EQ(decoder.decode(sound[0]), Status::ok);
  const auto before = state_of(decoder);
  auto other = sound[1];
  std::swap(other[0], other[1]);
  EXPECT_EQ(decoder.decode(other), Status::out_of_order);
  other = sound[1];
  other[2] = other[1];
  EXPECT_EQ(decoder.decode(other), Status::out_of_order);
  other = updates({.first_texture = 1})[1];
  EXPECT_EQ(decoder.decode(other), Status::unknown_texture);
  EXPECT_EQ(decoder.decode(std::span(other).last(1)), Status::unknown_texture);
  other = sound[1];
  other[4].resize(3);
  EXPECT_NE(decoder.decode(other), Status::ok);
  EXPECT_EQ(state_of(decoder), before);
  // Of another texture, and of an update that was missed.
  EXPECT_NE(decoder.decode(std::span(updates({.first_texture = 1})[0]).first(1)), Status::ok);
  EXPECT_EQ(decoder.decode(sound[2]), Status::reference_missing);
  EXPECT_EQ(state_of(decoder), before);
  EXPECT_TRUE(decoder.changed(0).empty());
  for (std::size_t t = 0; t < sound[1].size(); ++t) {
    for (std::size_t at = 0; at < sound[1][t].size(); at += 1 + random_() % 16) {
      other = sound[1];
      other[t][at] ^= std::byte(1U << random_() % 8);
      auto copy = *VolumeDecoder::create(volume_);
      ASSERT_EQ(copy.decode(sound[0]), Status::ok);
      EXPECT_NE(copy.decode(other), Status::ok);
      EXPECT_EQ(copy.decode(sound[1]), Status::ok);  // Those before it are passed over.
    }
  }
  ASSERT_EQ(decoder.decode(sound[1]), Status::ok);
  const auto after = state_of(decoder);
  ASSERT_EQ(decoder.decode(sound[1]), Status::ok);
  EXPECT_EQ(state_of(decoder), after);
  for (const Packet& packet : sound[2]) ASSERT_EQ(decoder.decode(packet), Status::ok);
  std::uint8_t beyond = 5;
  Bytes room(1 << 16);
  EXPECT_EQ(decoder.read(beyond, TextureView{room}), Status::unknown_texture);
  EXPECT_TRUE(decoder.changed(beyond).empty());
}

TEST_F(VolumeCodec, LimitsHoldForAllTexturesTogether) {
  const std::uint64_t all = VolumeDecoder::create(volume_)->memory();
  EXPECT_GT(all, 0U);
  VolumeDecoderOptions options;
  options.limits.max_total_bytes = all;
  EXPECT_TRUE(VolumeDecoder::create(volume_, options).ok());
  options.limits.max_total_bytes = all - 1;
  EXPECT_EQ(VolumeDecoder::create(volume_, options).status(), Status::limit_exceeded);
  options = {};
  options.limits.max_texture_bytes = 16;
  EXPECT_EQ(VolumeDecoder::create(volume_, options).status(), Status::limit_exceeded);
}

TEST_F(VolumeCodec, OptionsAreThoseOfAllTextures) {
  EXPECT_EQ(VolumeEncoder::create({}).status(), Status::invalid_description);
  EXPECT_EQ(VolumeDecoder::create({}).status(), Status::invalid_description);
  EXPECT_EQ(VolumeEncoder::create(volume_, {.backend = "none"}).status(), Status::unknown_backend);
  for (const std::size_t errors : {1, 4, 6}) {
    EXPECT_EQ(VolumeEncoder::create(volume_, {.max_errors = std::vector<float>(errors)}).status(),
              Status::invalid_argument);
  }
  EXPECT_EQ(VolumeEncoder::create(volume_, {.max_errors = {1, 0, 0, 0, 0}}).status(),
            Status::invalid_bound);
  EXPECT_TRUE(VolumeEncoder::create(volume_, {.max_errors = {0, 0, 0, 2, 0}}).ok());
  EXPECT_TRUE(VolumeEncoder::create(volume_, {.first_texture = 251}).ok());
  EXPECT_EQ(VolumeEncoder::create(volume_, {.first_texture = 252}).status(),
            Status::invalid_argument);
  EXPECT_EQ(VolumeDecoder::create(volume_, {.first_texture = 252}).status(),
            Status::invalid_argument);
}

TEST_F(VolumeCodec, PacketsSayWhichTextureTheyAreOf) {
  constexpr std::uint8_t kFirst = 9;
  auto one_by_one = *VolumeDecoder::create(volume_, {.first_texture = kFirst});
  auto together = *VolumeDecoder::create(volume_);
  const auto numbered = updates({.first_texture = kFirst}), plain = updates();
  for (std::size_t update = 0; update < plain.size(); ++update) {
    ASSERT_EQ(together.decode(plain[update]), Status::ok);
    for (const Packet& packet : numbered[update]) ASSERT_EQ(one_by_one.decode(packet), Status::ok);
    EXPECT_EQ(state_of(one_by_one), state_of(together)) << update;
  }
  EXPECT_EQ(one_by_one.decode(plain[0][0]), Status::unknown_texture);
}

TEST_F(VolumeCodec, KeyframesComeTogether) {
  auto encoder = *VolumeEncoder::create(volume_, {.gop = 2, .first_texture = 9});
  for (std::size_t update = 0; update < all_.size(); ++update) {
    std::uint8_t id = 9;
    const auto packets = *encoder.encode(views(all_[update]));
    for (const Packet& packet : packets) {
      EXPECT_EQ(is_keyframe(peek(packet)->type), update % 2 == 0);
      EXPECT_EQ(peek(packet)->texture_id, id++);
    }
  }
}

}  // namespace
}  // namespace gicodec::test
