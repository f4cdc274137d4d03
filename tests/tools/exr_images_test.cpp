// EXR files of every kind that OpenEXR writes: their images come back, byte for byte where the file
// was written by the same OpenEXR.
#include "dump/dump.h"
#include "dump/exr_header.h"
#include "tools/dump_support.h"

#include <gicodec/textures.h>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFloatVectorAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOpaqueAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfPreviewImage.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <OpenEXR/ImfTiledOutputPart.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

namespace gicodec::tools {
namespace {

/// A channel, e.g. "diffuse.R" of halves.
struct Made {
  const char* name;
  Imf::PixelType type = Imf::HALF;
  int sampling = 1;
  bool linear = false;
};

/// Samples that are different everywhere, and no 10-bit codes.
class Samples {
 public:
  /// Samples of all channels in a window, as a source for OpenEXR.
  Imf::FrameBuffer of(const std::vector<Made>& channels, const Imath::Box2i& window) {
    Imf::FrameBuffer source;
    for (const Made& made : channels) {
      const auto width = static_cast<std::size_t>(window.max.x - window.min.x + 1),
                 height = static_cast<std::size_t>(window.max.y - window.min.y + 1);
      const std::size_t bytes = made.type == Imf::HALF ? 2 : 4;
      std::vector<char>& plane = planes_.emplace_back(width * height * bytes);
      for (std::size_t i = 0; i < plane.size() / bytes; ++i) {
        const std::uint32_t sample = 0x3C01 + (next_++ * 7919) % 1000;
        std::memcpy(&plane[i * bytes], &sample, bytes);
      }
      const auto step = static_cast<std::size_t>(made.sampling);
      source.insert(made.name,
                    Imf::Slice::Make(made.type, plane.data(), window, bytes, bytes * width / step,
                                     made.sampling, made.sampling));
    }
    return source;
  }

 private:
  std::vector<std::vector<char>> planes_;
  std::uint32_t next_ = 0;
};

Imf::Header header_of(const std::vector<Made>& channels, const Imath::Box2i& window) {
  Imf::Header header(Imath::Box2i({0, 0}, {40, 30}), window);
  for (const Made& made : channels) {
    header.channels().insert(made.name,
                             Imf::Channel(made.type, made.sampling, made.sampling, made.linear));
  }
  return header;
}

/// Gives a file's first chunk other bytes.
void replace_chunk(const std::string& path, const std::vector<std::byte>& with) {
  const ExrPart part = read_exr_header(path).front();
  auto bytes = file_bytes(path);
  std::uint64_t at = 0;
  std::memcpy(&at, &bytes[part.places], sizeof at);
  at += part.tiled ? 16 : 4;
  const auto size = static_cast<std::uint32_t>(with.size());
  std::memcpy(&bytes[at], &size, sizeof size);
  std::copy(with.begin(), with.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at + 4));
  write_bytes(path, bytes);
}

class ExrImages : public testing::Test {
 protected:
  void write_lines(const Imf::Header& header, const std::vector<Made>& channels) {
    Samples samples;
    const Imath::Box2i window = header.dataWindow();
    Imf::OutputFile file(path_.c_str(), header);
    file.setFrameBuffer(samples.of(channels, window));
    file.writePixels(window.max.y - window.min.y + 1);
  }
  void write_tiles(Imf::Header header, const std::vector<Made>& channels,
                   const Imf::TileDescription& tiles) {
    header.setTileDescription(tiles);
    Samples samples;
    Imf::TiledOutputFile file(path_.c_str(), header);
    const int levels = tiles.mode == Imf::ONE_LEVEL ? 1 : file.numLevels();
    for (int level = 0; level < levels; ++level) {
      file.setFrameBuffer(samples.of(channels, file.dataWindowForLevel(level)));
      file.writeTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
    }
  }

