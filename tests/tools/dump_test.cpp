#include "dump/dump.h"
#include "distinct_formats.h"

#include "tools/dump_support.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <gicodec/textures.h>

#include <gtest/gtest.h>

#include <cstring>

namespace gicodec::tools {
namespace {

void expect_round_trip(const Dump& dump, const std::string& path, const Hints& hints = {}) {
  write_dump(path, dump.info, dump.texels, Existing::replace);
  const Dump back = read_dump(path, hints);
  EXPECT_EQ(back.info.desc, dump.info.desc);
  EXPECT_EQ(back.info.channels, dump.info.channels);
  EXPECT_EQ(back.texels, dump.texels);
  const std::vector<std::byte> first = file_bytes(path);
  write_dump(path, back.info, back.texels, Existing::replace);
  EXPECT_EQ(file_bytes(path), first);
}

void expect_part_of(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << text << " lacks " << part;
}

TEST(Dump, EveryFormatChannelTypeAndTiling) {
  const TemporaryDirectory directory;
  std::uint32_t seed = 0;
  for (const FormatInfo& format : test::distinct_formats()) {
    for (std::uint8_t tiling = 0; tiling < kTilingCount; ++tiling) {
      const auto band = static_cast<std::uint8_t>(tiling % 2);
      const TextureDesc desc =
          probe_texture(format.record, {3, 2, 4}, 5, band, static_cast<Tiling>(tiling));
      for (const SampleType type : {SampleType::uint32, SampleType::half, SampleType::float32}) {
        Dump dump = random_dump(desc, ++seed);
        for (std::size_t i = 0; i < format.record.count; ++i) {
          if (can_hold(type, format.record.components[i], format.record))
            dump.info.channels.types[i] = type;
        }
        SCOPED_TRACE(to_string(dump.info.channels, format.record.format));
        expect_round_trip(dump, directory.path("x.exr"));
      }
    }
  }
}

// R, G and B as values: the texels are those of the lowest exponents.
TEST(Dump, SharedExponentsAsValues) {
  const TemporaryDirectory directory;
  const std::string path = directory.path("x.exr");
  const TextureDesc desc = ddgi_irradiance({4, 2, 3}, Format::E5B9G9R9_UFLOAT_PACK32);
  for (const SampleType type : {SampleType::half, SampleType::float32}) {
    Dump dump = random_dump(desc, 9);
    dump.info.channels.exponent = false;
    dump.info.channels.types = {type, type, type};
    expect_part_of(to_string(dump.info.channels, desc.record.format), "B:");
    for (std::size_t i = 0; i < dump.texels.size(); i += 4) {
      dump.texels[i + 2] |= std::byte{0x02};  // The highest bit of G.
    }
    expect_round_trip(dump, path);
    EXPECT_EQ(
        channels_from_string(to_string(dump.info.channels, desc.record.format), desc.record.format),
        dump.info.channels);
  }
  TextureDesc floats = desc;
  floats.record = Format::R32G32B32_SFLOAT;
  Dump dump{make_info(floats), std::vector<std::byte>(texture_bytes(floats))};
  describe(dump.info.attributes, desc);
  const float third = 1 / 3.0F;
  std::memcpy(&dump.texels[12 * (80 * 13 + 44) + 4], &third, 4);
  write_dump(path, dump.info, dump.texels, Existing::replace);
  const auto error = read_error(path);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), Exit::bad_input);
  for (const char* part :
       {"texel (44, 13), probe 12 (0, 1, 1)", "R, G and B of 0, 0.33333334 and 0",
        "E5B9G9R9_UFLOAT_PACK32", "--vk-format R32G32B32_SFLOAT"}) {
    expect_part_of(error->what(), part);
  }
}

TEST(Dump, SmallFloatsAsValues) {
  const TemporaryDirectory directory;
  const std::string path = directory.path("x.exr");
  const TextureDesc desc = ddgi_irradiance({4, 2, 3}, Format::B10G11R11_UFLOAT_PACK32);
  TextureDesc floats = desc;
  floats.record = Format::R32G32B32_SFLOAT;
  Dump dump{make_info(floats), std::vector<std::byte>(texture_bytes(floats))};
  describe(dump.info.attributes, desc);
  const float small = 1.015625F;  // 7 bits of a mantissa, where there are 6.
  for (float exact : {0.0F, 1.5F, 65024.0F, INFINITY}) {
    std::memcpy(&dump.texels[12 * 5], &exact, 4);
    write_dump(path, dump.info, dump.texels, Existing::replace);
    EXPECT_FALSE(read_error(path)) << exact;
  }
  for (const float inexact : {small + 0.0078125F, -1.0F, -0.0F, 65025.0F}) {
    std::memcpy(&dump.texels[12 * 5], &inexact, 4);
    write_dump(path, dump.info, dump.texels, Existing::replace);
    const auto error = read_error(path);
    ASSERT_TRUE(error) << inexact;
    expect_part_of(error->what(), "texel (5, 0), probe 0");
  }
}

TEST(Dump, AlphaWithoutAChannel) {
  const TemporaryDirectory directory;
  const TextureDesc desc = ddgi_irradiance({4, 2, 3});
  expect_round_trip(without_alpha(random_dump(desc, 1)), directory.path("x.exr"));

  Dump dump = without_alpha(random_dump(desc, 1));
  dump.texels[3] |= std::byte{0x40};
  try {
    (void)to_exr({&dump, 1}, "x.exr");
    FAIL() << "alpha was lost";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("texel (0, 0), probe 0"), std::string::npos);
  }
}

