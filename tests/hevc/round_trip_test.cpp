#include "distinct_formats.h"
#include "hevc/session.h"
#include "shapes.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <string>
#include <tuple>

namespace gicodec::test {
namespace {

struct Mode {
  HevcPacking packing;
  HevcLayout layout;
};
constexpr Mode kModes[] = {{HevcPacking::paper, HevcLayout::atlas},
                           {HevcPacking::paper, HevcLayout::packed},
                           {HevcPacking::planes, HevcLayout::atlas},
                           {HevcPacking::planes, HevcLayout::packed}};

HevcSettings settings_of(Mode mode) {
  HevcSettings settings;
  settings.packing = mode.packing;
  settings.layout = mode.layout;
  return settings;
}

std::string describe(Mode mode) {
  return std::string(mode.packing == HevcPacking::paper ? "paper" : "planes") +
         (mode.layout == HevcLayout::atlas ? "_atlas" : "_packed");
}

// A keyframe, updates of random subsets, an empty update, another keyframe, one more update; both
// decoders see the same payloads.
void expect_round_trip(const TextureDesc& desc, Mode mode) {
  SCOPED_TRACE(describe(mode));
  Sender sender(desc, settings_of(mode));
  ASSERT_EQ(sender.status(), Status::ok);
  Receiver libde265(desc, "libde265"), ffmpeg(desc, "ffmpeg");
  for (unsigned i = 0; i < 7; ++i) {
    const bool keyframe = i % 5 == 0;
    const double chance = i == 0 ? 1.0 : i % 2 == 0 ? 0.1 : 0.6;
    auto blocks = some_blocks(desc, sender.random(), chance);
    if (i == 3) blocks.clear();
    const Update update = sender.next(std::move(blocks), keyframe, i < 2 ? 8 : 3);
    ASSERT_EQ(sender.status(), Status::ok) << i;
    ASSERT_LE(update.payload.size(), sender.encoder().bound(update.blocks.size())) << i;
    ASSERT_EQ(libde265.receive(update), Status::ok) << i;
    ASSERT_EQ(libde265.records(), update.records) << i;
    ASSERT_EQ(ffmpeg.receive(update), Status::ok) << i;
    ASSERT_EQ(ffmpeg.records(), update.records) << i;
  }
}

class EveryFormat : public testing::TestWithParam<std::tuple<Format, Mode>> {};

TEST_P(EveryFormat, RoundTripsRandomBits) {
  const auto& [format, mode] = GetParam();
  expect_round_trip(probe_texture(format, {3, 2, 2}, 6, 1, Tiling::atlas_xy_z), mode);
}

std::vector<Format> all_formats() {
  std::vector<Format> all;
  for (const FormatInfo& info : test::distinct_formats()) all.push_back(info.record.format);
  return all;
}

INSTANTIATE_TEST_SUITE_P(Hevc, EveryFormat,
                         testing::Combine(testing::ValuesIn(all_formats()),
                                          testing::ValuesIn(kModes)),
                         [](const auto& test) {
                           return std::string(find_format(std::get<0>(test.param))->name) + "_" +
                                  describe(std::get<1>(test.param));
                         });

TEST(HevcRoundTrip, OddGridsAndCores) {
  const Grid grids[] = {{1, 1, 1}, {3, 1, 5}, {1, 7, 1}, {5, 3, 2}};
  unsigned core = 0;
  for (const Grid& grid : grids) {
    for (const Mode mode : kModes) {
      core = core % 16 + 1;
      const auto side = static_cast<std::uint8_t>(core);
      expect_round_trip(probe_texture(Format::R16G16_SFLOAT, grid, side, 0, Tiling::slices_xz_y),
                        mode);
      expect_round_trip(
          probe_texture(Format::A2B10G10R10_UNORM_PACK32, grid, side, 1, Tiling::atlas_xy_z), mode);
    }
  }
}

RC_GTEST_PROP(HevcRoundTrip, AnyDescription, (std::uint64_t seed)) {
  Random shapes(seed);
  TextureDesc desc = any_desc(shapes, 3000);
  desc.presence = Presence::all;
  if (desc.model == Model::octree) desc.model = Model::none;
  Sender sender(desc, settings_of(*rc::gen::elementOf(std::vector<Mode>(kModes, kModes + 4))),
                *rc::gen::arbitrary<std::uint32_t>());
  RC_PRE(sender.status() != Status::limit_exceeded);  // More rows than a picture has.
  RC_ASSERT(sender.status() == Status::ok);
  Receiver receiver(desc, *rc::gen::element<std::string>("libde265", "ffmpeg"));
  for (int i = 0; i < 3; ++i) {
    const auto blocks = some_blocks(desc, sender.random(), 0.5);
    const Update update = sender.next(blocks, i == 0, *rc::gen::inRange(1U, 9U));
    RC_ASSERT(sender.status() == Status::ok);
    RC_ASSERT(receiver.receive(update) == Status::ok);
    RC_ASSERT(receiver.records() == update.records);
  }
}

TEST(HevcRoundTrip, NanPayloadsAndSignsOfZero) {
  const TextureDesc desc = ddgi_visibility({2, 1, 1});
  for (const Mode mode : kModes) {
    Sender sender(desc, settings_of(mode));
    Receiver receiver(desc);
    Update update{.blocks = {0, 1}, .records = {}, .payload = {}, .keyframe = true};
    const std::uint16_t patterns[] = {0x7E01, 0xFFFF, 0x7C00, 0xFC00, 0x8000, 0x0001, 0x7C01};
    for (std::size_t i = 0; i < 2 * block_bytes(desc) / 2; ++i) {
      const std::uint16_t value = patterns[i % std::size(patterns)];
      update.records.push_back(static_cast<std::byte>(value & 0xFF));
      update.records.push_back(static_cast<std::byte>(value >> 8));
    }
    update = sender.send(std::move(update));
    ASSERT_EQ(receiver.receive(update), Status::ok);
    EXPECT_EQ(receiver.records(), update.records);
  }
}

// Constant alpha takes no more room whatever its value; a single other texel is kept.
TEST(HevcRoundTrip, Alpha) {
  const TextureDesc desc = ddgi_irradiance({4, 2, 1});
  std::size_t sizes[3] = {};
  for (unsigned kind = 0; kind < 3; ++kind) {
    Sender sender(desc, {});
    Receiver receiver(desc);
    Update update{.blocks = all_blocks(desc), .records = {}, .payload = {}, .keyframe = true};
    update.records.assign(block_count(desc) * block_bytes(desc), std::byte{0});
    for (std::size_t i = 3; i < update.records.size(); i += 4) {
      update.records[i] = kind == 0 ? std::byte{0} : std::byte{0xC0};
    }
    if (kind == 2) update.records[4 * 77 + 3] = std::byte{0x40};
    update = sender.send(std::move(update));
    ASSERT_EQ(receiver.receive(update), Status::ok);
    EXPECT_EQ(receiver.records(), update.records);
    sizes[kind] = update.payload.size();
  }
  EXPECT_EQ(sizes[0], sizes[1]);
  EXPECT_LT(sizes[2], sizes[0] + 64);
}

// The size class of a packed picture follows the number of blocks, in both directions.
TEST(HevcRoundTrip, PackedPicturesGrowAndShrink) {
  const TextureDesc desc =
      probe_texture(Format::R16G16_SFLOAT, {16, 8, 2}, 8, 1, Tiling::atlas_xy_z);
  Sender sender(desc, settings_of({HevcPacking::planes, HevcLayout::packed}));
  Receiver receiver(desc);
  const std::size_t counts[] = {3, 200, 256, 33, 40, 1, 90};
  for (std::size_t i = 0; i < std::size(counts); ++i) {
    auto blocks = all_blocks(desc);
    blocks.erase(blocks.begin(), blocks.end() - static_cast<std::ptrdiff_t>(counts[i]));
    const Update update = sender.next(std::move(blocks), i == 0, 2);
    ASSERT_EQ(sender.status(), Status::ok) << i;
    ASSERT_EQ(receiver.receive(update), Status::ok) << i;
    ASSERT_EQ(receiver.records(), update.records) << i;
  }
}

// Noise that grows at once makes x265 choose weights of prediction that the syntax cannot hold.
// Such a picture has to be coded in another way: by itself, which shows in its parameter sets.
TEST(HevcRoundTrip, SuddenLight) {
  const TextureDesc desc =
      probe_texture(Format::R16G16_SFLOAT, {3, 2, 1}, 8, 0, Tiling::atlas_xy_z);
  const std::byte video_parameter_set[] = {std::byte{0}, std::byte{0}, std::byte{1},
                                           std::byte{0x40}, std::byte{1}};
  std::size_t coded_by_themselves = 0;
  for (std::uint32_t seed = 0; seed < 30; ++seed) {
    Sender sender(desc, {}, seed);
    Receiver libde265(desc, "libde265"), ffmpeg(desc, "ffmpeg");
    for (unsigned i = 0; i < 3; ++i) {
      const Update update = sender.next(all_blocks(desc), i == 0, i == 0 ? 2 : 7);
      ASSERT_EQ(sender.status(), Status::ok);
      ASSERT_EQ(libde265.receive(update), Status::ok) << seed << ' ' << i;
      ASSERT_EQ(libde265.records(), update.records);
      ASSERT_EQ(ffmpeg.receive(update), Status::ok) << seed << ' ' << i;
      ASSERT_EQ(ffmpeg.records(), update.records);
      const auto found =
          std::search(update.payload.begin(), update.payload.end(), std::begin(video_parameter_set),
                      std::end(video_parameter_set));
      if (i > 0 && found != update.payload.end()) ++coded_by_themselves;
    }
  }
  EXPECT_GT(coded_by_themselves, 0U);
}

TEST(HevcRoundTrip, EmptyKeyframeStartsAnew) {
  const TextureDesc desc = ddgi_irradiance({3, 1, 1});
  Sender sender(desc, {});
  Receiver receiver(desc);
  const Update first = sender.next({}, true);
  EXPECT_TRUE(first.payload.empty());
  EXPECT_EQ(receiver.receive(first), Status::ok);
  const Update second = sender.next({1}, false);
  ASSERT_EQ(receiver.receive(second), Status::ok);
  EXPECT_EQ(receiver.records(), second.records);
}

TEST(HevcRoundTrip, SameInputGivesTheSameBytes) {
  const TextureDesc desc = ddgi_irradiance({5, 3, 2});
  Sender one(desc, {}), other(desc, {});
  for (int i = 0; i < 4; ++i) {
    const auto blocks = some_blocks(desc, one.random(), 0.5);
    static_cast<void>(some_blocks(desc, other.random(), 0.5));
    EXPECT_EQ(one.next(blocks, i == 0, 5).payload, other.next(blocks, i == 0, 5).payload) << i;
  }
}

}  // namespace
}  // namespace gicodec::test
