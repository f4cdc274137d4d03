// Some regions of a volume played without the others, with the textures that say which records
// exist.
#include "container_support.h"

#include <gicodec/encoder.h>
#include <gicodec/player.h>

#include <gtest/gtest.h>

namespace gicodec {
namespace {

using namespace test;

constexpr Grid kCutGrid{6, 4, 2}, kCutRegion{2, 2, 2};

/// Counts bytes, of a container cut into regions of frames whose block b is painted with b + frame.
class Cut {
 public:
  Cut() {
    description_ = probe_description(std::vector<ProbeTexture>{{"a", desc}, {"b", desc}});
    description_.volumes[0].region = kCutRegion;
    const RegionGrid cut = regions_of(desc, kCutRegion);
    std::vector<Encoder> encoders;
    for (std::uint8_t id = 0; id < 2; ++id) {
      for (std::uint32_t region = 0; region < cut.regions(); ++region) {
        EncoderOptions options;
        options.backend = "raw";
        options.texture_id = id;
        options.gop = 5;
        encoders.push_back(*Encoder::create(region_texture(desc, kCutRegion, region), options));
      }
    }
    auto writer = *ContainerWriter::create(sink, description_);
    for (std::uint64_t frame = 0; frame < 20; ++frame) {
      for (std::size_t i = 0; i < encoders.size(); ++i) {
        const auto region = static_cast<std::uint32_t>(i % cut.regions());
        Bytes texels;
        for (const std::uint32_t block : cut.blocks_of(region)) {
          texels.insert(texels.end(), block_bytes(desc), value(block, frame));
        }
        const auto packet = encoders[i].encode(ConstTextureView{texels});
        EXPECT_EQ(writer.add(frame, *packet, region), Status::ok);
      }
    }
    EXPECT_EQ(writer.finish(), Status::ok);
  }
  static std::byte value(std::uint32_t block, std::uint64_t frame) {
    return static_cast<std::byte>(1 + (block + frame) % 200);
  }

  const TextureDesc desc =
      probe_texture(Format::R8G8B8A8_UNORM, kCutGrid, 1, 0, Tiling::atlas_xy_z);
  MemorySink sink;

 private:
  ContainerDescription description_;
};

TEST(PlayerRegions, OthersStayZeroAndAreNotRead) {
  const Cut cut;
  const RegionGrid grid = regions_of(cut.desc, kCutRegion);
  ASSERT_EQ(grid.regions(), 6U);
  const TextureRegion wanted[] = {{1, 1}, {1, 4}};
  for (const bool seeking : {false, true}) {
    GrowingSource source(cut.sink.bytes, cut.sink.bytes.size());
    auto player = *ContainerPlayer::open(source);
    const std::size_t opened = source.read_bytes;
    ASSERT_EQ(player.select(wanted), Status::ok);
    if (seeking) {
      ASSERT_EQ(player.seek(13), Status::ok);
    }
    std::uint64_t frame = seeking ? 13 : 0;
    for (; player.next() == Status::ok; ++frame) {
      ASSERT_EQ(player.frame(), frame);
      EXPECT_EQ(player.packets().size(), 2U);
      Bytes texels(static_cast<std::size_t>(texture_bytes(cut.desc)));
      ASSERT_EQ(player.read(1, TextureView{texels}), Status::ok);
      for (std::uint32_t block = 0; block < block_count(cut.desc); ++block) {
        const std::uint32_t region = grid.region_of(block);
        const bool there = region == 1 || region == 4;
        // Blocks of one texel each, slice below slice.
        EXPECT_EQ(texels[block * block_bytes(cut.desc)],
                  there ? Cut::value(block, frame) : std::byte{0})
            << block;
      }
    }
    EXPECT_EQ(frame, 20U);
    EXPECT_LE(source.read_bytes - opened, cut.sink.bytes.size() / 4);
  }
}

TEST(PlayerRegions, ABoxNamesTheRegionsThatItMeets) {
  const Cut cut;
  MemorySource source(cut.sink.bytes);
  auto reader = *ContainerReader::open(source);
  const ContainerDescription& description = reader.description();
  // Regions of 2x2x2 in a grid of 6x4x2: three along x, two along y.
  using Parts = std::vector<TextureRegion>;
  EXPECT_EQ(parts_in_box(description, 0, {0, 0, 0}, {1, 1, 1}), (Parts{{0, 0}, {1, 0}}));
  EXPECT_EQ(parts_in_box(description, 0, {1, 2, 0}, {2, 2, 0}),
            (Parts{{0, 3}, {0, 4}, {1, 3}, {1, 4}}));
  EXPECT_EQ(parts_in_box(description, 0, {5, 3, 1}, {99, 99, 99}), (Parts{{0, 5}, {1, 5}}));
  EXPECT_EQ(parts_in_box(description, 0, {0, 0, 0}, {99, 99, 99}).size(), 12U);
  EXPECT_TRUE(parts_in_box(description, 0, {6, 0, 0}, {9, 9, 9}).empty());
  EXPECT_TRUE(parts_in_box(description, 1, {0, 0, 0}, {9, 9, 9}).empty());
  // A volume that is not cut comes whole.
  const auto whole = probe_description(std::vector<ProbeTexture>{{"a", cut.desc}});
  EXPECT_EQ(parts_in_box(whole, 0, {0, 0, 0}, {0, 0, 0}), (Parts{{0}}));
}

TEST(PlayerRegions, MisuseIsNamed) {
  const Cut cut;
  MemorySource source(cut.sink.bytes);
  auto player = *ContainerPlayer::open(source);
  for (const TextureRegion wrong : {TextureRegion{2, 0}, TextureRegion{0}, TextureRegion{0, 6}}) {
    EXPECT_EQ(player.select(std::span(&wrong, 1)),
              wrong.texture_id == 2 ? Status::unknown_texture : Status::unknown_region);
  }
  const TextureRegion one{0, 5};
  ASSERT_EQ(player.select(std::span(&one, 1)), Status::ok);
  ASSERT_EQ(player.select(std::span<const TextureRegion>()), Status::ok);  // all again
  ASSERT_EQ(player.next(), Status::ok);
  EXPECT_EQ(player.packets().size(), 12U);
  EXPECT_EQ(player.select(std::span(&one, 1)), Status::out_of_order);
}

}  // namespace
}  // namespace gicodec