TEST(Dump, SamplesInTheFileAreTheTexelsBits) {
  const TemporaryDirectory directory;
  const TextureDesc desc = ddgi_visibility({2, 2, 2});
  const Dump dump = random_dump(desc, 7);
  write_dump(directory.path("vis.exr"), dump.info, dump.texels, Existing::replace);

  const Extent size = image_extent(desc);
  Imf::InputFile file(directory.path("vis.exr").c_str());
  std::vector<std::uint16_t> red(size.width * size.height), green(red.size());
  Imf::FrameBuffer target;
  target.insert("R", Imf::Slice(Imf::HALF, reinterpret_cast<char*>(red.data()), 2, size.width * 2));
  target.insert("G",
                Imf::Slice(Imf::HALF, reinterpret_cast<char*>(green.data()), 2, size.width * 2));
  file.setFrameBuffer(target);
  file.readPixels(0, static_cast<int>(size.height) - 1);
  for (std::size_t i = 0; i < red.size(); ++i) {
    std::uint16_t texel[2];
    std::memcpy(texel, &dump.texels[4 * i], 4);
    ASSERT_EQ(red[i], texel[0]) << i;
    ASSERT_EQ(green[i], texel[1]) << i;
  }
}

TEST(Dump, HintsStandInForAttributes) {
  const TemporaryDirectory directory;
  const std::string path = directory.path("x.exr");
  Dump colour = without_alpha(random_dump(ddgi_irradiance({4, 2, 3}), 1));
  colour.info.attributes.clear();
  write_dump(path, colour.info, colour.texels, Existing::replace);
  Hints hints;
  hints.grid = Grid{4, 2, 3};
  const Dump back = read_dump(path, hints);
  EXPECT_EQ(back.info.desc, colour.info.desc);
  EXPECT_EQ(back.texels, colour.texels);
  EXPECT_EQ(find_attribute(back.info.attributes, "gicodec:grid"), nullptr);

  Dump vis = random_dump(ddgi_visibility({4, 2, 3}), 1);
  vis.info.attributes.clear();
  write_dump(path, vis.info, vis.texels, Existing::replace);
  EXPECT_EQ(read_dump(path, hints).info.desc, vis.info.desc);
  // Of nothing but texels it is a texture of them.
  const TextureDesc map =
      map_texture(Format::R16G16_SFLOAT, read_dump_info(path).desc.records, {8, 8, 1});
  EXPECT_EQ(read_dump_info(path).desc, map);
}

// They say how a file is read; what the file says is given back.
TEST(Dump, HintsOverrideAttributes) {
  const TemporaryDirectory directory;
  const Dump dump = random_dump(ddgi_irradiance({4, 2, 3}), 1);
  write_dump(directory.path("x.exr"), dump.info, dump.texels, Existing::replace);
  Hints hints;
  hints.format = Format::A2B10G10R10_UNORM_PACK32;
  hints.tiling = Tiling::atlas_xz_y;
  hints.grid = Grid{4, 3, 2};
  const Dump back = read_dump(directory.path("x.exr"), hints);
  EXPECT_EQ(back.info.desc.record.format, Format::A2B10G10R10_UNORM_PACK32);
  EXPECT_EQ(back.info.desc.layout.tiling, Tiling::atlas_xz_y);
  EXPECT_EQ(back.info.attributes, dump.info.attributes);
}

TEST(Dump, LocateFindsEveryTexel) {
  for (std::uint8_t tiling = 0; tiling < kTilingCount; ++tiling) {
    const TextureDesc desc =
        probe_texture(Format::R16_SFLOAT, {3, 2, 4}, 2, 1, static_cast<Tiling>(tiling));
    const std::uint64_t slice_height = extent(desc).height;
    for (std::uint32_t probe = 0; probe < block_count(desc); ++probe) {
      const BlockOrigin origin = block_origin(desc, probe);
      const TexelPlace place = locate(
          desc, static_cast<std::uint32_t>(origin.x + 3),
          static_cast<std::uint32_t>((origin.slice + origin.block) * slice_height + origin.y + 1));
      EXPECT_EQ(place.probe, probe);
      EXPECT_EQ(place.block_x, 3U);
      EXPECT_EQ(place.block_y, 1U);
      EXPECT_EQ(place.position.x + 3 * (place.position.y + 2 * place.position.z), probe);
    }
  }
}

TEST(Dump, ChannelsAsText) {
  const Format format = Format::A2R10G10B10_UNORM_PACK32;
  for (const std::string text : {"R:HALF G:HALF B:HALF", "R:UINT G:HALF B:FLOAT A:UINT"}) {
    EXPECT_EQ(to_string(*channels_from_string(text, format), format), text);
  }
  for (const std::string text : {"", "R:HALF", "R:HALF G:HALF B:HALF A:HALF ", "R:HALF G:HALF B:X",
                                 "R:HALF G:HALF B:HALF Z:HALF", "G:HALF R:HALF B:HALF"}) {
    EXPECT_FALSE(channels_from_string(text, format)) << text;
  }
  EXPECT_FALSE(channels_from_string("R:HALF", Format::R32_SFLOAT));
}

}  // namespace
}  // namespace gicodec::tools
