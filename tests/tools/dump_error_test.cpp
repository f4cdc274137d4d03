// Images that are no probe dump, and damaged files: an error that says where, never a crash.
#include "dump/dump.h"
#include "tools/dump_support.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepScanLineOutputFile.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <OpenEXR/ImfVecAttribute.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>

namespace gicodec::tools {
namespace {

constexpr int kSide = 16;

Imf::Header colour_header_without_grid() {
  Imf::Header header(kSide, kSide);
  header.insert("gicodec:core", Imf::IntAttribute(6));
  header.insert("gicodec:border", Imf::IntAttribute(1));
  header.insert("gicodec:tiling", Imf::StringAttribute("atlas_xy_z"));
  header.insert("gicodec:vkFormat", Imf::StringAttribute("VK_FORMAT_A2R10G10B10_UNORM_PACK32"));
  return header;
}

Imf::Header colour_header() {
  Imf::Header header = colour_header_without_grid();
  header.insert("gicodec:grid", Imf::V3iAttribute({2, 1, 2}));
  return header;
}

/// A file of those channels; `value` is given to texel (5, 9) of the channel named.
struct Picture {
  Imf::Header header = colour_header();
  std::vector<std::pair<std::string, Imf::PixelType>> channels = {
      {"R", Imf::HALF}, {"G", Imf::HALF}, {"B", Imf::HALF}};
  char odd_channel = 0;
  std::uint32_t odd_sample = 0;

  void write(const std::string& path) {
    std::vector<std::vector<char>> planes;
    Imf::FrameBuffer source;
    for (const auto& [name, type] : channels) {
      header.channels().insert(name, Imf::Channel(type));
      const std::size_t bytes = type == Imf::HALF ? 2 : 4;
      auto& plane = planes.emplace_back(std::size_t{kSide} * kSide * bytes);
      if (name[0] == odd_channel) std::memcpy(&plane[(9 * kSide + 5) * bytes], &odd_sample, bytes);
      source.insert(name, Imf::Slice(type, plane.data(), bytes, bytes * kSide));
    }
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(source);
    file.writePixels(kSide);
  }
};

class DumpError : public testing::Test {
 protected:
  void expect_error(const std::vector<std::string>& parts, const Hints& hints = {}) {
    const auto error = read_error(path_, hints);
    ASSERT_TRUE(error) << "read without an error";
    EXPECT_EQ(error->code(), Exit::bad_input);
    const std::string message = error->what();
    EXPECT_EQ(message.rfind(path_ + ": ", 0), 0U) << message;
    for (const std::string& part : parts) {
      EXPECT_NE(message.find(part), std::string::npos) << message << "\nlacks " << part;
    }
  }

