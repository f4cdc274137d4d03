// Whatever allocation or thread fails in a call of an encoder or a decoder: the call says so,
// changed nothing, and succeeds when it is made again.
#include "faults.h"
#include "payload_conformance.h"
#include "shapes.h"
#include "support.h"

#include <gicodec/ao_points.h>
#include <gicodec/encoder.h>
#include <gicodec/volume_decoder.h>
#include <gicodec/volume_encoder.h>
#include <gicodec/voxels.h>

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <optional>
#include <vector>

namespace gicodec {
namespace {

using namespace test;

/// Visibility with stale guard bands, so that every section of a packet is there.
std::array<Texture, 3>& frames() {
  static std::array<Texture, 3> textures = [] {
    const TextureDesc desc = probe_texture(Format::R16G16_SFLOAT, {2, 2, 1}, 2, 1);
    return std::array<Texture, 3>{Texture(desc), Texture(desc), Texture(desc)};
  }();
  static const bool filled = [] {
    Random random(5);
    for (Texture& texture : textures) {
      texture.fill(Fill::small, random);
      texture.set_block(1, noise(random, texture.block(1).size()));
    }
    return true;
  }();
  EXPECT_TRUE(filled);
  return textures;
}

/// Makes a call until it succeeds; `unchanged` is looked at after each failure.
template <typename Call, typename Unchanged>
auto insist(Fault& fault, Call&& call, Unchanged&& unchanged) {
  auto result = fault(call);
  const auto status_of = [](const auto& r) {
    if constexpr (requires { r.status(); }) {
      return r.status();
    } else {
      return r;
    }
  };
  if (status_of(result) == Status::ok) return result;
  EXPECT_EQ(status_of(result), Status::out_of_memory);
  EXPECT_TRUE(fault.failed());
  EXPECT_TRUE(unchanged());
  return call();
}
constexpr auto kNothing = [] { return true; };

/// A new decoder gets the texture out of its first packet.
void decode_first(Fault& fault, const DecoderOptions& options, const Packet& packet,
                  const Texture& texture) {
  auto decoder = *Decoder::create(texture.desc(), options);
  Texture out(texture.desc());
  const Status status = insist(
      fault, [&] { return decoder.decode(packet, out.view()); },
      [&] { return decoder.sequence() == 0; });
  ASSERT_EQ(status, Status::ok);
  ASSERT_EQ(out.blocks(), texture.blocks());
}

class CodecFaults : public testing::TestWithParam<Coding> {
 protected:
  static void encode_and_decode(Fault& fault, unsigned threads) {
    EncoderOptions options = options_of(GetParam());
    options.settings.threads = threads;
    const TextureDesc& desc = frames()[0].desc();
    auto encoder = insist(
        fault, [&] { return Encoder::create(desc, options); }, kNothing);
    ASSERT_TRUE(encoder.ok());
    DecoderOptions decoding;
    decoding.threads = threads;
    auto decoder = insist(
        fault, [&] { return Decoder::create(desc, decoding); }, kNothing);
    auto late = Decoder::create(desc, decoding);
    ASSERT_TRUE(decoder.ok() && late.ok());
    Texture out(desc);
    const auto decode = [&](std::span<const std::byte> packet, const Texture& frame) {
      const auto before = std::pair(decoder->state_hash(), decoder->sequence());
      const Bytes texels = out.blocks();
      const Status status = insist(
          fault, [&] { return decoder->decode(packet, out.view()); },
          [&] {
            return before == std::pair(decoder->state_hash(), decoder->sequence()) &&
                   texels == out.blocks();
          });
      ASSERT_EQ(status, Status::ok);
      ASSERT_EQ(out.blocks(), frame.blocks());
    };
    for (std::uint32_t i = 0; i < frames().size(); ++i) {
      const auto view = std::as_const(frames()[i]).view();
      const auto packet = insist(
          fault, [&] { return encoder->encode(view); }, [&] { return encoder->sequence() == i; });
      ASSERT_TRUE(packet.ok());
      ASSERT_EQ(is_keyframe(peek(*packet)->type), i == 0);
      decode(*packet, frames()[i]);
    }
    const auto snapshot = insist(
        fault, [&] { return encoder->snapshot(); }, [&] { return encoder->sequence() == 3; });
    ASSERT_TRUE(snapshot.ok());
    ASSERT_EQ(late->decode(*snapshot), Status::ok);
    ASSERT_EQ(late->state_hash(), decoder->state_hash());
    // As an update, and into the caller's memory.
    std::vector<std::byte> room(encoder->bound(block_count(desc)));
    const std::vector<std::uint32_t> some{3, 1};
    const auto view = std::as_const(frames()[0]).view();
    const auto size = insist(
        fault, [&] { return encoder->encode_to(view, some, std::span<std::byte>(room)); },
        [&] { return encoder->sequence() == 3; });
    ASSERT_TRUE(size.ok());
    ASSERT_EQ(late->decode(std::span(room).first(*size)), Status::ok);
    const std::vector<std::uint8_t> active(block_count(desc), 1);
    ASSERT_EQ(insist(
                  fault, [&] { return encoder->set_active(active); }, kNothing),
              Status::ok);
  }
};

TEST_P(CodecFaults, ChangeNothing) {
  const std::size_t faults = with_every_fault([](Fault& fault) { encode_and_decode(fault, 1); });
  EXPECT_GT(faults, 40U);
}

INSTANTIATE_TEST_SUITE_P(
    Codings, CodecFaults,
    testing::Values(Coding{"raw", 0, true}, Coding{"lz4", 1, true}, Coding{"lz4", 12, true},
                    Coding{"zstd", 1, true}, Coding{"native", 0, true, "turbo"},
                    Coding{"native", 0, true, "fast"}, Coding{"native", 0, true, "strong"}),
    [](const auto& test) {
      return std::string(test.param.backend) + std::to_string(test.param.level) + test.param.preset;
    });

/// Chunks on threads of their own, some of which cannot be started.
TEST(CodecThreadFaults, ChangeNothing) {
  const TextureDesc desc = probe_texture(Format::R16_SFLOAT, {16, 16, 12}, 1, 0);
  Random random(6);
  Texture texture(desc);
  texture.fill(Fill::noise, random);
  EncoderOptions options;
  options.settings.threads = 3;
  DecoderOptions decoding;
  decoding.threads = 3;
  const auto view = std::as_const(texture).view();
  const std::size_t faults = with_every_fault([&](Fault& fault) {
    auto encoder = *Encoder::create(desc, options);
    const auto packet = insist(
        fault, [&] { return encoder.encode(view); }, kNothing);
    ASSERT_TRUE(packet.ok());
    decode_first(fault, decoding, *packet, texture);
  });
  EXPECT_GT(faults, 40U);
}

/// Strip, mirror and views, too.
TEST(CodecThreadFaults, ChangeNothingAroundThePayload) {
  const TextureDesc desc = probe_texture(Format::R32G32B32A32_SFLOAT, {6, 6, 2}, 64, 1);
  Random random(7);
  Texture texture(desc);
  texture.fill(Fill::small, random);
  texture.set_block(3, noise(random, texture.block(3).size()));
  Texture out(desc);
  EncoderOptions options = options_of({"raw", 0, true});
  options.settings.threads = 3;
  DecoderOptions decoding;
  decoding.threads = 3;
  const auto view = std::as_const(texture).view();
  const std::size_t faults = with_every_fault([&](Fault& fault) {
    auto encoder = *Encoder::create(desc, options);
    const auto packet = insist(
        fault, [&] { return encoder.encode(view); }, kNothing);
    ASSERT_TRUE(packet.ok());
    auto decoder = *Decoder::create(desc, decoding);
    const Status status = insist(
        fault, [&] { return decoder.decode(*packet, out.view()); },
        [&] { return decoder.sequence() == 0; });
    ASSERT_EQ(status, Status::ok);
    ASSERT_EQ(fault([&] { return decoder.read(out.view()); }), Status::ok);
    ASSERT_TRUE(same(out.view().bytes, view.bytes));
  });
  EXPECT_GT(faults, 40U);
}

/// Under a bound a packet depends on those before it: what a failed call left would show.
TEST(CodecFaultsBounded, LeavePacketsAsTheyAre) {
  for (const float max_error : {0.0F, 3.0F}) {
    const TextureDesc& desc = frames()[0].desc();
    EncoderOptions options;
    options.max_error = max_error;
    auto sound = *Encoder::create(desc, options);
    std::vector<Packet> packets;
    for (const Texture& frame : frames()) packets.push_back(*sound.encode(frame.view()));
    const std::size_t faults = with_every_fault([&](Fault& fault) {
      auto encoder = *Encoder::create(desc, options);
      for (std::size_t i = 0; i < packets.size(); ++i) {
        const auto view = std::as_const(frames()[i]).view();
        ASSERT_EQ(*insist(
                      fault, [&] { return encoder.encode(view); }, kNothing),
                  packets[i]);
      }
    });
    EXPECT_GT(faults, 20U);
  }
}

/// Tables that a chunk brings along go where there was no memory for them before.
TEST(CodecFaultsOverrides, LeaveWholeTables) {
  const TextureDesc desc = probe_texture(Format::A2B10G10R10_UNORM_PACK32, {8, 8, 4}, 6, 1);
  Texture texture(desc);
  Random random(12);
  for (std::uint32_t block = 0; block < block_count(desc); ++block) {
    std::vector<std::byte> records = texture.block(block);
    for (std::size_t i = 0; i < records.size(); i += 4) {
      const std::size_t slope = i / 4 % 6 * (block % 13) + i / 24 * (block % 9);
      std::uint32_t word = 0;
      for (unsigned c = 0; c < 3; ++c) {
        word = word << 10 | static_cast<std::uint32_t>(2 * block + slope + random() % 2 * 7);
      }
      std::memcpy(&records[i], &word, sizeof word);
    }
    texture.set_block(block, records);
    texture.fill_band(block);
  }
  EncoderOptions options;
  options.settings.preset = "fast";
  PayloadStatistics statistics;
  DecoderOptions decoding;
  decoding.statistics = &statistics;
  const auto packet = Encoder::create(desc, options)->encode(std::as_const(texture).view());
  ASSERT_TRUE(packet.ok());
  with_every_fault([&](Fault& fault) { decode_first(fault, decoding, *packet, texture); });
  EXPECT_GT(statistics.table_bytes, 0U);
}

/// Models that learn are made for the first chunk that has them; bricks are listed by their places.
void learn_as_if_nothing_had_failed(const TextureDesc& desc) {
  std::array<Texture, 2> textures{Texture(desc), Texture(desc)};
  Random random(9);
  for (Texture& texture : textures) texture.fill(Fill::small, random);
  const Bytes presence = full_presence(desc);
  auto sound = *Encoder::create(desc, {});
  ASSERT_EQ(sound.set_presence(presence), Status::ok);
  std::vector<Packet> packets;
  for (const Texture& texture : textures) packets.push_back(*sound.encode(texture.view()));
  with_every_fault([&](Fault& fault) {
    auto encoder = *Encoder::create(desc, {});
    auto decoder = *Decoder::create(desc);
    ASSERT_EQ(insist(
                  fault, [&] { return encoder.set_presence(presence); }, kNothing),
              Status::ok);
    ASSERT_EQ(decoder.set_presence(presence), Status::ok);
    Texture out(desc);
    for (std::size_t i = 0; i < packets.size(); ++i) {
      const auto view = std::as_const(textures[i]).view();
      ASSERT_EQ(*insist(
                    fault, [&] { return encoder.encode(view); }, kNothing),
                packets[i]);
      ASSERT_EQ(insist(
                    fault, [&] { return decoder.decode(packets[i], out.view()); }, kNothing),
                Status::ok);
      ASSERT_EQ(out.blocks(), textures[i].blocks());
    }
  });
}

/// Nothing of an update is kept if one of its textures fails.
TEST(CodecFaultsVolume, GoesOnAsIfNothingHadFailed) {
  const VolumeDesc volume = scene_volume(4);
  std::array<Contents, 3> updates{blank(volume), blank(volume), blank(volume)};
  Generator random(11);
  for (std::size_t i = 0; i < updates.size(); ++i) {
    if (i > 0) updates[i] = updates[i - 1];
    change(volume, updates[i], random);
  }
  const auto views = [](const Contents& contents) {
    return std::vector<ConstTextureView>(contents.begin(), contents.end());
  };
  auto sound = *VolumeEncoder::create(volume);
  auto follower = *VolumeDecoder::create(volume);
  std::vector<std::vector<Packet>> packets;
  for (const Contents& contents : updates) {
    packets.push_back(*sound.encode(views(contents)));
    ASSERT_EQ(follower.decode(packets.back()), Status::ok);
  }
  const BlockMask active(4, 1);
  with_every_fault([&](Fault& fault) {
    auto encoder = insist(
        fault, [&] { return VolumeEncoder::create(volume); }, kNothing);
    auto decoder = insist(
        fault, [&] { return VolumeDecoder::create(volume); }, kNothing);
    for (std::size_t i = 0; i < updates.size(); ++i) {
      const auto given = views(updates[i]);
      ASSERT_EQ(*insist(
                    fault, [&] { return encoder->encode(given); }, kNothing),
                packets[i]);
      ASSERT_EQ(insist(
                    fault, [&] { return decoder->decode(packets[i]); }, kNothing),
                Status::ok);
    }
    for (std::uint8_t t = 0; const Decoder* one = follower.decoder(t); ++t) {
      ASSERT_EQ(decoder->decoder(t)->state_hash(), one->state_hash());
    }
    ASSERT_TRUE(insist(
                    fault, [&] { return encoder->snapshot(); }, kNothing)
                    .ok());
    ASSERT_EQ(insist(
                  fault, [&] { return encoder->set_active(0, active); }, kNothing),
              Status::ok);
  });
}

TEST(CodecFaultsAdaptive, CellsLearnAsIfNothingHadFailed) {
  learn_as_if_nothing_had_failed(ao_point_volume(64, 8, 1)->groups[0].textures[0].desc);
}

TEST(CodecFaultsAdaptive, VoxelsLearnAsIfNothingHadFailed) {
  learn_as_if_nothing_had_failed(voxel_volume(12)->groups[0].textures[1].desc);
}

}  // namespace
}  // namespace gicodec
