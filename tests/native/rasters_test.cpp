// Continuous textures: rows that reach over blocks, adaptive (docs/native/continuous.md) and fast
// (docs/native/rows.md).
#include "base/binary_coder.h"
#include "distinct_formats.h"
#include "native/content.h"
#include "native/frame/chunk_head.h"
#include "native/models/continuous/light_scale.h"
#include "native/reference_decoder.h"
#include "native/round_trip.h"
#include "native/tokens/token_head.h"
#include "quantise/component_code.h"
#include "shapes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace gicodec {
namespace {

using test::Bytes;

native::PayloadSettings strong() {
  native::PayloadSettings settings;
  settings.chunk.preset = native::Preset::strong;
  settings.chunk.others = false;
  return settings;
}

TextureDesc map_texture(Format format, Grid grid, std::array<std::uint8_t, 3> block) {
  TextureDesc desc = probe_texture(format, grid, block[0], 0);
  desc.block.y = block[1];
  desc.block.z = block[2];
  desc.model = Model::continuous;
  return desc;
}

/// How bright a texel of the whole texture is, 0 to 1: smooth, with flat parts.
double light(double x, double y, double z, unsigned frame) {
  const double wave = 0.5 + 0.4 * std::sin(0.07 * x + 0.3 * z + 0.01 * frame) * std::cos(0.05 * y);
  return std::fmod(x + y, 32.0) < 8.0 ? 0.25 : wave;
}

/// Codes of a picture over all blocks: code(component, light, noise).
template <typename Code>
Bytes picture(const TextureDesc& desc, unsigned frame, const Code& code) {
  test::Random random(1);  // a bake repeats its noise
  const std::size_t size = desc.record.bytes, records = record_count(desc.block);
  Bytes out(block_count(desc) * records * size);
  for (std::size_t i = 0; i < block_count(desc) * records; ++i) {
    const std::size_t b = i / records, r = i % records;
    const auto &grid = desc.grid, at = Grid{static_cast<std::uint32_t>(b % grid.x),
                                            static_cast<std::uint32_t>(b / grid.x % grid.y),
                                            static_cast<std::uint32_t>(b / grid.x / grid.y)};
    const double x = static_cast<double>(at.x * desc.block.x + r % desc.block.x);
    const double y = static_cast<double>(at.y * desc.block.y + r / desc.block.x % desc.block.y);
    const double z = static_cast<double>(at.z * desc.block.z + r / desc.block.x / desc.block.y);
    const double bright = light(x, y, z, frame);
    const double noise = bright == 0.25 ? 0 : static_cast<double>(random() % 8) / 2048;
    for (unsigned c = 0; c < desc.record.count; ++c) {
      set_code(out.data() + i * size, desc.record.components[c], size, code(c, bright, noise));
    }
  }
  return out;
}

std::uint32_t code_of_light(const Component& component, double value) {
  const double scale = component.type == ComponentType::sfloat ? 0.4 : 0.9;
  return static_cast<std::uint32_t>(largest_code(component) * value * scale);
}

test::UpdateCase update_of(const TextureDesc& desc, bool keyframe, bool intra) {
  const auto code = [&](unsigned c, double bright, double noise) {
    return code_of_light(desc.record.components[c], bright / (1 + c) + noise);
  };
  auto u = test::make_update(desc, test::Content::constant, true, 1, 1);
  u.records = picture(desc, 1, code);
  u.mirror = picture(desc, 0, code);
  u.received.assign(block_count(desc), 1);
  if (keyframe && !intra) u.mirror.clear();
  u.keyframe = keyframe;
  u.intra = intra;
  // Some blocks stay as they are.
  const std::size_t size = block_bytes(desc);
  Bytes kept;
  std::vector<std::uint32_t> blocks;
  for (const auto block : u.blocks) {
    if (block % 5 == 3) continue;
    blocks.push_back(block);
    const auto from = u.records.begin() + static_cast<std::ptrdiff_t>(block * size);
    kept.insert(kept.end(), from, from + static_cast<std::ptrdiff_t>(size));
  }
  u.blocks = blocks;
  u.records = kept;
  return u;
}

/// Not by planes, which are smaller where there is little.
native::PayloadSettings rows() {
  native::PayloadSettings settings;
  settings.chunk.others = false;
  return settings;
}

/// Of its first chunk.
std::byte kind_of(const test::UpdateCase& u, const Bytes& payload) {
  native::PayloadMemory memory;
  EXPECT_EQ(native::check_payload(u.desc, u.blocks.size(), payload, memory), Status::ok);
  return memory.head.chunks[0].front();
}
bool is_adaptive(const test::UpdateCase& u, const Bytes& payload) {
  return kind_of(u, payload) == std::byte{native::kAdaptiveChunk};
}
bool is_rows(const test::UpdateCase& u, const Bytes& payload) {
  return kind_of(u, payload) == std::byte{native::kRowChunk};
}
/// Of tokens whose rows continue.
bool continues(const test::UpdateCase& u, const Bytes& payload) {
  const auto first = std::to_integer<unsigned>(kind_of(u, payload));
  return (first & 3) == native::kTokenChunk && (first & native::kContinues) != 0;
}
native::PayloadSettings turbo() {
  native::PayloadSettings settings;
  settings.chunk.preset = native::Preset::turbo;
  return settings;
}

TEST(NativeRasters, EveryFormat) {
  test::Sweep sweep;
  for (const auto& format : test::distinct_formats()) {
    if (format.width > 1) continue;  // compressed blocks are no values
    const TextureDesc desc = map_texture(format.record.format, {3, 2, 2}, {4, 5, 2});
    for (const auto& [keyframe, intra] : {std::pair{true, false}, {true, true}, {false, false}}) {
      if (!sweep.takes()) continue;
      const auto u = update_of(desc, keyframe, intra);
      SCOPED_TRACE(format.name);
      EXPECT_TRUE(is_adaptive(u, test::encode(u, strong(), best_isa())));
      check_everything(u, strong());
      const auto used = desc.record.used();
      const bool words = std::ranges::all_of(used, [](const auto& c) { return c.bits <= 16; });
      EXPECT_TRUE(!words || is_rows(u, test::encode(u, rows(), best_isa())));
      check_everything(u, rows());
      EXPECT_TRUE(!words || continues(u, test::encode(u, turbo(), best_isa())));
      check_everything(u, turbo());
    }
  }
}

/// What tokens say about rows that continue takes less than what they say about blocks alone, and
/// what is flat less than a bit for a texel.
TEST(NativeRasters, TokensOfMaps) {
  for (const bool flat : {false, true}) {
    auto u = update_of(map_texture(Format::R16_SFLOAT, {16, 16, 1}, {8, 8, 1}), true, false);
    if (flat) {
      for (std::size_t i = 0; i < u.records.size(); i += 2) {
        u.records[i] = std::byte{static_cast<std::uint8_t>(i < 256 ? i : 0)};
        u.records[i + 1] = std::byte{0x3C};
      }
    }
    auto alone = u;
    alone.desc.model = Model::stacked;
    const std::size_t size = test::encode(u, turbo(), best_isa()).size();
    EXPECT_LT(size, flat ? u.records.size() / 16 : test::encode(alone, turbo(), best_isa()).size());
    check_everything(u, turbo());
    check_everything(alone, turbo());
  }
}

/// Strips of more and fewer rows than lanes, of few columns and many, in one slice and several.
TEST(NativeRasters, StripsOfAnyShape) {
  struct Case {
    Format format;
    Grid grid;
    std::array<std::uint8_t, 3> block;
  };
  for (const auto& [format, grid, block] :
       {Case{Format::R16G16B16A16_SFLOAT, {1, 1, 1}, {1, 1, 1}},
        Case{Format::R8_UNORM, {1, 33, 1}, {1, 2, 1}},
        Case{Format::R8G8_UNORM, {3, 5, 1}, {64, 13, 1}},
        Case{Format::E5B9G9R9_UFLOAT_PACK32, {5, 9, 3}, {4, 4, 2}},
        Case{Format::B10G11R11_UFLOAT_PACK32, {2, 1, 7}, {9, 40, 1}},
        Case{Format::R32_SFLOAT, {6, 6, 6}, {4, 4, 4}},
        Case{Format::R16_SNORM, {1, 1, 1}, {2, 1, 64}}}) {
    for (const auto& [keyframe, intra] : {std::pair{true, false}, {true, true}, {false, false}}) {
      auto u = update_of(map_texture(format, grid, block), keyframe, intra);
      check_everything(u, rows());
      if (format != Format::R32_SFLOAT) continue;
      // Few values, which have places.
      for (std::size_t i = 0; i < u.records.size(); i += 4) {
        u.records[i] = u.records[i + 1] = u.records[i + 2] = std::byte{0};
      }
      EXPECT_TRUE(is_rows(u, test::encode(u, rows(), best_isa())));
      check_everything(u, rows());
    }
  }
}

TEST(NativeRasters, RecordsOfAnyComponents) {
  test::Random random(5);
  for (int round = 0; round < 120 / static_cast<int>(test::one_case_in()); ++round) {
    TextureDesc desc = map_texture(Format::R8_UNORM, {3, 4, 2}, {3, 2, 2});
    desc.record = test::custom_record(random, 24);
    const auto content = test::kContents[random() % std::size(test::kContents)];
    for (const auto& settings : {rows(), strong()}) {
      check_everything(test::any_update(desc, content, 1, random()), settings);
    }
  }
}

/// What is not there costs little, and is not what decides.
TEST(NativeRasters, RowsOfPartialTextures) {
  TextureDesc desc = map_texture(Format::R16G16B16A16_SFLOAT, {4, 4, 1}, {8, 8, 1});
  desc.presence = Presence::mask;
  for (const bool keyframe : {true, false}) {
    const auto u = test::make_update(desc, test::Content::smooth, keyframe, 1, 3);
    EXPECT_TRUE(is_rows(u, test::encode(u, rows(), best_isa())));
    check_everything(u, rows());
  }
}

TEST(NativeRasters, CompressedBlocksAreRecords) {
  const auto u =
      update_of(map_texture(Format::BC6H_UFLOAT_BLOCK, {3, 2, 1}, {4, 4, 1}), true, false);
  EXPECT_FALSE(native::takes_raster(u.desc));
  check_everything(u, strong());
}

/// What a texel is predicted from does not end with its block.
TEST(NativeRasters, SmallBlocksCostLittle) {
  const auto size = [](std::uint32_t grid, std::uint8_t side) {
    const TextureDesc desc =
        map_texture(Format::R16G16B16A16_SFLOAT, {grid, grid, 1}, {side, side, 1});
    auto u = test::make_update(desc, test::Content::constant, true, 1, 1);
    u.records = picture(desc, 0, [&](unsigned c, double bright, double noise) {
      return code_of_light(desc.record.components[c], bright / (1 + c) + noise);
    });
    check_everything(u, strong());
    return test::encode(u, strong(), best_isa()).size();
  };
  const std::size_t whole = size(2, 64);
  EXPECT_LE(size(32, 4), whole + whole / 32);
  EXPECT_GE(size(32, 4), whole - whole / 32);
}

/// Grey light costs one channel, what is constant nothing, and few values are told apart in places.
TEST(NativeRasters, FormsOfChannels) {
  const TextureDesc desc = map_texture(Format::R16G16B16A16_SFLOAT, {4, 4, 1}, {16, 16, 1});
  const auto size = [&](const auto& code) {
    auto u = test::make_update(desc, test::Content::constant, true, 1, 1);
    u.records = picture(desc, 0, code);
    check_everything(u, strong());
    return test::encode(u, strong(), best_isa()).size();
  };
  const auto grey = [](unsigned, double bright, double noise) {
    return static_cast<std::uint32_t>(0x3000 + 4096 * (bright + noise));
  };
  const std::size_t of_one = size([&](unsigned c, double bright, double noise) {
    return c == 1 ? grey(c, bright, noise) : 0x3C00U;
  });
  EXPECT_LE(size(grey), of_one + 4);
  const std::size_t sparse = size([&](unsigned c, double bright, double noise) {
    return c == 1 ? 61 * (grey(c, bright, noise) / 4 - 0x0A00) : 0x3C00U;
  });
  EXPECT_LE(sparse, of_one);
  EXPECT_EQ(size([](unsigned, double, double) { return 0x1234U; }), 10U);
}

/// What has more than 16 bits, and few values no more, is coded in halves.
TEST(NativeRasters, RowsOfHalves) {
  for (const Format format : {Format::R32_SFLOAT, Format::R32G32B32A32_SFLOAT, Format::R32_UINT}) {
    const TextureDesc desc = map_texture(format, {5, 3, 2}, {8, 8, 2});
    for (const auto& [keyframe, intra] : {std::pair{true, false}, {true, true}, {false, false}}) {
      auto u = update_of(desc, keyframe, intra);
      EXPECT_TRUE(is_rows(u, test::encode(u, rows(), best_isa())));
      check_everything(u, rows());
    }
  }
}

/// `count` components of that many bits, behind padding up to whole bytes.
TextureDesc wide_texture(unsigned count, std::uint8_t bits) {
  TextureDesc desc = map_texture(Format::R8_UNORM, {3, 3, 2}, {8, 8, 1});
  desc.record = Record();
  desc.record.bytes = static_cast<std::uint8_t>(count * 4);
  for (unsigned c = 0; c < count; ++c) {
    const auto offset = static_cast<std::uint16_t>(32 * c);
    auto& components = desc.record.components;
    components[desc.record.count++] =
        Component("c" + std::to_string(c), offset, bits, ComponentType::unorm);
    if (bits == 32) continue;
    components[desc.record.count++] =
        Component("p" + std::to_string(c), offset + bits, 32 - bits, ComponentType::opaque);
  }
  return desc;
}

TEST(NativeRasters, RowsOfHalvesOfAnyWidth) {
  for (const unsigned bits : {17U, 24U, 31U}) {
    const auto u = update_of(wide_texture(2, static_cast<std::uint8_t>(bits)), false, false);
    EXPECT_TRUE(is_rows(u, test::encode(u, rows(), best_isa())));
    check_everything(u, rows());
  }
}

/// Eight channels in halves are as many as strips take.
TEST(NativeRasters, RowsOfManyHalves) {
  for (const unsigned count : {8U, 9U}) {
    const auto u = update_of(wide_texture(count, 32), true, false);
    ASSERT_TRUE(is_valid(u.desc.record));
    EXPECT_EQ(is_rows(u, test::encode(u, rows(), best_isa())), count == 8);
    check_everything(u, rows());
  }
}

TEST(NativeRasters, UpdatesUseThePast) {
  const TextureDesc desc = map_texture(Format::B10G11R11_UFLOAT_PACK32, {8, 8, 1}, {8, 8, 1});
  const auto update = update_of(desc, false, false), key = update_of(desc, true, false);
  EXPECT_LT(2 * test::encode(update, strong(), best_isa()).size(),
            test::encode(key, strong(), best_isa()).size());
}

Status decoded(const test::UpdateCase& u, const Bytes& payload) {
  Bytes out(u.records.size());
  native::PayloadMemory memory;
  const Status status = native::decode_payload(u.decode_job(payload, out), best_isa(), memory);
  EXPECT_EQ(reference::decode(u.desc, u.blocks, u.mirror, u.received, payload, u.presence, u.intra,
                              u.mirror_presence)
                .has_value(),
            status == Status::ok);
  return status;
}

/// A chunk of two blocks cannot make a decoder lay out all texels of a large texture.
TEST(NativeRasters, BoxesAreBounded) {
  const TextureDesc desc = map_texture(Format::R16G16B16A16_SFLOAT, {128, 128, 1}, {8, 8, 1});
  auto u = test::make_update(desc, test::Content::constant, true, 1, 1);
  u.blocks = {0, 128 * 128 - 1};
  u.records.resize(2 * block_bytes(desc));
  for (const std::uint8_t kind : {native::kAdaptiveChunk, native::kRowChunk}) {
    Bytes payload = {std::byte{native::kVersion | 8 << 4}, std::byte{kind}};
    payload.resize(20);
    EXPECT_EQ(decoded(u, payload), Status::corrupt);
  }
}

/// Rows code all of their box: few blocks cannot make a decoder do that.
TEST(NativeRasters, RowsAreOfAQuarterOfTheirBox) {
  const TextureDesc desc = map_texture(Format::R8_UNORM, {11, 1, 1}, {32, 32, 1});
  auto u = update_of(desc, true, false);
  const Bytes payload = test::encode(u, rows(), best_isa());
  ASSERT_TRUE(is_rows(u, payload));
  for (const auto& [blocks, status] :
       {std::pair{std::vector<std::uint32_t>{0, 5, 10}, Status::ok}, {{0, 10}, Status::corrupt}}) {
    u.blocks = blocks;
    u.records.resize(blocks.size() * block_bytes(desc));
    EXPECT_EQ(decoded(u, payload), status) << blocks.size();
  }
}

TEST(NativeRasters, PalettesMustFit) {
  const TextureDesc desc = map_texture(Format::R8_UNORM, {1, 1, 1}, {4, 4, 1});
  const auto u = test::make_update(desc, test::Content::constant, true, 1, 1);
  const auto with = [&](std::uint32_t count, std::uint32_t first) {
    Bytes payload = {std::byte{native::kVersion}, std::byte{native::kAdaptiveChunk}};
    BinaryEncoder coder(payload);
    coder.bypass(2, 1);
    coder.bypass(24, count);
    coder.bypass(8, first);
    coder.finish();
    return payload;
  };
  EXPECT_EQ(decoded(u, with(1, 7)), Status::ok);
  EXPECT_EQ(decoded(u, with(0, 7)), Status::corrupt);
  EXPECT_EQ(decoded(u, with(17, 7)), Status::corrupt);
  EXPECT_NE(decoded(u, with(2, 255)), Status::ok);
}

TEST(NativeRasters, OrdinalsAreOrderedAsValues) {
  for (const auto type : {ComponentType::unorm, ComponentType::snorm, ComponentType::sfloat}) {
    const Component component("x", 0, 16, type);
    for (std::uint32_t bits = 0; bits < 1U << 16; ++bits) {
      ASSERT_EQ(native::bits_of(component, native::ordinal_of(component, bits)), bits);
    }
  }
  const Component half("x", 0, 16, ComponentType::sfloat), byte("x", 0, 8, ComponentType::snorm);
  EXPECT_LT(native::ordinal_of(half, 0xBC00), native::ordinal_of(half, 0x8000));
  EXPECT_LT(native::ordinal_of(half, 0x8000), native::ordinal_of(half, 0));
  EXPECT_LT(native::ordinal_of(half, 0x3C00), native::ordinal_of(half, 0x3C01));
  EXPECT_LT(native::ordinal_of(byte, 0xFF), native::ordinal_of(byte, 0));
}

TEST(NativeRasters, LightOfOrdinals) {
  for (const Format format :
       {Format::R16_SFLOAT, Format::B10G11R11_UFLOAT_PACK32, Format::R16_UNORM, Format::R8_UINT}) {
    const auto channels = native::channels_of(format);
    for (const auto& channel : std::span(channels.channel).first(channels.count)) {
      std::int64_t before = -1;
      const std::uint32_t zero = native::ordinal_of(channel.component, 0);
      for (std::uint32_t ordinal = zero; ordinal <= channel.largest(); ++ordinal) {
        const std::int64_t value = native::light_of(channel, ordinal);
        ASSERT_GT(value, before);
        ASSERT_EQ(native::ordinal_of_light(channel, value), std::int64_t{ordinal} << 4);
        before = value;
      }
      if (zero == 0) continue;
      ASSERT_EQ(native::light_of(channel, zero - 1), 0);  // −0
      ASSERT_EQ(native::light_of(channel, zero - 2), -1);
    }
  }
}

}  // namespace
}  // namespace gicodec