  /// The file's images, by name, size and format; it comes back byte for byte, and each image alone
  /// is read as it is among the others.
  std::vector<std::string> images(const Hints& hints = plain()) {
    const std::vector<Dump> all = read_dumps(path_, hints);
    std::vector<std::string> words;
    for (const Dump& image : all) {
      const Extent size = image_extent(image.info.desc);
      words.push_back(fmt::format("{} {}x{} {}", image.info.image, size.width, size.height,
                                  find_format(image.info.desc.record.format)->name));
      EXPECT_TRUE(image.info.lost.empty()) << image.info.lost.front();
      const Dump again = read_dump(path_, hints_of(image.info));
      EXPECT_EQ(again.texels, image.texels) << words.back();
      EXPECT_EQ(again.info.attributes, image.info.attributes) << words.back();
      EXPECT_EQ(again.info.channels, image.info.channels) << words.back();
    }
    const std::string copy = directory_.path("copy.exr");
    write_dumps(copy, all, Existing::replace);
    EXPECT_EQ(file_bytes(copy), file_bytes(path_));
    return words;
  }
  static Hints plain() {
    Hints hints;
    hints.plain = true;
    return hints;
  }
  using Words = std::vector<std::string>;

  const Imath::Box2i window_{{0, 0}, {12, 9}};
  TemporaryDirectory directory_;
  std::string path_ = directory_.path("x.exr");
};

TEST_F(ExrImages, ChannelsOfEveryNameAndType) {
  const std::vector<Made> rgba = {{"R"}, {"G"}, {"B"}, {"A"}};
  write_lines(header_of(rgba, window_), rgba);
  EXPECT_EQ(images(), Words{" 13x10 R16G16B16A16_SFLOAT"});
  const std::vector<Made> mixed = {{"R"}, {"G"}, {"B"}, {"A", Imf::FLOAT}, {"Z", Imf::FLOAT}};
  write_lines(header_of(mixed, window_), mixed);
  EXPECT_EQ(images(),
            (Words{" 13x10 R16G16B16A16_SFLOAT", "A 13x10 R32_SFLOAT", "Z 13x10 R32_SFLOAT"}));
  const std::vector<Made> grey = {{"Y", Imf::FLOAT}};
  write_lines(header_of(grey, window_), grey);
  EXPECT_EQ(images(), Words{" 13x10 R32_SFLOAT"});
  const std::vector<Made> ids = {{"id", Imf::UINT}, {"a b"}, {"irr\xF6"}};
  write_lines(header_of(ids, window_), ids);
  EXPECT_EQ(images(),
            (Words{"a b 13x10 R16_SFLOAT", "id 13x10 R32_UINT", "0x697272f6 13x10 R16_SFLOAT"}));
  const std::vector<Made> codes = {{"R", Imf::UINT}, {"G", Imf::UINT}, {"B", Imf::UINT}};
  write_lines(header_of(codes, window_), codes);
  EXPECT_EQ(images(), Words{" 13x10 R32G32B32_UINT"});
  const std::vector<Made> two = {{"R"}, {"G"}};
  write_lines(header_of(two, window_), two);
  EXPECT_EQ(images(), Words{" 13x10 R16G16_SFLOAT"});
}

TEST_F(ExrImages, Layers) {
  const std::vector<Made> channels = {{"R"},
                                      {"G"},
                                      {"B"},
                                      {"diffuse.R"},
                                      {"diffuse.G"},
                                      {"diffuse.B"},
                                      {"N.X"},
                                      {"N.Y"},
                                      {"N.Z"},
                                      {"left.sky.r"},
                                      {"left.sky.g"},
                                      {"left.sky.b"},
                                      {"depth.Z", Imf::FLOAT},
                                      {"uv.u"},
                                      {"uv.v"}};
  write_lines(header_of(channels, window_), channels);
  EXPECT_EQ(images(), (Words{" 13x10 R16G16B16A16_SFLOAT", "N.XYZ 13x10 R16G16B16A16_SFLOAT",
                             "depth.Z 13x10 R32_SFLOAT", "diffuse 13x10 R16G16B16A16_SFLOAT",
                             "left.sky 13x10 R16G16B16A16_SFLOAT", "uv.u 13x10 R16_SFLOAT",
                             "uv.v 13x10 R16_SFLOAT"}));
}

TEST_F(ExrImages, WindowsOffTheOrigin) {
  const std::vector<Made> channels = {{"R"}, {"G"}, {"B"}};
  for (const Imath::Box2i& window :
       {Imath::Box2i({-3, 5}, {9, 14}), Imath::Box2i({100, -200}, {100, -199})}) {
    write_lines(header_of(channels, window), channels);
    EXPECT_EQ(images().size(), 1U);
  }
}

TEST_F(ExrImages, SubsampledChannels) {
  const std::vector<Made> channels = {{"Y"}, {"RY", Imf::HALF, 2}, {"BY", Imf::HALF, 2}};
  for (const Imath::Box2i& window :
       {Imath::Box2i({0, 0}, {11, 7}), Imath::Box2i({-4, 2}, {7, 9})}) {
    write_lines(header_of(channels, window), channels);
    EXPECT_EQ(images(), (Words{"BY 6x4 R16_SFLOAT", "RY 6x4 R16_SFLOAT", "Y 12x8 R16_SFLOAT"}));
  }
}

TEST_F(ExrImages, TilesAndMipmaps) {
  const std::vector<Made> channels = {{"R"}, {"G"}, {"B"}, {"Z", Imf::FLOAT}};
  for (const Imath::Box2i& window : {window_, Imath::Box2i({3, -2}, {15, 7})}) {
    for (const Imf::LineOrder order : {Imf::INCREASING_Y, Imf::DECREASING_Y}) {
      Imf::Header header = header_of(channels, window);
      header.lineOrder() = order;
      write_tiles(header, channels, {8, 4, Imf::ONE_LEVEL});
      EXPECT_EQ(images(), (Words{" 13x10 R16G16B16A16_SFLOAT", "Z 13x10 R32_SFLOAT"}));
    }
    write_tiles(header_of(channels, window), channels, {8, 4, Imf::MIPMAP_LEVELS});
    EXPECT_EQ(images(), (Words{" 13x10 R16G16B16A16_SFLOAT", "Z 13x10 R32_SFLOAT",
                               "mip1 6x5 R16G16B16A16_SFLOAT", "Z.mip1 6x5 R32_SFLOAT",
                               "mip2 3x2 R16G16B16A16_SFLOAT", "Z.mip2 3x2 R32_SFLOAT",
                               "mip3 1x1 R16G16B16A16_SFLOAT", "Z.mip3 1x1 R32_SFLOAT"}));
    write_tiles(header_of(channels, window), channels, {8, 4, Imf::MIPMAP_LEVELS, Imf::ROUND_UP});
    EXPECT_EQ(images().size(), 10U);
  }
}

TEST_F(ExrImages, Parts) {
  const std::vector<std::vector<Made>> channels = {
      {{"R"}, {"G"}, {"B"}, {"A"}}, {{"R"}, {"G"}, {"B"}}, {{"Z", Imf::FLOAT}}};
  const std::vector<Imath::Box2i> windows = {window_, {{2, 3}, {5, 9}}, {{-1, 0}, {12, 2}}};
  std::vector<Imf::Header> headers;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    headers.push_back(header_of(channels[i], windows[i]));
    headers.back().setName(i == 0 ? "beauty" : i == 1 ? "light.left" : "depth");
    headers.back().setType(i == 1 ? Imf::TILEDIMAGE : Imf::SCANLINEIMAGE);
    headers.back().insert("note", Imf::IntAttribute(static_cast<int>(i)));
    if (i == 1) headers.back().setTileDescription({4, 4, Imf::MIPMAP_LEVELS});
  }
  {
    Samples samples;
    Imf::MultiPartOutputFile file(path_.c_str(), headers.data(), 3);
    for (const int i : {0, 2}) {
      const auto at = static_cast<std::size_t>(i);
      Imf::OutputPart part(file, i);
      part.setFrameBuffer(samples.of(channels[at], windows[at]));
      part.writePixels(windows[at].max.y - windows[at].min.y + 1);
    }
    Imf::TiledOutputPart part(file, 1);
    for (int level = 0; level < part.numLevels(); ++level) {
      part.setFrameBuffer(samples.of(channels[1], part.dataWindowForLevel(level)));
      part.writeTiles(0, part.numXTiles(level) - 1, 0, part.numYTiles(level) - 1, level);
    }
  }
  const std::vector<Dump> all = read_dumps(path_, plain());
  Words names;
  for (const Dump& image : all) names.push_back(image.info.image);
  EXPECT_EQ(names,
            (Words{"beauty", "light.left", "light.left.mip1", "light.left.mip2", "depth.Z"}));
  // Parts are written here in another order, which places chunks elsewhere in the file.
  const std::string copy = directory_.path("copy.exr");
  write_dumps(copy, all);
  const std::vector<Dump> again = read_dumps(copy, plain());
  ASSERT_EQ(again.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(again[i].texels, all[i].texels) << names[i];
    EXPECT_EQ(again[i].info.attributes, all[i].info.attributes) << names[i];
    EXPECT_EQ(again[i].info.image, names[i]);
  }
}

