// Instruction sets through the public API: each gives the same bytes and texels with every backend
// and format, and a session runs no kernel of another set than the one that it was given.
#include "base/checksum.h"
#include "distinct_formats.h"
#include "support.h"
#include "trap_kernels.h"

#include <gicodec/textures.h>

#include <gtest/gtest.h>

#include <cstdlib>

namespace gicodec {
namespace {

using namespace test;

/// Packets of a keyframe and an update with stale guard bands, by one instruction set.
std::vector<Packet> encode_with(Isa isa, const TextureDesc& desc, const Coding& coding) {
  Random random(61);
  Texture texture(desc);
  texture.fill(Fill::noise, random);
  auto options = options_of(coding);
  options.settings.isa = isa;
  auto encoder = *Encoder::create(desc, options);
  std::vector<Packet> packets;
  for (int frame = 0; frame < 2; ++frame) {
    packets.push_back(*encoder.encode(std::as_const(texture).view()));
    for (std::uint32_t block = 0; block < block_count(desc); block += 2) {
      texture.fill_block(block, Fill::special, random);
      if (block % 3 == 0) texture.fill_band(block);
    }
  }
  return packets;
}

/// Guard bands and all, after each packet.
std::vector<Bytes> decode_with(Isa isa, const TextureDesc& desc,
                               const std::vector<Packet>& packets) {
  DecoderOptions options;
  options.isa = isa;
  auto decoder = *Decoder::create(desc, options);
  std::vector<Bytes> textures;
  Texture out(desc);
  for (const auto& packet : packets) {
    EXPECT_EQ(decoder.decode(packet, out.view()), Status::ok);
    EXPECT_TRUE(out.blocks() == contents(decoder));
    textures.push_back(out.blocks());
  }
  return textures;
}

constexpr Coding kIsaCodings[] = {
    {"raw", 0, true}, {"lz4", 0, true}, {"zstd", 0, true}, {"native", 0, true, "fast"}};
constexpr Coding kStrong{"native", 0, true, "strong"};

struct Case {
  TextureDesc desc;
  Coding coding;
};
/// Every format and backend, each kind of kernel at least once.
std::vector<Case> cases() {
  std::vector<Case> all;
  for (const auto& info : test::distinct_formats()) {
    const TextureDesc desc = probe_texture(info.record, {3, 2, 2}, 5, 1, Tiling::slices_xz_y);
    for (const auto& coding : kIsaCodings) {
      all.push_back({desc, coding});
    }
  }
  for (const auto& coding : kIsaCodings) {
    all.push_back({ddgi_irradiance({4, 3, 2}), coding});
    all.push_back({ddgi_visibility({2, 1, 2}), coding});
  }
  all.push_back({ddgi_irradiance({3, 2, 2}), kStrong});
  all.push_back({ddgi_visibility({2, 1, 1}), kStrong});
  return all;
}

TEST(Isa, EverySetGivesTheSameBytesAndTexels) {
  for (const auto& [desc, coding] : cases()) {
    const auto packets = encode_with(Isa::scalar, desc, coding);
    const auto textures = decode_with(Isa::scalar, desc, packets);
    for (const Isa isa : supported_isas().subspan(1)) {
      EXPECT_TRUE(encode_with(isa, desc, coding) == packets)
          << desc << " " << coding.backend << " " << to_string(isa);
      EXPECT_TRUE(decode_with(isa, desc, packets) == textures)
          << desc << " " << coding.backend << " " << to_string(isa);
    }
  }
}

/// Both ends, and enough probes for a chunk or more per thread.
TEST(Isa, ThreadsDoNotChangeBytesOrTexels) {
  const TextureDesc desc =
      probe_texture(Format::A2B10G10R10_UNORM_PACK32, {16, 16, 10}, 1, 1, Tiling::atlas_xy_z);
  Random random(63);
  Texture texture(desc);
  texture.fill(Fill::small, random);
  auto options = options_of({"native", 0, true});
  const auto packet = *Encoder::create(desc, options)->encode(std::as_const(texture).view());
  for (const unsigned threads : {2U, 3U, 8U}) {
    options.settings.threads = threads;
    EXPECT_TRUE(*Encoder::create(desc, options)->encode(std::as_const(texture).view()) == packet);
    DecoderOptions decoding;
    decoding.threads = threads;
    auto decoder = *Decoder::create(desc, decoding);
    ASSERT_EQ(decoder.decode(packet), Status::ok);
    EXPECT_TRUE(contents(decoder) == texture.blocks());
  }
}

/// What depends on no third-party library is the same wherever the library runs. A change of what
/// the encoder chooses changes the numbers; another machine or compiler must not.
TEST(Isa, MachinesDoNotChangeBytes) {
  constexpr std::pair<Coding, std::uint32_t> kExpected[] = {
      {{"raw", 0, true}, 817718859},
      {{"native", 0, true, "fast"}, 4222012036},
      {kStrong, 287243258},
      {{"native", 0, true, "turbo"}, 3520221391}};
  for (const auto& [coding, expected] : kExpected) {
    Bytes all;
    for (const std::uint32_t number :
         {9,  13, 16, 24,  37,  38,  41,  44,  58,  64,  70,  74,  76, 83,
          91, 97, 98, 100, 103, 106, 109, 122, 123, 143, 144, 145, 146}) {
      const Record record(static_cast<Format>(number));
      const TextureDesc probes = probe_texture(record, {3, 4, 3}, 4, 1, Tiling::atlas_xy_z);
      for (const auto& desc : {probes, map_texture(record, {40, 37, 2}, {4, 4, 1})}) {
        auto encoder = *Encoder::create(desc, options_of(coding));
        Random random(64);
        Texture texture(desc);
        for (const Fill fill : {Fill::small, Fill::special}) {
          texture.fill(fill, random);
          const auto packet = *encoder.encode(std::as_const(texture).view());
          all.insert(all.end(), packet.begin(), packet.end());
        }
      }
    }
    EXPECT_EQ(checksum(all), expected) << coding.backend << coding.preset;
  }
}

TEST(Isa, ASetThatTheMachineLacksIsRefused) {
  constexpr auto kUnknown = static_cast<Isa>(200);
  const auto desc = ddgi_irradiance({2, 2, 2});
  for (const auto& coding : kIsaCodings) {
    auto options = options_of(coding);
    options.settings.isa = kUnknown;
    EXPECT_EQ(Encoder::create(desc, options).status(), Status::invalid_settings) << coding.backend;
  }
  DecoderOptions decoder;
  decoder.isa = kUnknown;
  EXPECT_EQ(Decoder::create(desc, decoder).status(), Status::invalid_settings);
  for (const Backend* backend : built_in_backends()) {
    BackendSettings settings;
    settings.isa = kUnknown;
    EXPECT_EQ(backend->make_encoder(desc, settings).status(), Status::invalid_settings)
        << backend->name();
    DecodeJob job{desc, {}, {}, {}, {}, true};
    job.isa = kUnknown;
    EXPECT_EQ((*backend->make_decoder(desc))->decode(job), Status::invalid_settings)
        << backend->name();
  }
}

#if defined(GICODEC_TRAPS)

/// Some of each with one set. Ends the process.
[[noreturn]] void run_with(Isa isa) {
  for (const auto& [desc, coding] : cases()) {
    const bool of_interest = desc.block.x > 5 ||
                             desc.record.format == Format::R32G32B32A32_SFLOAT ||
                             desc.record.format == Format::B10G11R11_UFLOAT_PACK32;
    if (of_interest) decode_with(isa, desc, encode_with(isa, desc, coding));
  }
  std::_Exit(testing::Test::HasFailure() ? 1 : 0);
}

class IsaOf : public testing::TestWithParam<Isa> {};

TEST_P(IsaOf, SessionsUseItAndNoOther) {
  const auto with_traps_in_the_others = [] {
    for (const Isa other : supported_isas()) {
      if (other != GetParam()) trap_kernels(other);
    }
    run_with(GetParam());
  };
  EXPECT_EXIT(with_traps_in_the_others(), testing::ExitedWithCode(0), "");
}

/// The traps work, and each kind of kernel is reached: with one table trapped, nothing gets by.
TEST_P(IsaOf, ItsKernelsAreReached) {
  const auto with_texel_traps = [] {
    trap_texel_kernels(GetParam());
    run_with(GetParam());
  };
  const auto with_native_traps = [] {
    trap_native_kernels(GetParam());
    run_with(GetParam());
  };
  EXPECT_EXIT(with_texel_traps(), testing::KilledBySignal(SIGTRAP), "");
  EXPECT_EXIT(with_native_traps(), testing::KilledBySignal(SIGTRAP), "");
}

INSTANTIATE_TEST_SUITE_P(All, IsaOf, testing::ValuesIn(supported_isas()),
                         [](const auto& test) { return std::string(to_string(test.param)); });

#endif

}  // namespace
}  // namespace gicodec
