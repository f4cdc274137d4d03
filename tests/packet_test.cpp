// Packets as bytes: layout, and what a decoder makes of cut, damaged and forged ones.
#include "distinct_formats.h"
#include "support.h"

#include "bitstream/description.h"
#include "bitstream/packet.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

namespace gicodec {
namespace {

using namespace test;

/// A keyframe and an update with stale guard bands and a partial selection.
struct PacketPair {
  TextureDesc desc;
  Packet keyframe, update;
  Bytes after_keyframe;
};

PacketPair make_pair_of_packets(const Coding& coding, const Record& record, Random& random) {
  PacketPair pair;
  pair.desc = probe_texture(record, {3, 2, 1}, 2, 1, Tiling::atlas_xy_z);
  Texture texture(pair.desc);
  texture.fill(Fill::small, random);
  texture.fill_block(1, Fill::noise, random);
  auto encoder = *Encoder::create(pair.desc, options_of(coding));
  pair.keyframe = *encoder.encode(std::as_const(texture).view());
  pair.after_keyframe = contents(encoder);
  texture.fill_block(0, Fill::small, random);
  texture.fill_block(4, Fill::noise, random);
  texture.fill_band(4);
  pair.update = *encoder.encode(std::as_const(texture).view());
  return pair;
}

/// Hands hostile bytes to a decoder that holds the keyframe, in an exact buffer. If they are
/// refused the decoder must be what it was.
class Victim {
 public:
  explicit Victim(const PacketPair& pair)
      : pair_(pair), decoder_(*Decoder::create(pair.desc)), out_(pair.desc, 3) {
    restore();
  }

  Status attack(std::span<const std::byte> bytes) {
    const Exact exact(bytes);
    (void)peek(exact.span());
    const Status status = decoder_.decode(exact.span(), out_.view());
    if (status == Status::ok) {
      EXPECT_TRUE(out_.blocks() == contents(decoder_));
      restore();
    } else {
      EXPECT_EQ(decoder_.sequence(), 1U);
      if (++refused_ % 16 == 0) check();
    }
    return status;
  }
  void check() { EXPECT_TRUE(contents(decoder_) == pair_.after_keyframe); }
  Status update() {
    check();
    return decoder_.decode(pair_.update);
  }

 private:
  void restore() { EXPECT_EQ(decoder_.decode(pair_.keyframe, out_.view()), Status::ok); }