TEST_F(ExrImages, AttributesOfEveryName) {
  const std::vector<Made> channels = {{"R", Imf::HALF, 1, true}, {"G"}, {"B", Imf::HALF, 1, true}};
  Imf::Header header = header_of(channels, window_);
  header.insert("name", Imf::StringAttribute("beauty"));
  header.insert("version", Imf::IntAttribute(7));
  header.insert("chunkCount", Imf::IntAttribute(1));
  header.insert("type", Imf::StringAttribute(Imf::SCANLINEIMAGE));
  header.insert("weights", Imf::FloatVectorAttribute({1, 2, 3}));
  header.insert("dwaCompressionLevel", Imf::FloatAttribute(45));
  header.insert("spaced", Imf::OpaqueAttribute("my type"));
  header.insert("gr\xF6\xDF", Imf::StringAttribute("\xFF"));
  header.setPreviewImage(Imf::PreviewImage(2, 1));
  header.lineOrder() = Imf::DECREASING_Y;
  header.compression() = Imf::PIZ_COMPRESSION;
  write_lines(header, channels);
  EXPECT_EQ(images(), Words{" 13x10 R16G16B16A16_SFLOAT"});
  // The type is a word of a container's metadata.
  const Dump dump = read_dump(path_, plain());
  EXPECT_EQ(find_attribute(dump.info.attributes, "spaced")->type, "0x6d792074797065");
}

