// DDS, KTX2 and raw files: every bit of texels and heads comes back, and nothing else is taken.
#include "dump/texture_file.h"
#include "dump/geometry_attributes.h"
#include "dump/ktx2_format.h"

#include "tools/dump_support.h"
#include "tools/texture_file_inverse.h"

#include <gicodec/textures.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <string_view>

namespace gicodec::tools {
namespace {

constexpr std::array<const char*, 3> kEndings = {"dds", "ktx2", "raw"};

/// Rows, arrays and volumes, of sides that blocks do not divide, of one texel too.
const std::array<std::pair<Grid, BlockShape>, 5> kShapes{{{{13, 7, 1}, {8, 8, 1}},
                                                          {{1, 1, 1}, {8, 8, 1}},
                                                          {{8, 16, 1}, {8, 8, 1}},
                                                          {{5, 3, 4}, {8, 8, 1}},
                                                          {{5, 9, 7}, {4, 4, 4}}}};

bool is_dxgi(Format format) { return has_format(ImageKind::dds, format); }

std::string message_of(const std::string& path, const Hints& hints = {}) {
  const auto error = read_error(path, hints);
  if (!error) return "";
  EXPECT_NE(error->code(), Exit::internal) << error->what();
  return error->what();
}

void expect_part(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << "\"" << text << "\" lacks " << part;
}

void patch(std::vector<std::byte>& bytes, std::size_t at, std::uint32_t word) {
  set_word(bytes, at, word);
}

/// A file without metadata.
std::vector<std::byte> file_of(const TemporaryDirectory& directory, const char* name,
                               const Dump& dump) {
  DumpInfo info = dump.info;
  info.attributes.clear();
  write_dump(directory.path(name), info, dump.texels, Existing::replace);
  return file_bytes(directory.path(name));
}

TEST(TextureFile, EveryFormatAndShape) {
  const TemporaryDirectory directory;
  std::uint32_t seed = 0;
  for (const FormatInfo& format : formats()) {
    for (const auto& [records, block] : kShapes) {
      const TextureDesc desc = map_texture(format.record, records, block);
      for (const char* ending : kEndings) {
        if (std::string_view(ending) == "dds" && !is_dxgi(format.record.format)) continue;
        SCOPED_TRACE(fmt::format("{} {} {}", format.name, to_string(records), ending));
        const std::string path = directory.path(fmt::format("x.{}", ending));
        const Dump dump{make_info(desc), random_texels(desc, ++seed)};
        write_dump(path, dump.info, dump.texels, Existing::replace);
        const Dump back = read_dump(path);
        EXPECT_EQ(back.info.desc, desc);
        EXPECT_EQ(back.texels, dump.texels);
        EXPECT_EQ(read_dump_info(path).desc, desc);
        if (std::string_view(ending) == "dds") {
          EXPECT_TRUE(back.info.attributes.empty());
        }
        const auto first = file_bytes(path);
        write_dump(path, back.info, back.texels, Existing::replace);
        EXPECT_EQ(file_bytes(path), first);
      }
    }
  }
}

TEST(TextureFile, KindsSayWhichFormatsTheyHave) {
  const TemporaryDirectory directory;
  for (const FormatInfo& format : formats()) {
    const TextureDesc desc = map_texture(format.record, {4, 4, 1}, {4, 4, 1});
    const auto texels = random_texels(desc, 1);
    for (const char* ending : {"exr", "dds", "ktx2", "raw"}) {
      const std::string path = directory.path(fmt::format("x.{}", ending));
      bool written = true;
      try {
        write_dump(path, make_info(desc), texels, Existing::replace);
        written = read_dump(path).texels == texels;
      } catch (const Error&) {
        written = false;
      }
      EXPECT_EQ(written, has_format(*image_kind(path), format.record.format))
          << format.name << ' ' << ending;
    }
    EXPECT_FALSE(has_format(ImageKind::png, format.record.format));
  }
}

TEST(TextureFile, NoSidecarWithoutTexels) {
  const TemporaryDirectory directory;
  const Dump dump = random_dump(map_texture(Format::R8_UNORM, {4, 4, 1}, {4, 4, 1}), 1);
  write_bytes(directory.path("x.raw"), std::vector<std::byte>(1));
  EXPECT_THROW(write_dump(directory.path("x.raw"), dump.info, dump.texels), Error);
  EXPECT_EQ(directory.files(), std::vector<std::string>{"x.raw"});
}

TEST(TextureFile, ProbesOfEveryTiling) {
  const TemporaryDirectory directory;
  for (std::uint8_t tiling = 0; tiling < kTilingCount; ++tiling) {
    const TextureDesc desc =
        probe_texture(Format::R16G16_SFLOAT, {3, 2, 4}, 6, 1, static_cast<Tiling>(tiling));
    const Dump dump = random_dump(desc, tiling);
    for (const char* ending : kEndings) {
      const std::string path = directory.path(fmt::format("x.{}", ending));
      write_dump(path, dump.info, dump.texels, Existing::replace);
      // DDS files have no metadata.
      Hints hints;
      hints.grid = desc.grid;
      hints.core = 6;
      hints.tiling = desc.layout.tiling;
      const Dump back =
          std::string_view(ending) == "dds" ? read_dump(path, hints) : read_dump(path);
      EXPECT_EQ(back.info.desc, desc) << ending;
      EXPECT_EQ(back.texels, dump.texels);
      EXPECT_EQ(read_dump(path, hints_of(desc)).info.desc, desc);
    }
  }
}

TEST(TextureFile, AttributesComeBack) {
  const TemporaryDirectory directory;
  const TextureDesc desc = map_texture(Format::R8_UNORM, {3, 3, 1}, {8, 8, 1});
  Dump dump{make_info(desc), random_texels(desc, 1)};
  for (const auto& [name, text] : {std::pair("KTXwriter", "somebody"), std::pair("empty", ""),
                                   std::pair("gicodec:origin", "1 2 3"), std::pair("zäh", "…")}) {
    set_attribute(dump.info.attributes, text_attribute(name, text));
  }
  for (const char* ending : {"ktx2", "raw"}) {
    const std::string path = directory.path(fmt::format("x.{}", ending));
    write_dump(path, dump.info, dump.texels, Existing::replace);
    EXPECT_EQ(read_dump(path).info.attributes, dump.info.attributes) << ending;
  }
  // Values of KTX2 may be any bytes.
  for (const std::string_view value :
       {std::string_view("\1\2\3", 3), std::string_view("a\0b", 3), std::string_view("no end"),
        std::string_view("", 0), std::string_view("0x12\0", 5), std::string_view("\xFF\0", 2)}) {
    set_attribute(dump.info.attributes, bytes_attribute("any", std::as_bytes(std::span(value))));
    write_dump(directory.path("x.ktx2"), dump.info, dump.texels, Existing::replace);
    EXPECT_EQ(read_dump(directory.path("x.ktx2")).info.attributes, dump.info.attributes);
  }
}

TEST(TextureFile, ForeignHeadersComeBackByteForByte) {
  const TemporaryDirectory directory;
  const TextureDesc desc = map_texture(Format::R8G8B8A8_UNORM, {12, 5, 1}, {8, 8, 1});
  const Dump dump{make_info(desc), random_texels(desc, 2)};
  const auto expect_same = [&](const char* name, const std::vector<std::byte>& bytes) {
    const std::string path = directory.path(name);
    write_bytes(path, bytes);
    const Dump back = read_dump(path);
    EXPECT_EQ(back.info.desc, desc);
    EXPECT_EQ(back.texels, dump.texels);
    write_dump(path, back.info, back.texels, Existing::replace);
    EXPECT_EQ(file_bytes(path), bytes);
  };
  std::vector<std::byte> dds = file_of(directory, "x.dds", dump);
  patch(dds, 24, 1);   // A depth of 1,
  patch(dds, 40, 77);  // something reserved,
  patch(dds, 28, 0);   // no number of levels.
  expect_same("x.dds", dds);
  // The header of before DX10: masks.
  std::vector<std::byte> legacy(dds.begin(), dds.begin() + 128);
  legacy.insert(legacy.end(), dds.begin() + 148, dds.end());
  const std::array<std::uint32_t, 7> masks = {0x41, 0, 32, 0xFF, 0xFF00, 0xFF0000, 0xFF000000};
  for (std::size_t i = 0; i < masks.size(); ++i) patch(legacy, 80 + 4 * i, masks[i]);
  expect_same("x.dds", legacy);
  std::vector<std::byte> ktx2 = file_of(directory, "x.ktx2", dump);
  patch(ktx2, 40, 0);            // Levels are to be made by who reads it.
  patch(ktx2, 104 + 12, 0x201);  // Other primaries.
  expect_same("x.ktx2", ktx2);
}

TEST(TextureFile, CompressedBlocksThatAreNotFull) {
  const TemporaryDirectory directory;
  const TextureDesc desc = map_texture(Format::BC7_UNORM_BLOCK, {4, 2, 1}, {8, 8, 1});
  const Dump dump{make_info(desc), random_texels(desc, 3)};
  for (const auto& [name, width, height] :
       {std::tuple("x.dds", 16, 12), std::tuple("x.ktx2", 20, 24)}) {
    const std::string path = directory.path(name);
    auto bytes = file_of(directory, name, dump);
    ASSERT_EQ(word_at(bytes, static_cast<std::size_t>(width)), 16U);
    patch(bytes, static_cast<std::size_t>(width), 13);
    patch(bytes, static_cast<std::size_t>(height), 5);
    write_bytes(path, bytes);
    const Dump back = read_dump(path);
    EXPECT_EQ(back.texels, dump.texels);
    write_dump(path, back.info, back.texels, Existing::replace);
    EXPECT_EQ(file_bytes(path), bytes) << name;
  }
  write_bytes(directory.path("x.json"),
              std::as_bytes(std::span(
                  std::string_view("{\"format\": \"BC7_UNORM_BLOCK\", \"extent\": [13, 5]}"))));
  write_bytes(directory.path("x.raw"), dump.texels);
  const Dump back = read_dump(directory.path("x.raw"));
  EXPECT_EQ(back.info.desc, desc);
  EXPECT_EQ(back.texels, dump.texels);
  write_dump(directory.path("y.raw"), back.info, back.texels);
  EXPECT_EQ(read_dump(directory.path("y.raw")).info.attributes, back.info.attributes);
}

TEST(TextureFile, FormatsThatAreUnknownAreTakenForOthers) {
  const TemporaryDirectory directory;
  const TextureDesc desc = map_texture(Format::R8G8B8A8_UNORM, {6, 5, 1}, {8, 8, 1});
  const Dump dump{make_info(desc), random_texels(desc, 4)};
  for (const auto& [name, at, number] :
       {std::tuple("x.dds", 128, 32U), std::tuple("x.ktx2", 12, 42U)}) {
    const std::string path = directory.path(name);
    auto bytes = file_of(directory, name, dump);
    patch(bytes, static_cast<std::size_t>(at), number);
    write_bytes(path, bytes);
    expect_part(message_of(path), fmt::format("format {}", number).substr(7));
    expect_part(message_of(path), "--vk-format");
    Hints hints;
    hints.format = Format::R8G8B8A8_UNORM;
    const Dump back = read_dump(path, hints);
    EXPECT_EQ(back.texels, dump.texels);
    write_dump(path, back.info, back.texels, Existing::replace);
    EXPECT_EQ(file_bytes(path), bytes);
    hints.format = Format::R16_UNORM;
    expect_part(message_of(path, hints), "check its format");
  }
}

TEST(TextureFile, WhatCannotBeReadIsNamed) {
  const TemporaryDirectory directory;
  const TextureDesc desc = map_texture(Format::R8G8B8A8_UNORM, {8, 8, 1}, {8, 8, 1});
  const Dump dump{make_info(desc), random_texels(desc, 5)};
  struct Case {
    const char* name;
    std::size_t at;
    std::uint32_t word;
    const char* part;
  };
  for (const Case& c :
       {Case{"x.dds", 28, 4, "is truncated"},
        Case{"x.dds", 28, 5, "5 levels of 8x8x1 texels"},
        Case{"x.dds", 136, 4, "is truncated"},
        Case{"x.dds", 4, 123, "damaged: size 123"},
        Case{"x.dds", 76, 31, "damaged: pixel format size 31"},
        Case{"x.dds", 140, 0, "is damaged"},
        Case{"x.dds", 140, 2, "is truncated"},
        Case{"x.dds", 16, 7, "has 32 bytes behind the texels that its head describes"},
        Case{"x.dds", 16, 0xFFFFFFFF, "x.dds"},
        Case{"x.dds", 0, 1, "is not a DDS file"},
        Case{"x.ktx2", 40, 5, "damaged: 5 levels of 8x8x1 texels"},
        Case{"x.ktx2", 44, 1, "holds BasisLZ"},
        Case{"x.ktx2", 44, 2, "a level is damaged: Zstandard says"},
        Case{"x.ktx2", 44, 3, "a level is damaged: ZLIB says"},
        Case{"x.ktx2", 44, 9, "is supercompressed by scheme 9"},
        Case{"x.ktx2", 36, 6, "level 0 has 256 bytes, and 8x8x1 texels"},
        Case{"x.ktx2", 36, 2, "is damaged: 2 faces"},
        Case{"x.ktx2", 20, 0, "a width of 0"},
        Case{"x.ktx2", 12, 0, "VkFormat 0"},
        Case{"x.ktx2", 0, 0, "is not a KTX2 file"},
        Case{"x.ktx2", 52, 0xFFFFFFFF, "is damaged"},
        Case{"x.ktx2", 60, 4, "keys and values are damaged"}}) {
    SCOPED_TRACE(c.part);
    auto bytes = file_of(directory, c.name, dump);
    patch(bytes, c.at, c.word);
    if (c.at == 60) patch(bytes, 56, 104);
    write_bytes(directory.path(c.name), bytes);
    expect_part(message_of(directory.path(c.name)), c.part);
  }
  DumpInfo signs = make_info(map_texture(Format::R8G8B8_SNORM, {2, 2, 1}, {8, 8, 1}));
  EXPECT_THROW(write_dump(directory.path("y.dds"), signs, std::vector<std::byte>(12)), Error);
}

/// For texture_file_fault().
class BytesAtPath {
 public:
  explicit BytesAtPath(std::span<const std::byte> bytes) { write_bytes(path(), bytes); }
  [[nodiscard]] std::string path() const { return directory_.path("x"); }