  const PacketPair& pair_;
  Decoder decoder_;
  Texture out_;
  std::uint32_t refused_ = 0;
};

class PacketBytes : public testing::TestWithParam<Coding> {};

TEST_P(PacketBytes, EveryPrefixIsRefused) {
  Random random(31);
  for (const auto& info : test::distinct_formats()) {
    const auto pair = make_pair_of_packets(GetParam(), info.record, random);
    Victim victim(pair);
    for (const auto* packet : {&pair.keyframe, &pair.update}) {
      for (std::size_t size = 0; size < packet->size(); ++size) {
        ASSERT_NE(victim.attack(std::span(*packet).first(size)), Status::ok);
        // With a checksum that fits, so that what is missing must be noticed.
        Bytes cut(packet->begin(), packet->begin() + static_cast<std::ptrdiff_t>(size));
        reseal(cut);
        (void)victim.attack(cut);
      }
      Bytes longer(*packet);
      longer.push_back(std::byte{0});
      EXPECT_NE(victim.attack(longer), Status::ok);
    }
    EXPECT_EQ(victim.update(), Status::ok);
    ASSERT_FALSE(HasFailure()) << info.name;
  }
}

TEST_P(PacketBytes, EverySingleBitFlipIsRefused) {
  Random random(32);
  const auto pair = make_pair_of_packets(GetParam(), Format::R16G16_SFLOAT, random);
  Victim victim(pair);
  for (const auto* packet : {&pair.keyframe, &pair.update}) {
    for (std::size_t bit = 0; bit < packet->size() * 8; ++bit) {
      ASSERT_NE(victim.attack(flip_bit(*packet, bit)), Status::ok) << bit;
    }
  }
  EXPECT_EQ(victim.update(), Status::ok);
}

TEST_P(PacketBytes, EveryForgedBitFlipIsAnErrorOrSomeRecords) {
  Random random(33);
  for (const auto format :
       {Format::R16_SFLOAT, Format::A2B10G10R10_UNORM_PACK32, Format::R32G32B32A32_SFLOAT}) {
    const auto pair = make_pair_of_packets(GetParam(), format, random);
    Victim victim(pair);
    for (const auto* packet : {&pair.keyframe, &pair.update}) {
      for (std::size_t bit = 0; bit + 32 < packet->size() * 8; ++bit) {
        auto forged = flip_bit(*packet, bit);
        reseal(forged);
        (void)victim.attack(forged);
      }
      for (int round = 0; round < 500; ++round) {
        Bytes forged(*packet);
        for (std::uint32_t i = pick(random, 1, 4); i > 0; --i) {
          forged[random() % std::min<std::size_t>(forged.size() - 4, 60)] = std::byte(random());
        }
        reseal(forged);
        (void)victim.attack(forged);
      }
    }
    EXPECT_EQ(victim.update(), Status::ok);
    ASSERT_FALSE(HasFailure());
  }
}

INSTANTIATE_TEST_SUITE_P(Backends, PacketBytes,
                         testing::Values(Coding{"raw", 0, false}, Coding{"raw", 0, true},
                                         Coding{"lz4", 0, true}, Coding{"zstd", 0, true},
                                         Coding{"zstd", 1, false}, Coding{"native", 0, true}),
                         [](const auto& test) {
                           return std::string(test.param.backend) +
                                  (test.param.difference ? "_difference" : "_plain") +
                                  std::to_string(test.param.level);
                         });

TEST(Packet, PeekTellsTheHead) {
  Random random(34);
  const auto pair = make_pair_of_packets({"lz4", 0, true}, Format::R16_SFLOAT, random);
  const auto info = peek(pair.update);
  ASSERT_TRUE(info.ok());
  EXPECT_EQ(info->version, kPacketVersion);
  EXPECT_EQ(info->backend, kBackendLz4);
  EXPECT_EQ(info->texture_id, 0);
  EXPECT_EQ(info->type, PacketType::delta);
  EXPECT_FALSE(info->all_blocks);
  EXPECT_EQ(info->blocks, 2U);
  EXPECT_EQ(info->sequence, 2U);
  EXPECT_EQ(info->reference, 1U);
  EXPECT_GT(info->guard_band_size, 0U);  // Block 0 is stale.
  EXPECT_EQ(verify_checksum(pair.update), Status::ok);
  EXPECT_EQ(verify_checksum(flip_bit(pair.update, 77)), Status::checksum_mismatch);
  EXPECT_EQ(verify_checksum({}), Status::truncated);
}

/// A head of our own making, for values an encoder never writes.
Packet forged(std::initializer_list<int> bytes) {
  Packet packet;
  for (const int byte : bytes) packet.push_back(static_cast<std::byte>(byte));
  packet.resize(packet.size() + 4);
  reseal(packet);
  return packet;
}

TEST(Packet, HeadsThatBreakTheFormat) {
  const auto status = [](std::initializer_list<int> bytes) { return peek(forged(bytes)).status(); };
  EXPECT_EQ(peek({}).status(), Status::truncated);
  EXPECT_EQ(status({0x00, 0, 0, 0, 1, 1}), Status::not_gicodec);
  EXPECT_EQ(status({0xC2, 0, 0, 0, 1, 1}), Status::unsupported_version);
  EXPECT_EQ(status({0xC0, 0, 0, 0, 1, 1}), Status::unsupported_version);
  EXPECT_EQ(status({0xC1}), Status::truncated);
  for (const int type_and_flags : {6, 7, 0x80, 0x81}) {
    EXPECT_EQ(status({0xC1, type_and_flags, 0, 0, 2, 1}), Status::unsupported_feature);
  }
  EXPECT_EQ(status({0xC1, 1, 0, 0, 2, 1, 5, 6, 7, 8}), Status::ok);
  EXPECT_EQ(status({0xC1, 1, 0, 0, 2, 0, 5, 6, 7, 8}), Status::corrupt);  // Refers to itself,
  EXPECT_EQ(status({0xC1, 1, 0, 0, 2, 2, 5, 6, 7, 8}), Status::corrupt);  // to update 0,
  EXPECT_EQ(status({0xC1, 1, 0, 0, 2, 3, 5, 6, 7, 8}), Status::corrupt);  // before the first.
  EXPECT_EQ(status({0xC1, 0, 0, 0, 0, 1, 2, 3, 4}), Status::corrupt);     // Sequence 0.
  EXPECT_EQ(status({0xC1, 0, 0, 0, 1, 1, 2, 3, 4}), Status::ok);
  EXPECT_EQ(status({0xC1, 2, 0, 0, 2, 1, 5, 6, 7, 8}), Status::ok);
  EXPECT_EQ(status({0xC1, 3, 0, 0, 1, 1, 2, 3, 4}), Status::truncated);
  EXPECT_EQ(status({0xC1, 3, 0, 0, 1, 1, 2, 3, 4, 5, 6, 7, 8}), Status::ok);
  EXPECT_EQ(status({0xC1, 4, 0, 0, 2, 1, 5, 6, 7, 8, 5, 6, 7}), Status::truncated);
  EXPECT_EQ(status({0xC1, 4, 0, 0, 2, 1, 5, 6, 7, 8, 5, 6, 7, 8}), Status::ok);
  EXPECT_EQ(status({0xC1, 5, 0, 0, 9, 8, 5, 6, 7, 8, 5, 6, 7, 8}), Status::ok);
  // HEVC has keyframes and deltas only.
  EXPECT_EQ(status({0xC1, 1, 3, 0, 2, 1, 5, 6, 7, 8}), Status::ok);
  EXPECT_EQ(status({0xC1, 2, 3, 0, 2, 1, 5, 6, 7, 8}), Status::corrupt);
  EXPECT_EQ(status({0xC1, 3, 3, 0, 1, 1, 2, 3, 4, 5, 6, 7, 8}), Status::corrupt);
  EXPECT_EQ(status({0xC1, 4, 3, 0, 2, 1, 5, 6, 7, 8, 5, 6, 7, 8}), Status::corrupt);
  EXPECT_EQ(status({0xC1, 5, 3, 0, 2, 1, 5, 6, 7, 8, 5, 6, 7, 8}), Status::corrupt);
  EXPECT_EQ(status({0xC1, 0, 0, 0, 0x81, 0x00, 1, 2, 3, 4}), Status::corrupt);  // Longer varint.
  EXPECT_EQ(status({0xC1, 0, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF, 0x1F, 1, 2, 3, 4}), Status::corrupt);
  EXPECT_EQ(status({0xC1, 0x11, 0, 0, 2, 1, 5, 6, 7, 8, 0}),
            Status::corrupt);  // Guard bands of no bytes.
  EXPECT_EQ(status({0xC1, 0x11, 0, 0, 2, 1, 5, 6, 7, 8, 9}),
            Status::truncated);  // More than there is.
  EXPECT_EQ(status({0xC1, 0x21, 0, 0, 2, 1, 5, 6, 7, 8, 3, 1}), Status::truncated);
  EXPECT_EQ(status({0xC1, 0x21, 0, 0, 2, 1, 5, 6, 7, 8, 3, 1, 7}), Status::ok);
  EXPECT_EQ(status({0xC1, 0x21, 0, 0, 2, 1, 5, 6, 7, 8, 0xFF, 0xFF, 0xFF, 0x7F, 1, 7}),
            Status::corrupt);
}

TEST(Packet, NoPacketMakesADecoderAllocateMoreThanItsTexture) {
  // 2^24 blocks claimed against a grid of six, an index buffer that is not there.
  const TextureDesc desc = probe_texture(Format::R16_SFLOAT, {3, 2, 1}, 2, 1, Tiling::atlas_xy_z);
  auto decoder = *Decoder::create(desc);
  auto encoder = *Encoder::create(desc);
  const Texture texture(desc);
  const auto keyframe = *encoder.encode(texture.view());
  ASSERT_EQ(decoder.decode(keyframe), Status::ok);
  const auto base = packet_checksum(keyframe);
  const auto byte = [&](int i) { return static_cast<int>(base >> 8 * i & 0xFF); };
  for (const int mode : {0x21, 0x41, 0x61}) {
    const auto packet = forged(
        {0xC1, mode, 0, 0, 2, 1, byte(0), byte(1), byte(2), byte(3), 0x80, 0x80, 0x80, 0x08, 0});
    EXPECT_EQ(decoder.decode(packet), Status::corrupt);
  }
}

TEST(Packet, AnUpdateOfAnotherSessionIsRefused) {
  // Two encoders of one texture: the same sequence numbers, other states.
  const TextureDesc desc = probe_texture(Format::R16_SFLOAT, {3, 2, 1}, 2, 0, Tiling::atlas_xy_z);
  auto decoder = *Decoder::create(desc);
  auto first = *Encoder::create(desc);
  auto second = *Encoder::create(desc);
  Texture texture(desc);
  ASSERT_EQ(decoder.decode(*first.encode(texture.view(), Selection::all())), Status::ok);
  texture.record(0, 0, 0)[0] ^= std::byte{1};
  ASSERT_TRUE(second.encode(texture.view(), Selection::all()).ok());
  EXPECT_EQ(decoder.decode(*second.encode(texture.view())), Status::reference_missing);
  EXPECT_EQ(decoder.decode(*first.encode(texture.view())), Status::ok);
}

TEST(Packet, UnknownPayloadsAreRefused) {
  const TextureDesc desc = probe_texture(Format::R16_SFLOAT, {1, 1, 1}, 1, 0, Tiling::atlas_xy_z);
  auto decoder = *Decoder::create(desc);
  const std::uint32_t hash = description_hash(desc);
  const auto keyframe = [&](int backend, std::initializer_list<int> payload) {
    Packet packet;
    for (const int byte : {0xC1, 0, backend, 0, 1}) packet.push_back(static_cast<std::byte>(byte));
    for (int i = 0; i < 4; ++i) packet.push_back(static_cast<std::byte>(hash >> 8 * i));
    for (const int byte : payload) packet.push_back(static_cast<std::byte>(byte));
    packet.resize(packet.size() + 4);
    reseal(packet);
    return decoder.decode(packet);
  };
  EXPECT_EQ(keyframe(0, {0, 5, 6}), Status::ok);
  EXPECT_EQ(keyframe(0, {}), Status::truncated);
  EXPECT_EQ(keyframe(0, {0, 5}), Status::corrupt);
  EXPECT_EQ(keyframe(0, {0, 5, 6, 7}), Status::corrupt);
  EXPECT_EQ(keyframe(0, {0x04, 5, 6}), Status::unsupported_feature);
  EXPECT_EQ(keyframe(0, {0x80, 5, 6}), Status::unsupported_feature);
  EXPECT_EQ(keyframe(0, {0x03, 5, 6}), Status::corrupt);  // A difference in a keyframe,
  EXPECT_EQ(keyframe(0, {0x01, 5, 6}), Status::corrupt);  // without planes.
  EXPECT_EQ(keyframe(1, {0x02}), Status::corrupt);
  EXPECT_EQ(keyframe(2, {0x02}), Status::corrupt);
  // A skippable zstd frame before a sound one.
  EXPECT_EQ(keyframe(2, {0x02, 0x50, 0x2A, 0x4D, 0x18, 0,    0, 0, 0, 0x28,
                         0xB5, 0x2F, 0xFD, 0x20, 2,    0x11, 0, 0, 5, 6}),
            Status::corrupt);
  EXPECT_EQ(keyframe(2, {0x02, 0x28, 0xB5, 0x2F, 0xFD, 0x20, 2, 0x11, 0, 0, 5, 6}), Status::ok);
  EXPECT_EQ(keyframe(3, {0}), Status::backend_missing);
  EXPECT_EQ(keyframe(255, {0}), Status::backend_missing);
}

}  // namespace
}  // namespace gicodec
