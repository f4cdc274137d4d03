// Bounded errors: what encoders make of records, and what decoders get, in every format.
#include "quantise/error_grid.h"
#include "shapes.h"
#include "support.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

namespace gicodec {
namespace {

using namespace test;

constexpr float kErrors[] = {0, 1, 2, 3, 7, 100, 1e6F, 0.0009F, 0.001F, 0.02F, 0.9F};

float any_error(Random& random) { return kErrors[random() % std::size(kErrors)]; }
const FormatInfo& any_format(Random& random) { return formats()[random() % formats().size()]; }

/// Records of random bits; in some, components that are special in floats or the least and largest.
Bytes any_records(Random& random, const Record& record, std::size_t count) {
  Bytes bytes = noise(random, count * record.bytes);
  for (std::size_t at = 0; at < bytes.size(); at += record.bytes) {
    if (!chance(random, 3)) continue;
    constexpr std::uint8_t kBytes[] = {0x00, 0x80, 0xFF, 0x7F, 0x7C, 0xFC, 0x01, 0x7B};
    for (std::size_t i = 0; i < record.bytes; ++i) bytes[at + i] = std::byte{kBytes[random() % 8]};
  }
  return bytes;
}

/// A little else than before.
void drift(Random& random, const Record& record, Bytes& records) {
  for (std::size_t at = 0; at < records.size(); at += record.bytes) {
    if (chance(random, 2)) records[at] ^= std::byte(random() % 4);
  }
}

RC_GTEST_PROP(ErrorBound, KeepsToTheBoundAndToWhatIsHeld, (std::uint64_t seed)) {
  Random random(seed);
  const Record& record = any_format(random).record;
  const float error = any_error(random);
  const ErrorGrid grid(record, error);
  RC_ASSERT(grid.exact() == !allows_error(record, error));
  const Bytes first = any_records(random, record, 50);
  Bytes held = first;
  grid.apply(held, {});
  RC_ASSERT(within_error(record, first, held, error));
  // The same source, and what is near enough, changes nothing.
  Bytes again = first;
  grid.apply(again, held);
  RC_ASSERT(again == held);
  for (int frame = 0; frame < 10; ++frame) {
    Bytes given = first;
    drift(random, record, given);
    Bytes moved = given;
    grid.apply(moved, held);
    RC_ASSERT(within_error(record, given, moved, error));
    if (within_error(record, given, held, error)) RC_ASSERT(moved == held);
    held = moved;
  }
}

/// What follows its source is as far off as what it was made from, or on the grid.
RC_GTEST_PROP(ErrorBound, FollowsWithinTheBound, (std::uint64_t seed)) {
  Random random(seed);
  const Record& record = any_format(random).record;
  const float error = any_error(random);
  const ErrorGrid grid(record, error);
  Bytes before = any_records(random, record, 50), held = before;
  grid.apply(held, {});
  RC_ASSERT(grid.holds(held));
  for (int frame = 0; frame < 10; ++frame) {
    Bytes given = before;
    if (chance(random, 3)) drift(random, record, given);
    Bytes moved = given;
    grid.apply(moved, held, before);
    RC_ASSERT(within_error(record, given, moved, error));
    if (given == before) RC_ASSERT(moved == held);
    before = given;
    held = moved;
  }
}

/// Colour with noise of its own of which all or half gets brighter by a code in each of ten frames.
TEST(ErrorBound, LightThatMovesSlowlyTakesNoMoreThanWithoutABound) {
  const TextureDesc desc = probe_texture(Format::A2B10G10R10_UNORM_PACK32, {16, 4, 4}, 8, 0);
  constexpr std::uint32_t kGrey = 1 + (1 << 10) + (1 << 20);
  for (const bool half : {false, true}) {
    for (const char* backend : {"native", "zstd", "lz4"}) {
      std::size_t sizes[3] = {};
      for (const float error : {0.0F, 1.0F, 2.0F}) {
        EncoderOptions options;
        options.backend = backend;
        options.max_error = error;
        auto encoder = *Encoder::create(desc, options);
        Random random(1);
        Texture texture(desc);
        std::vector<std::uint32_t> texels(record_count(desc.block));
        std::vector<Bytes> blocks;
        for (std::uint32_t block = 0; block < block_count(desc); ++block) {
          for (auto& texel : texels) texel = pick(random, 100, 140) * kGrey;
          const auto bytes = std::as_bytes(std::span(texels));
          blocks.emplace_back(bytes.begin(), bytes.end());
        }
        for (int frame = 0; frame < 10; ++frame) {
          for (std::uint32_t block = 0; block < blocks.size(); ++block) {
            std::memcpy(texels.data(), blocks[block].data(), blocks[block].size());
            const bool moves = !half || block % 16 >= 8;
            for (auto& texel : texels) texel += moves ? kGrey : 0;
            std::memcpy(blocks[block].data(), texels.data(), blocks[block].size());
            texture.set_block(block, blocks[block]);
          }
          sizes[static_cast<int>(error)] += encoder.encode(texture.view())->size();
        }
      }
      EXPECT_LT(sizes[1], sizes[0]) << backend << half;
      EXPECT_LT(sizes[2], sizes[1]) << backend << half;
    }
  }
}

TEST(ErrorBound, UnitsOfEachKind) {
  const auto units = [](Format format, std::size_t component, float error) {
    return error_units(find_format(format)->record.components[component], error);
  };
  EXPECT_EQ(units(Format::A2B10G10R10_UNORM_PACK32, 0, 2.9F), 2U);
  EXPECT_EQ(units(Format::A2B10G10R10_UNORM_PACK32, 0, 0.9F), 0U);
  EXPECT_EQ(units(Format::A2B10G10R10_UNORM_PACK32, 3, 5), 0U);
  EXPECT_EQ(units(Format::R16_SFLOAT, 0, 5), 5U);
  EXPECT_EQ(units(Format::R16_SFLOAT, 0, 1.0F / 256), 4U);
  EXPECT_EQ(units(Format::R32_SFLOAT, 0, 1.0F / 256), 32768U);
  EXPECT_EQ(units(Format::B10G11R11_UFLOAT_PACK32, 0, 1.0F / 16), 4U);
  EXPECT_EQ(units(Format::B10G11R11_UFLOAT_PACK32, 2, 1.0F / 16), 2U);
  EXPECT_EQ(units(Format::E5B9G9R9_UFLOAT_PACK32, 0, 3), 3U);
  EXPECT_EQ(units(Format::E5B9G9R9_UFLOAT_PACK32, 3, 3), 0U);
  EXPECT_EQ(units(Format::BC7_UNORM_BLOCK, 0, 3), 0U);
  for (const float bad : {-1.0F, std::numeric_limits<float>::infinity(), std::nanf("")}) {
    EXPECT_FALSE(valid_error(bad));
  }
}

TEST(ErrorBound, SpecialFloatsAreExact) {
  const Record& record = find_format(Format::R16_SFLOAT)->record;
  for (const float error : {1.0F, 100.0F, 0.5F}) {
    const ErrorGrid grid(record, error);
    for (const unsigned code : {0x0000U, 0x8000U, 0x7C00U, 0xFC00U, 0x7C01U, 0x7E00U, 0xFFFFU}) {
      const Bytes given = {std::byte(code & 255), std::byte(code >> 8)};
      for (const unsigned before : {0x0001U, 0x8001U, 0x7BFFU, 0xFBFFU, 0x7E01U}) {
        Bytes records = given;
        grid.apply(records, Bytes{std::byte(before & 255), std::byte(before >> 8)});
        EXPECT_EQ(records, given) << code;
      }
    }
    // The largest finite value stays finite, a small one of either sign near zero.
    Bytes largest = {std::byte{0xFF}, std::byte{0x7B}};
    const Bytes given = largest;
    grid.apply(largest, {});
    EXPECT_TRUE(within_error(record, given, largest, error));
  }
}

RC_GTEST_PROP(ErrorBound, DecodersAreWithinIt, (std::uint64_t seed)) {
  Random random(seed);
  const TextureDesc desc = any_desc(random, 3000);
  EncoderOptions options;
  const char* const backends[] = {"native", "zstd", "lz4", "raw"};
  options.backend = backends[random() % 4];
  options.max_error = any_error(random);
  options.gop = pick(random, 0, 3);
  auto encoder = Encoder::create(desc, options);
  RC_ASSERT(encoder.ok());
  const bool lossy = allows_error(desc.record, options.max_error);
  RC_ASSERT(encoder->lossy() == lossy);
  auto decoder = *Decoder::create(desc, {});
  auto presence = any_presence(random, desc);
  RC_ASSERT(encoder->set_presence(presence) == Status::ok);
  RC_ASSERT(decoder.set_presence(presence) == Status::ok);
  Texture texture(desc);
  texture.fill(Fill::noise, random);
  for (int frame = 0; frame < 4; ++frame) {
    if (frame < 3) {
      for (const auto block : random_selection(random, block_count(desc))) {
        texture.fill_block(block, chance(random, 2) ? Fill::noise : Fill::small, random);
        texture.fill_band(block);
      }
    }
    // The last frame is the one before it.
    const auto packet = encoder->encode(texture.view(), Selection::changed());
    RC_ASSERT(packet.ok());
    const auto info = peek(*packet);
    RC_ASSERT(info.ok());
    RC_ASSERT(info->lossy == lossy);
    if (frame == 3 && !is_keyframe(info->type)) RC_ASSERT(!info->all_blocks && info->blocks == 0U);
    RC_ASSERT(decoder.decode(*packet) == Status::ok);
    ExpectedMirror model(desc);
    std::vector<std::uint32_t> all(block_count(desc));
    for (std::uint32_t b = 0; b < all.size(); ++b) all[b] = b;
    model.apply(texture, true, all, presence);
    RC_ASSERT(within_error(desc.record, model.records(), decoder.records(), options.max_error));
    RC_ASSERT(contents(decoder) == contents(*encoder));
  }
}

/// Packets do not depend on contents that were never sent.
/// What exists moves on with its source, and what does not stays zero, wherever it was before.
RC_GTEST_PROP(ErrorBound, WhatDoesNotExistIsZero, (std::uint64_t seed)) {
  Random random(seed);
  TextureDesc desc = pool_texture(Format::R8G8B8A8_UNORM, 12, {12, 2, 2});
  desc.presence = static_cast<Presence>(pick(random, 1, 3));
  if (desc.presence == Presence::brick) desc.model = Model::octree;
  const char* const backends[] = {"native", "zstd", "lz4", "raw"};
  EncoderOptions options;
  options.backend = backends[random() % 4];
  options.max_error = static_cast<float>(pick(random, 1, 12));
  options.gop = 0;
  auto encoder = *Encoder::create(desc, options);
  auto decoder = *Decoder::create(desc, {});
  Bytes texels(texture_bytes(desc));
  for (std::uint32_t frame = 0; frame < 8; ++frame) {
    const auto presence = any_presence(random, desc);
    RC_ASSERT(encoder.set_presence(presence) == Status::ok);
    RC_ASSERT(decoder.set_presence(presence) == Status::ok);
    // Much light that moves a lot, and by the same everywhere.
    for (std::size_t i = 0; i < texels.size(); ++i) {
      texels[i] = static_cast<std::byte>(60 + i * 7 % 64 + frame % 3 * 34);
    }
    const auto packet = encoder.encode(std::span<const std::byte>(texels), Selection::all());
    RC_ASSERT(packet.ok());
    RC_ASSERT(decoder.decode(*packet) == Status::ok);
    RC_ASSERT(contents(decoder) == contents(encoder));
    for (std::uint32_t block = 0; block < block_count(desc); ++block) {
      Bytes records(decoder.records().begin() + block * block_bytes(desc),
                    decoder.records().begin() + (block + 1) * block_bytes(desc));
      const Bytes before = records;
      const std::size_t said = presence_bytes(desc);
      clear_absent_records(desc, std::span(presence).subspan(block * said, said), records);
      RC_ASSERT(records == before);
    }
  }
}

RC_GTEST_PROP(ErrorBound, FailedCallsLeaveNoTrace, (std::uint64_t seed)) {
  Random random(seed);
  const TextureDesc desc = probe_desc(random, 3000);
  EncoderOptions options;
  options.backend = chance(random, 2) ? "native" : "raw";
  options.max_error = any_error(random);
  auto encoder = *Encoder::create(desc, options), other = *Encoder::create(desc, options);
  Texture texture(desc);
  for (int frame = 0; frame < 4; ++frame) {
    Bytes few(random() % 3);
    for (const auto block : random_selection(random, block_count(desc))) {
      texture.fill_block(block, chance(random, 2) ? Fill::noise : Fill::small, random);
    }
    if (chance(random, 2)) {
      const auto failed = encoder.encode_to(texture.view(), Selection::changed(), std::span(few));
      RC_ASSERT(failed.status() == Status::buffer_too_small);
      if (chance(random, 2)) texture.fill(Fill::small, random);
    }
    RC_ASSERT(*encoder.encode(texture.view(), Selection::changed()) ==
              *other.encode(texture.view(), Selection::changed()));
  }
}

TEST(ErrorBound, IsValidatedAndNotForLossyBackends) {
  const TextureDesc desc = probe_texture(Format::R16_SFLOAT, {2, 2, 2}, 4);
  for (const float bad : {-1.0F, std::numeric_limits<float>::infinity(), std::nanf("")}) {
    EncoderOptions options;
    options.max_error = bad;
    EXPECT_EQ(Encoder::create(desc, options).status(), Status::invalid_bound);
  }
}

/// What a bound of E codes saves of white noise, of which native knows little: much of the bits of
/// its steps.
TEST(ErrorBound, NativeNeedsNotTheBitsOfMultiples) {
  Random random(1);
  for (const auto& [format, error, saved] :
       {std::tuple(Format::R16_SFLOAT, 8.0F, 4.0), std::tuple(Format::R32_SFLOAT, 1024.0F, 11.0),
        std::tuple(Format::R16_UNORM, 2.0F, 2.0)}) {
    const TextureDesc desc = probe_texture(format, {8, 8, 8}, 8, 0);
    Bytes texture = noise(random, texture_bytes(desc));
    // Finite.
    for (std::size_t i = desc.record.bytes - 1; i < texture.size(); i += desc.record.bytes) {
      texture[i] &= std::byte{0xBB};
    }
    std::size_t size[2] = {};
    for (const bool bounded : {false, true}) {
      EncoderOptions options;
      options.max_error = bounded ? error : 0;
      const auto packet =
          Encoder::create(desc, options)->encode(ConstTextureView(texture), Selection::all());
      size[bounded] = packet->size();
    }
    const double records = static_cast<double>(texture.size()) / desc.record.bytes;
    EXPECT_GT(8.0 * static_cast<double>(size[0] - size[1]), 0.4 * saved * records) << error;
  }
}

}  // namespace
}  // namespace gicodec