 private:
  TemporaryDirectory directory_;
};

/// Cut off anywhere, or with a bit or a byte that is another: refused, or a texture whose texels
/// are all there and come back.
/// Levels begin at multiples of a texel and of four bytes, the smallest first.
TEST(TextureFile, LevelsOfOddSizesAreAligned) {
  const TemporaryDirectory directory;
  TextureHead head;
  head.texels = {5, 7, 1};
  head.levels = 3;
  write_dumps(directory.path("x.ktx2"), random_images(Format::R8_UNORM, head));
  const auto bytes = file_bytes(directory.path("x.ktx2"));
  std::uint64_t end = 0;
  for (std::size_t level = 3; level-- > 0;) {
    const std::uint64_t offset = word_at(bytes, 80 + 24 * level);
    EXPECT_EQ(offset % 4, 0U) << level;
    EXPECT_GE(offset, end);
    end = offset + word_at(bytes, 80 + 24 * level + 8);
  }
  EXPECT_EQ(end, bytes.size());
}

/// What Khronos' data format specification says of a sample's channel.
TEST(TextureFile, ChannelsOfCompressedBlocks) {
  for (const auto& [format, channel] :
       {std::pair(Format::BC7_UNORM_BLOCK, 0), std::pair(Format::BC3_UNORM_BLOCK, 15),
        std::pair(Format::ETC2_R8G8B8_UNORM_BLOCK, 2),
        std::pair(Format::ETC2_R8G8B8A8_UNORM_BLOCK, 15)}) {
    constexpr std::size_t kFirstSample = 28;  // behind the size and the basic block's head
    const auto descriptor = ktx2_descriptor(format);
    EXPECT_EQ(std::to_integer<int>(descriptor[kFirstSample + 3]) & 15, channel);
  }
}

TEST(TextureFile, FormatsMayHaveThePrefixOfVulkan) {
  const Attribute plain{std::string(kFormat), "string", "R8_UNORM"};
  EXPECT_TRUE(same_meaning(plain, {plain.name, "string", "VK_FORMAT_R8_UNORM"}));
  EXPECT_FALSE(same_meaning(plain, {plain.name, "string", "VK_FORMAT_R8_SNORM"}));
}

TEST(TextureFile, ADdsFileOfItsFirstBytes) {
  const TemporaryDirectory directory;
  for (std::size_t size = 0; size < 8; ++size) {
    write_bytes(directory.path("x.dds"),
                std::as_bytes(std::span(std::string_view("DDS \x7C\0\0\0", 8)).first(size)));
    expect_part(message_of(directory.path("x.dds")), size < 4 ? "no" : "truncated");
  }
}

TEST(TextureFile, TruncatedAndFlippedHeads) {
  const TemporaryDirectory directory;
  const TextureDesc desc = map_texture(Format::R16_SFLOAT, {5, 3, 2}, {8, 8, 1});
  const Dump dump{make_info(desc), random_texels(desc, 6)};
  for (const char* name : {"x.dds", "x.ktx2"}) {
    const std::string path = directory.path(name);
    write_dump(path, dump.info, dump.texels, Existing::replace);
    const auto whole = file_bytes(path);
    for (std::size_t size = 0; size < whole.size(); ++size) {
      write_bytes(path, std::span(whole).first(size));
      EXPECT_NE(message_of(path), "") << size;
    }
    for (std::size_t at = 0; at < whole.size() - dump.texels.size(); ++at) {
      for (const unsigned mask : {0x01U, 0x80U, 0xFFU}) {
        auto bytes = whole;
        bytes[at] ^= static_cast<std::byte>(mask);
        write_bytes(path, bytes);
        const auto error = read_error(path);
        if (error) {
          EXPECT_TRUE(error->code() == Exit::bad_input) << error->what();
          continue;
        }
        EXPECT_EQ(texture_file_fault<BytesAtPath>(bytes, *image_kind(name)), "") << at;
      }
    }
    auto longer = whole;
    longer.push_back(std::byte{1});
    write_bytes(path, longer);
    if (std::string_view(name) == "x.dds") {
      EXPECT_NE(message_of(path), "");
      continue;
    }
    EXPECT_EQ(texture_file_fault<BytesAtPath>(longer, ImageKind::ktx2), "");
  }
}

TEST(TextureFile, KeysInAnyOrderComeBack) {
  const TemporaryDirectory directory;
  const TextureDesc desc = map_texture(Format::R8G8B8A8_UNORM, {5, 3, 1}, {8, 8, 1});
  const auto plain = file_of(directory, "x.ktx2", {make_info(desc), random_texels(desc, 6)});
  // Keys that are not in order, one twice, one that is no UTF-8, and bytes between them.
  std::string keys;
  for (const std::string& entry : {std::string("b\0second\0", 9), std::string("a\0first\0", 8),
                                   std::string("b\0again\0", 8), std::string("\xF6\0x", 3)}) {
    const auto size = static_cast<std::uint32_t>(entry.size());
    keys.append(reinterpret_cast<const char*>(&size), sizeof size);
    keys += entry;
    while (keys.size() % 4 != 0) keys += '!';
  }
  constexpr std::size_t kLevel = 80, kKeys = 56;
  const std::size_t texels = texture_bytes(desc), begin = plain.size() - texels;
  auto bytes =
      std::vector<std::byte>(plain.begin(), plain.begin() + static_cast<std::ptrdiff_t>(begin));
  patch(bytes, kKeys, static_cast<std::uint32_t>(begin));
  patch(bytes, kKeys + 4, static_cast<std::uint32_t>(keys.size()));
  patch(bytes, kLevel, static_cast<std::uint32_t>(begin + keys.size()));
  const auto added = std::as_bytes(std::span(keys));
  bytes.insert(bytes.end(), added.begin(), added.end());
  bytes.insert(bytes.end(), plain.begin() + static_cast<std::ptrdiff_t>(begin), plain.end());
  EXPECT_EQ(texture_file_fault<BytesAtPath>(bytes, ImageKind::ktx2), "");
  write_bytes(directory.path("y.ktx2"), bytes);
  const Attributes attributes = read_dump_info(directory.path("y.ktx2")).attributes;
  EXPECT_EQ(find_attribute(attributes, "a")->value, "first");
  EXPECT_EQ(find_attribute(attributes, "b")->value, "second");
}

TEST(TextureFile, HeadsOfOtherTexturesAreNotWritten) {
  const TemporaryDirectory directory;
  const TextureDesc desc = map_texture(Format::R16_SFLOAT, {5, 3, 1}, {8, 8, 1});
  const TextureDesc other = map_texture(Format::R16_SFLOAT, {3, 5, 1}, {8, 8, 1});
  const Dump dump{make_info(desc), random_texels(desc, 6)};
  for (const auto& [name, field, size] :
       {std::tuple("x.dds", kDdsHeader, 148), std::tuple("x.ktx2", kKtx2Head, 0)}) {
    const auto head = file_of(directory, name, {make_info(other), random_texels(other, 1)});
    const std::size_t all = size > 0 ? std::size_t(size) : head.size() - texture_bytes(other);
    for (const std::size_t bytes : {std::size_t{0}, std::size_t{3}, all}) {
      DumpInfo info = dump.info;
      set_attribute(info.attributes, bytes_attribute(field, std::span(head).first(bytes)));
      EXPECT_THROW(write_dump(directory.path(name), info, dump.texels, Existing::replace), Error);
    }
  }
}

class Sidecar : public testing::Test {
 protected:
  std::string message(std::string_view json) {
    write_bytes(path_, std::vector<std::byte>(64));
    write_bytes(directory_.path("x.json"), std::as_bytes(std::span(json)));
    return message_of(path_);
  }
  TemporaryDirectory directory_;
  std::string path_ = directory_.path("x.0007.raw");
};

TEST_F(Sidecar, SaysWhatIsWrong) {
  write_bytes(path_, std::vector<std::byte>(64));
  expect_part(message_of(path_), "has no sidecar");
  for (const auto& [json, part] : {
           std::pair("", "is no JSON from line 1 on"),
           std::pair("[]", "is no JSON object"),
           std::pair("{\n  \"extent\": [8, 8],\n}", "is no JSON from line 3 on"),
           std::pair("{\"extent\": [8, 8], \"extent\": [4, 4]}", "\"extent\" stands twice"),
           std::pair("{\"extent\": [8, 8], \"attributes\": {\"a\": \"1\", \"a\": \"2\"}}",
                     "\"a\" stands twice"),
           std::pair("{\"extent\": [8, 8], \"attributes\": {\"\": \"1\"}}", "has no name"),
           std::pair("{\"extent\": [8, 8e880]}", "a number that is too large"),
           std::pair("{}", "lacks \"extent\""),
           std::pair("{\"extent\": [8]}", "no list of two or three sides"),
           std::pair("{\"extent\": [8, 0]}", "no list of two or three sides"),
           std::pair("{\"extent\": [8, -1]}", "no list of two or three sides"),
           std::pair("{\"extent\": [8, 8.5]}", "no list of two or three sides"),
           std::pair("{\"extent\": [8, 8, 1, 1]}", "no list of two or three sides"),
           std::pair("{\"extent\": [8, 8]}", "--vk-format"),
           std::pair("{\"extent\": [8, 8], \"format\": \"R9\"}", "no known format"),
           std::pair("{\"extent\": [8, 8], \"format\": 9}", "\"format\" is not a text"),
           std::pair("{\"extent\": [8, 8], \"block\": [8]}", "is not a list of three numbers"),
           std::pair("{\"extent\": [8, 8], \"core\": \"8\"}", "\"core\" is not a number"),
           std::pair("{\"extent\": [8, 8], \"colour\": 1}", "member \"colour\" is unknown"),
           std::pair("{\"extent\": [8, 8], \"attributes\": 1}", "is no object"),
           std::pair("{\"extent\": [8, 8], \"attributes\": {\"a\": 1}}", "write it in quotes"),
           std::pair("{\"extent\": [8, 9], \"format\": \"R8_UNORM\"}", "is truncated"),
           std::pair("{\"extent\": [8, 7], \"format\": \"R8_UNORM\"}", "check its format"),
           std::pair("{\"extent\": [8, 8], \"format\": \"R8_UNORM\", \"block\": [65, 1, 1]}",
                     "out of range"),
           std::pair("{\"extent\": [8, 8], \"format\": \"R8_UNORM\", \"grid\": [4, 1, 1]}",
                     "do not make"),
       }) {
    expect_part(message(json), part);
  }
  EXPECT_EQ(message("{\"extent\": [8, 8], \"format\": \"R8_UNORM\"}"), "");
}

TEST_F(Sidecar, MayHaveAMebibyte) {
  std::string json = "{\"extent\": [8, 8], \"format\": \"R8_UNORM\"}";
  json.resize(std::size_t{1} << 20, ' ');
  EXPECT_EQ(message(json), "");
  json += ' ';
  EXPECT_NE(message(json), "");
}

TEST_F(Sidecar, OfOneFrameOrOfAll) {
  const TextureDesc desc = map_texture(Format::R8_UNORM, {8, 4, 2}, {4, 4, 2});
  const Dump dump{make_info(desc), random_texels(desc, 1)};
  write_dump(path_, dump.info, dump.texels);
  EXPECT_EQ(directory_.files(), (std::vector<std::string>{"x.0007.json", "x.0007.raw"}));
  std::filesystem::rename(directory_.path("x.0007.json"), directory_.path("x.json"));
  const Dump back = read_dump(path_);
  EXPECT_EQ(back.info.desc, desc);
  EXPECT_EQ(back.texels, dump.texels);
  // The other frames find theirs, which is not replaced.
  write_dump(directory_.path("x.0008.raw"), back.info, back.texels);
  write_dump(directory_.path("x.0009.raw"), back.info, back.texels);
  EXPECT_EQ(directory_.files(),
            (std::vector<std::string>{"x.0007.raw", "x.0008.raw", "x.0009.raw", "x.json"}));
  EXPECT_EQ(read_dump(directory_.path("x.0009.raw")).texels, dump.texels);
  // Without any, whoever knows the texture reads it, and none is written.
  std::filesystem::remove(directory_.path("x.json"));
  const Dump known = read_dump(path_, hints_of(desc));
  EXPECT_EQ(known.texels, dump.texels);
  write_dump(directory_.path("y.raw"), known.info, known.texels);
  EXPECT_EQ(directory_.files().back(), "y.raw");
}

}  // namespace
}  // namespace gicodec::tools