TEST_F(ExrImages, WhatIsLostIsNamed) {
  const std::vector<Made> channels = {{"R"}, {"G"}, {"B"}, {"Z"}};
  Imf::Header header = header_of(channels, window_);
  header.compression() = Imf::DWAB_COMPRESSION;
  header.insert("exr:origin", Imf::StringAttribute("ours"));
  write_lines(header, channels);
  Hints hints = plain();
  hints.channels = {{'R', "R"}, {'G', "G"}, {'B', "B"}};
  EXPECT_EQ(read_dump_info(path_, hints).lost,
            (Words{"its compression, which loses bits (ZIP comes back)", "attribute exr:origin",
                   "channel Z"}));
}

// OpenEXR finds lines by looking where the table of their places is zero.
TEST_F(ExrImages, TableOfPlacesIsMissing) {
  const std::vector<Made> channels = {{"R"}, {"G"}, {"B"}};
  Imf::Header header = header_of(channels, window_);
  header.compression() = Imf::NO_COMPRESSION;
  write_lines(header, channels);
  const Dump whole = read_dump(path_, plain());
  auto bytes = file_bytes(path_);
  const std::string text = "screenWindowWidth";
  const auto at =
      std::search(bytes.begin(), bytes.end(), reinterpret_cast<const std::byte*>(text.data()),
                  reinterpret_cast<const std::byte*>(text.data() + text.size()));
  const auto table = at + static_cast<std::ptrdiff_t>(text.size() + 1 + 6 + 4 + 4 + 1);
  std::fill_n(table, 8 * 10, std::byte{0});
  write_bytes(path_, bytes);
  EXPECT_EQ(read_dump(path_, plain()).texels, whole.texels);
  EXPECT_TRUE(settle_formats({&path_, 1}, {}).plain);
  bytes.resize(bytes.size() - 10);
  write_bytes(path_, bytes);
  EXPECT_TRUE(read_error(path_, plain()));
}