  TemporaryDirectory directory_;
  std::string path_ = directory_.path("color.0003.exr");
};

TEST_F(DumpError, SampleThatIsNoCode) {
  for (const auto& [sample, text] : std::vector<std::pair<std::uint32_t, std::string>>{
           {0x3800, "0.5 is not n/1023, so it is no 10-bit code"},
           {0x8000, "-0"},
           {0x7E01, "nan (0x7E01)"},
           {0x7C00, "inf (0x7C00)"},
           {0x4000, "2 is not n/1023"}}) {
    Picture picture;
    picture.odd_channel = 'G';
    picture.odd_sample = sample;
    picture.write(path_);
    expect_error({"channel G", "texel (5, 9)", "probe 2 (0, 0, 1)", text});
  }
}

TEST_F(DumpError, IntegerBeyondTheCodes) {
  Picture picture;
  picture.channels = {{"R", Imf::UINT}, {"G", Imf::UINT}, {"B", Imf::UINT}, {"A", Imf::UINT}};
  picture.odd_channel = 'A';
  picture.odd_sample = 4;
  picture.write(path_);
  expect_error({"channel A", "texel (5, 9)", "probe 2",
                "4 is no 2-bit code; files of this format hold codes 0 to 3"});
}

TEST_F(DumpError, FloatThatIsNoCode) {
  Picture picture;
  picture.channels[0].second = Imf::FLOAT;
  picture.odd_channel = 'R';
  picture.odd_sample = std::bit_cast<std::uint32_t>(0.5F);
  picture.write(path_);
  expect_error({"channel R", "0.5 is not n/1023"});
}

TEST_F(DumpError, Channels) {
  Picture missing;
  missing.channels.pop_back();
  missing.write(path_);
  expect_error({"channel B", "missing"});

  Picture layer;
  layer.channels[0].first = "left.R";
  layer.write(path_);
  expect_error({"channel R", "missing"});

  Picture type;
  type.header.insert("gicodec:vkFormat", Imf::StringAttribute("R32G32B32A32_SFLOAT"));
  type.write(path_);
  expect_error({"channel R is HALF", "R32G32B32A32_SFLOAT"});
}

TEST_F(DumpError, Geometry) {
  Picture grid;
  grid.header.insert("gicodec:grid", Imf::V3iAttribute({4, 1, 2}));
  grid.write(path_);
  expect_error({"16x16", "grid 4x1x2", "8x8 texel blocks", "32x16"});

  Picture block;
  block.header.insert("gicodec:core", Imf::IntAttribute(8));
  block.write(path_);
  expect_error({"16x16", "multiple of its 10x10 texel blocks"});

  Picture huge;
  huge.header.insert("gicodec:core", Imf::IntAttribute(-6));
  huge.write(path_);
  expect_error({"gicodec:core is -6"});

  Picture negative;
  negative.header.insert("gicodec:grid", Imf::V3iAttribute({-2, 1, -2}));
  negative.write(path_);
  expect_error({"gicodec:grid"});

  Picture many;
  many.header.insert("gicodec:grid", Imf::V3iAttribute({2147483647, 2147483647, 2147483647}));
  many.write(path_);
  expect_error({"grid"});

  Picture tiling;
  tiling.header.insert("gicodec:tiling", Imf::StringAttribute("spiral"));
  tiling.write(path_);
  expect_error({"gicodec:tiling", "spiral"});

  Picture format;
  format.header.insert("gicodec:vkFormat", Imf::StringAttribute("VK_FORMAT_NONE"));
  format.write(path_);
  expect_error({"gicodec:vkFormat", "VK_FORMAT_NONE"});

  Picture type;
  type.header = colour_header_without_grid();
  type.header.insert("gicodec:grid", Imf::StringAttribute("2x1x2"));
  type.write(path_);
  expect_error({"gicodec:grid has type string"});
}

TEST_F(DumpError, RipmapsAndDeepData) {
  Imf::Header header = colour_header_without_grid();
  header.channels().insert("R", Imf::Channel(Imf::HALF));
  {
    Imf::Header tiled = header;
    tiled.setTileDescription(Imf::TileDescription(8, 8, Imf::RIPMAP_LEVELS));
    const Imf::TiledOutputFile file(path_.c_str(), tiled);
  }
  expect_error({"is ripmapped", "with one level, or mipmapped"});
  header.setType(Imf::DEEPSCANLINE);
  header.setVersion(1);
  header.compression() = Imf::ZIPS_COMPRESSION;
  { const Imf::DeepScanLineOutputFile file(path_.c_str(), header); }
  expect_error({"holds deep data", "flatten"});
}

TEST_F(DumpError, PointerOfGitLfs) {
  const std::string text = "version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 9\n";
  write_bytes(path_, std::as_bytes(std::span(text)));
  expect_error({"pointer of Git LFS", "git lfs pull"});
}

TEST_F(DumpError, NotAnImage) {
  write_bytes(path_, {});
  expect_error({"ends within its EXR header"});
  const std::string text = "not an image at all, only text that goes on";
  write_bytes(path_, std::as_bytes(std::span(text)));
  expect_error({"is not an EXR file"});
}

TEST_F(DumpError, NewerCompressions) {
  Picture picture;
  picture.write(path_);
  auto bytes = file_bytes(path_);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  constexpr std::string_view kAttribute("compression\0compression\0\1\0\0\0", 28);
  const std::size_t at = text.find(kAttribute) + kAttribute.size();
  for (const auto& [number, part] :
       {std::pair(10, std::string("HTJ2K")), {11, "HTJ2K"}, {12, "number 12"}}) {
    bytes[at] = static_cast<std::byte>(number);
    write_bytes(path_, bytes);
    expect_error({part, "write it with", "ZIP"});
  }
}

TEST_F(DumpError, NoFile) {
  const auto error = read_error(directory_.path("none.exr"));
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), Exit::io);
}

TEST_F(DumpError, EveryPrefix) {
  Picture().write(path_);
  const auto bytes = file_bytes(path_);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    write_bytes(path_, std::span(bytes).first(size));
    const auto error = read_error(path_);
    ASSERT_TRUE(error) << size;
    EXPECT_EQ(error->code(), Exit::bad_input) << size << error->what();
  }
}

// Sizes in the header must not make the reader allocate more than the file can justify.
TEST_F(DumpError, EveryByteDamaged) {
  Picture().write(path_);
  const auto bytes = file_bytes(path_);
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (const unsigned change : {0x01U, 0x80U, 0xFFU}) {
      auto damaged = bytes;
      damaged[at] ^= static_cast<std::byte>(change);
      write_bytes(path_, damaged);
      const auto error = read_error(path_);
      if (!error) continue;
      EXPECT_EQ(error->code(), Exit::bad_input) << at << " " << error->what();
    }
  }
}

TEST_F(DumpError, ClaimedSizes) {
  Picture().write(path_);
  const auto bytes = file_bytes(path_);
  const std::string name = "dataWindow";
  const auto found =
      std::search(bytes.begin(), bytes.end(), reinterpret_cast<const std::byte*>(name.data()),
                  reinterpret_cast<const std::byte*>(name.data() + name.size()));
  ASSERT_NE(found, bytes.end());
  // Name, type, size, then xMin, yMin, xMax, yMax.
  const auto box = static_cast<std::size_t>(found - bytes.begin()) + 11 + 6 + 4;
  for (const auto& [x, y] : {std::pair{INT32_MAX, INT32_MAX},
                             {1 << 21, 1 << 21},
                             {15, INT32_MAX},
                             {INT32_MIN, 15},
                             {-1, -1},
                             {1 << 23, 0}}) {
    auto damaged = bytes;
    std::memcpy(&damaged[box + 8], &x, 4);
    std::memcpy(&damaged[box + 12], &y, 4);
    write_bytes(path_, damaged);
    expect_error({"texels is not supported"});
  }
}

}  // namespace
}  // namespace gicodec::tools