/// OpenEXR would give what its memory held before.
TEST_F(ExrImages, ChunksOfTooFewSamplesAreDamage) {
  const std::vector<Made> channels = {{"R"}, {"G"}};
  const Imath::Box2i window({0, 0}, {39, 29});
  const auto bytes = [](std::initializer_list<int> values) {
    std::vector<std::byte> all;
    for (const int value : values) all.push_back(static_cast<std::byte>(value));
    return all;
  };
  const auto two_zeros = bytes({0x78, 0x9C, 0x63, 0x60, 0, 0, 0, 2, 0, 1});  // by zlib
  const std::pair<Imf::Compression, std::vector<std::byte>> cases[] = {
      {Imf::NO_COMPRESSION, bytes({1, 2, 3, 4})},
      {Imf::RLE_COMPRESSION, bytes({5, 1, -2, 1, 2})},
      {Imf::ZIPS_COMPRESSION, two_zeros},
      {Imf::ZIP_COMPRESSION, two_zeros},
      {Imf::PIZ_COMPRESSION, {}},
      {Imf::PXR24_COMPRESSION, {}},
      {Imf::B44_COMPRESSION, {}},
      {Imf::B44A_COMPRESSION, {}}};
  for (const auto& [compression, packed] : cases) {
    for (const bool tiled : {false, true}) {
      Imf::Header header = header_of(channels, window);
      header.compression() = compression;
      if (tiled) {
        write_tiles(header, channels, Imf::TileDescription(16, 16, Imf::ONE_LEVEL));
      } else {
        write_lines(header, channels);
      }
      EXPECT_FALSE(read_error(path_, plain())) << compression;
      for (const auto& with : {packed, std::vector<std::byte>()}) {
        const auto whole = file_bytes(path_);
        replace_chunk(path_, with);
        const auto error = read_error(path_, plain());
        ASSERT_TRUE(error) << compression << tiled;
        EXPECT_EQ(error->code(), Exit::bad_input);
        EXPECT_NE(std::string(error->what()).find("hold fewer than all samples"), std::string::npos)
            << error->what();
        write_bytes(path_, whole);
      }
    }
  }
}

/// Where their places are not written either.
TEST_F(ExrImages, ChunksAreLookedForWithoutPlaces) {
  const std::vector<Made> channels = {{"R"}};
  Imf::Header header = header_of(channels, Imath::Box2i({-3, 5}, {36, 34}));
  header.compression() = Imf::NO_COMPRESSION;
  write_lines(header, channels);
  const ExrPart part = read_exr_header(path_).front();
  EXPECT_EQ(part.chunk_count(), 30U);
  auto bytes = file_bytes(path_);
  std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(part.places), 8 * 30, std::byte{0});
  write_bytes(path_, bytes);
  EXPECT_FALSE(read_error(path_, plain()));
  // The last chunk ends early, and the file with it.
  bytes.resize(bytes.size() - 2);
  const std::uint32_t size = 40 * 2 - 2;
  std::memcpy(&bytes[bytes.size() - size - 4], &size, sizeof size);
  write_bytes(path_, bytes);
  const auto error = read_error(path_, plain());
  ASSERT_TRUE(error);
  EXPECT_NE(std::string(error->what()).find("texels (-3, 34) to (36, 34)"), std::string::npos)
      << error->what();
}

TEST_F(ExrImages, ImagesOfAFileDifferInTheirChannels) {
  const Dump dump = random_dump(map_texture(Format::R16_SFLOAT, {8, 8, 1}, {8, 8, 1}), 1);
  const std::vector<Dump> twice = {dump, dump};
  try {
    write_dumps(path_, twice);
    FAIL() << "one would be lost";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("two of its images have a channel R"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace gicodec::tools
