// Records: the presets, and every rule for those of applications.
#include "shapes.h"
#include "support.h"

#include "base/bytes.h"
#include "bitstream/description.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <string>

namespace gicodec {
namespace {

using namespace test;

/// FORMAT.md's table: number, bytes, components as "R 8@0, G 8@8".
struct FormatRow {
  std::string_view name;
  std::uint32_t number;
  unsigned bytes;
  std::string_view components;
};
constexpr FormatRow kTable[] = {
    {"R8_UNORM", 9, 1, "R 8@0"},
    {"R8_SNORM", 10, 1, "R 8@0"},
    {"R8_UINT", 13, 1, "R 8@0"},
    {"R8_SRGB", 15, 1, "R 8@0"},
    {"R8G8_UNORM", 16, 2, "R 8@0, G 8@8"},
    {"R8G8_SNORM", 17, 2, "R 8@0, G 8@8"},
    {"R8G8_UINT", 20, 2, "R 8@0, G 8@8"},
    {"R8G8_SRGB", 22, 2, "R 8@0, G 8@8"},
    {"R8G8B8_UNORM", 23, 3, "R 8@0, G 8@8, B 8@16"},
    {"R8G8B8_SNORM", 24, 3, "R 8@0, G 8@8, B 8@16"},
    {"R8G8B8_UINT", 27, 3, "R 8@0, G 8@8, B 8@16"},
    {"R8G8B8_SRGB", 29, 3, "R 8@0, G 8@8, B 8@16"},
    {"B8G8R8_UNORM", 30, 3, "R 8@16, G 8@8, B 8@0"},
    {"B8G8R8_SRGB", 36, 3, "R 8@16, G 8@8, B 8@0"},
    {"R8G8B8A8_UNORM", 37, 4, "R 8@0, G 8@8, B 8@16, A 8@24"},
    {"R8G8B8A8_SNORM", 38, 4, "R 8@0, G 8@8, B 8@16, A 8@24"},
    {"R8G8B8A8_UINT", 41, 4, "R 8@0, G 8@8, B 8@16, A 8@24"},
    {"R8G8B8A8_SRGB", 43, 4, "R 8@0, G 8@8, B 8@16, A 8@24"},
    {"B8G8R8A8_UNORM", 44, 4, "R 8@16, G 8@8, B 8@0, A 8@24"},
    {"B8G8R8A8_SRGB", 50, 4, "R 8@16, G 8@8, B 8@0, A 8@24"},
    {"A8B8G8R8_UNORM_PACK32", 51, 4, "R 8@0, G 8@8, B 8@16, A 8@24"},
    {"A8B8G8R8_SRGB_PACK32", 57, 4, "R 8@0, G 8@8, B 8@16, A 8@24"},
    {"A2R10G10B10_UNORM_PACK32", 58, 4, "R 10@20, G 10@10, B 10@0, A 2@30"},
    {"A2B10G10R10_UNORM_PACK32", 64, 4, "R 10@0, G 10@10, B 10@20, A 2@30"},
    {"R16_UNORM", 70, 2, "R 16@0"},
    {"R16_SNORM", 71, 2, "R 16@0"},
    {"R16_UINT", 74, 2, "R 16@0"},
    {"R16_SFLOAT", 76, 2, "R 16@0"},
    {"R16G16_UNORM", 77, 4, "R 16@0, G 16@16"},
    {"R16G16_SNORM", 78, 4, "R 16@0, G 16@16"},
    {"R16G16_UINT", 81, 4, "R 16@0, G 16@16"},
    {"R16G16_SFLOAT", 83, 4, "R 16@0, G 16@16"},
    {"R16G16B16_UNORM", 84, 6, "R 16@0, G 16@16, B 16@32"},
    {"R16G16B16_SNORM", 85, 6, "R 16@0, G 16@16, B 16@32"},
    {"R16G16B16_UINT", 88, 6, "R 16@0, G 16@16, B 16@32"},
    {"R16G16B16_SFLOAT", 90, 6, "R 16@0, G 16@16, B 16@32"},
    {"R16G16B16A16_UNORM", 91, 8, "R 16@0, G 16@16, B 16@32, A 16@48"},
    {"R16G16B16A16_SNORM", 92, 8, "R 16@0, G 16@16, B 16@32, A 16@48"},
    {"R16G16B16A16_UINT", 95, 8, "R 16@0, G 16@16, B 16@32, A 16@48"},
    {"R16G16B16A16_SFLOAT", 97, 8, "R 16@0, G 16@16, B 16@32, A 16@48"},
    {"R32_UINT", 98, 4, "R 32@0"},
    {"R32_SFLOAT", 100, 4, "R 32@0"},
    {"R32G32_UINT", 101, 8, "R 32@0, G 32@32"},
    {"R32G32_SFLOAT", 103, 8, "R 32@0, G 32@32"},
    {"R32G32B32_UINT", 104, 12, "R 32@0, G 32@32, B 32@64"},
    {"R32G32B32_SFLOAT", 106, 12, "R 32@0, G 32@32, B 32@64"},
    {"R32G32B32A32_UINT", 107, 16, "R 32@0, G 32@32, B 32@64, A 32@96"},
    {"R32G32B32A32_SFLOAT", 109, 16, "R 32@0, G 32@32, B 32@64, A 32@96"},
    {"B10G11R11_UFLOAT_PACK32", 122, 4, "R 11@0, G 11@11, B 10@22"},
    {"E5B9G9R9_UFLOAT_PACK32", 123, 4, "R 9@0, G 9@9, B 9@18, E 5@27"},
    {"BC1_RGB_UNORM_BLOCK", 131, 8, "0 32@0, 1 32@32"},
    {"BC1_RGB_SRGB_BLOCK", 132, 8, "0 32@0, 1 32@32"},
    {"BC1_RGBA_UNORM_BLOCK", 133, 8, "0 32@0, 1 32@32"},
    {"BC1_RGBA_SRGB_BLOCK", 134, 8, "0 32@0, 1 32@32"},
    {"BC2_UNORM_BLOCK", 135, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"BC2_SRGB_BLOCK", 136, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"BC3_UNORM_BLOCK", 137, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"BC3_SRGB_BLOCK", 138, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"BC4_UNORM_BLOCK", 139, 8, "0 32@0, 1 32@32"},
    {"BC4_SNORM_BLOCK", 140, 8, "0 32@0, 1 32@32"},
    {"BC5_UNORM_BLOCK", 141, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"BC5_SNORM_BLOCK", 142, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"BC6H_UFLOAT_BLOCK", 143, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"BC6H_SFLOAT_BLOCK", 144, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"BC7_UNORM_BLOCK", 145, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"BC7_SRGB_BLOCK", 146, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ETC2_R8G8B8_UNORM_BLOCK", 147, 8, "0 32@0, 1 32@32"},
    {"ETC2_R8G8B8_SRGB_BLOCK", 148, 8, "0 32@0, 1 32@32"},
    {"ETC2_R8G8B8A1_UNORM_BLOCK", 149, 8, "0 32@0, 1 32@32"},
    {"ETC2_R8G8B8A1_SRGB_BLOCK", 150, 8, "0 32@0, 1 32@32"},
    {"ETC2_R8G8B8A8_UNORM_BLOCK", 151, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ETC2_R8G8B8A8_SRGB_BLOCK", 152, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"EAC_R11_UNORM_BLOCK", 153, 8, "0 32@0, 1 32@32"},
    {"EAC_R11_SNORM_BLOCK", 154, 8, "0 32@0, 1 32@32"},
    {"EAC_R11G11_UNORM_BLOCK", 155, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"EAC_R11G11_SNORM_BLOCK", 156, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_4x4_UNORM_BLOCK", 157, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_4x4_SRGB_BLOCK", 158, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_5x4_UNORM_BLOCK", 159, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_5x4_SRGB_BLOCK", 160, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_5x5_UNORM_BLOCK", 161, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_5x5_SRGB_BLOCK", 162, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_6x5_UNORM_BLOCK", 163, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_6x5_SRGB_BLOCK", 164, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_6x6_UNORM_BLOCK", 165, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_6x6_SRGB_BLOCK", 166, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_8x5_UNORM_BLOCK", 167, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_8x5_SRGB_BLOCK", 168, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_8x6_UNORM_BLOCK", 169, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_8x6_SRGB_BLOCK", 170, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_8x8_UNORM_BLOCK", 171, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_8x8_SRGB_BLOCK", 172, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_10x5_UNORM_BLOCK", 173, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_10x5_SRGB_BLOCK", 174, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_10x6_UNORM_BLOCK", 175, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_10x6_SRGB_BLOCK", 176, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_10x8_UNORM_BLOCK", 177, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_10x8_SRGB_BLOCK", 178, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_10x10_UNORM_BLOCK", 179, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_10x10_SRGB_BLOCK", 180, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_12x10_UNORM_BLOCK", 181, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_12x10_SRGB_BLOCK", 182, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_12x12_UNORM_BLOCK", 183, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_12x12_SRGB_BLOCK", 184, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_4x4_SFLOAT_BLOCK", 1000066000, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_5x4_SFLOAT_BLOCK", 1000066001, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_5x5_SFLOAT_BLOCK", 1000066002, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_6x5_SFLOAT_BLOCK", 1000066003, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_6x6_SFLOAT_BLOCK", 1000066004, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_8x5_SFLOAT_BLOCK", 1000066005, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_8x6_SFLOAT_BLOCK", 1000066006, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_8x8_SFLOAT_BLOCK", 1000066007, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_10x5_SFLOAT_BLOCK", 1000066008, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_10x6_SFLOAT_BLOCK", 1000066009, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_10x8_SFLOAT_BLOCK", 1000066010, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_10x10_SFLOAT_BLOCK", 1000066011, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_12x10_SFLOAT_BLOCK", 1000066012, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"},
    {"ASTC_12x12_SFLOAT_BLOCK", 1000066013, 16, "0 32@0, 1 32@32, 2 32@64, 3 32@96"}};

std::string describe(const Record& record) {
  std::string text;
  for (const Component& c : record.used()) {
    if (!text.empty()) text += ", ";
    text += std::string(c.name()) + " " + std::to_string(c.bits) + "@" + std::to_string(c.offset);
  }
  return text;
}

TEST(Record, PresetsAreThoseOfTheTable) {
  ASSERT_EQ(formats().size(), std::size(kTable));
  for (std::size_t i = 0; i < std::size(kTable); ++i) {
    const auto& info = formats()[i];
    EXPECT_EQ(info.name, kTable[i].name);
    EXPECT_EQ(static_cast<std::uint32_t>(info.record.format), kTable[i].number) << info.name;
    EXPECT_EQ(info.record.bytes, kTable[i].bytes) << info.name;
    EXPECT_EQ(describe(info.record), kTable[i].components) << info.name;
    EXPECT_TRUE(is_valid(info.record)) << info.name;
    EXPECT_EQ(Record(info.record.format), info.record);
    EXPECT_EQ(find_format(info.record.format), &info);
    EXPECT_EQ(find_format(info.name), &info);
    EXPECT_EQ(find_format("VK_FORMAT_" + std::string(info.name)), &info);
  }
  for (const char* name : {"", "VK_FORMAT_", "R16G16", "r16g16_sfloat", "R16G16_SFLOAT "}) {
    EXPECT_EQ(find_format(name), nullptr) << name;
  }
  for (const std::uint32_t number : {0U, 1U, 86U, 124U, UINT32_MAX}) {
    EXPECT_EQ(find_format(static_cast<Format>(number)), nullptr);
    EXPECT_FALSE(is_valid(static_cast<Format>(number)));
  }
}

/// A preset is the record of its number, in its own words.
TEST(Record, PresetsOfTheSameBitsUnderOtherNumbersAreRefused) {
  for (const auto& info : formats()) {
    Record unnamed = info.record;
    unnamed.format = Format::UNDEFINED;
    EXPECT_TRUE(is_valid(unnamed)) << info.name;
    EXPECT_FALSE(unnamed == info.record);
    Record other = info.record;
    other.components[0] = {"X", other.components[0].offset, other.components[0].bits,
                           other.components[0].type};
    EXPECT_FALSE(is_valid(other)) << info.name;
    other = info.record;
    other.bytes = static_cast<std::uint8_t>(other.bytes + 1);
    EXPECT_FALSE(is_valid(other)) << info.name;
  }
  Record swapped = Format::R16_UNORM;
  swapped.format = Format::R16_SFLOAT;
  EXPECT_FALSE(is_valid(swapped));
}

Record record_of(std::uint8_t bytes, std::initializer_list<Component> components) {
  Record record;
  record.bytes = bytes;
  for (const Component& component : components) record.components[record.count++] = component;
  return record;
}
bool valid(std::uint8_t bytes, std::initializer_list<Component> components) {
  return is_valid(record_of(bytes, components));
}
constexpr auto kUint = ComponentType::uint;

TEST(Record, EveryBitBelongsToExactlyOneComponent) {
  EXPECT_TRUE(valid(1, {{"a", 0, 8, kUint}}));
  EXPECT_TRUE(valid(1, {{"a", 3, 5, kUint}, {"b", 0, 3, kUint}}));
  EXPECT_FALSE(valid(1, {{"a", 0, 7, kUint}}));                      // The last bit is missing,
  EXPECT_FALSE(valid(1, {{"a", 1, 7, kUint}}));                      // the first,
  EXPECT_FALSE(valid(1, {{"a", 0, 3, kUint}, {"b", 4, 4, kUint}}));  // one between.
  EXPECT_FALSE(valid(1, {{"a", 0, 5, kUint}, {"b", 4, 4, kUint}}));  // One is there twice,
  EXPECT_FALSE(valid(1, {{"a", 0, 5, kUint}, {"b", 4, 3, kUint}}));  // and another missing.
  EXPECT_FALSE(valid(1, {{"a", 0, 8, kUint}, {"b", 0, 8, kUint}}));
  EXPECT_FALSE(valid(1, {{"a", 0, 8, kUint}, {"b", 8, 8, kUint}}));  // Beyond the record,
  EXPECT_FALSE(valid(1, {{"a", 0, 9, kUint}}));
  EXPECT_FALSE(valid(1, {{"a", 65535, 8, kUint}}));
  EXPECT_FALSE(valid(64, {{"a", 512, 8, kUint}}));
  EXPECT_FALSE(valid(1, {{"a", 0, 8, kUint}, {"b", 8, 0, kUint}}));  // of no bits.
  EXPECT_FALSE(valid(1, {}));
}

TEST(Record, ComponentsHaveUpTo32BitsAndCrossNoWord) {
  EXPECT_TRUE(valid(5, {{"a", 0, 32, kUint}, {"b", 32, 8, kUint}}));
  EXPECT_TRUE(valid(8, {{"a", 32, 32, kUint}, {"b", 0, 32, kUint}}));
  EXPECT_FALSE(valid(5, {{"a", 0, 33, kUint}, {"b", 33, 7, kUint}}));
  EXPECT_FALSE(valid(5, {{"a", 0, 8, kUint}, {"b", 8, 32, kUint}}));
  EXPECT_FALSE(valid(8, {{"a", 0, 31, kUint}, {"b", 31, 2, kUint}, {"c", 33, 31, kUint}}));
  EXPECT_FALSE(valid(8, {{"a", 0, 255, kUint}}));
}

TEST(Record, SizesAndNumbersOfComponents) {
  EXPECT_FALSE(is_valid(Record()));
  EXPECT_FALSE(valid(0, {}));
  Record words = record_of(64, {});
  for (unsigned c = 0; c < 16; ++c) {
    EXPECT_FALSE(is_valid(words));
    words.components[words.count++] = {std::string("c").append(std::to_string(c)),
                                       static_cast<std::uint16_t>(32 * c), 32, kUint};
  }
  EXPECT_TRUE(is_valid(words));
  Record larger = words;
  larger.bytes = 65;
  EXPECT_FALSE(is_valid(larger));
  larger.bytes = 68;
  EXPECT_FALSE(is_valid(larger));
  Record many = words;
  many.count = 17;
  EXPECT_FALSE(is_valid(many));
  many.count = 255;
  EXPECT_FALSE(is_valid(many));
  Record fewer = words;
  fewer.bytes = 60;
  fewer.count = 15;
  EXPECT_FALSE(is_valid(fewer));  // What is left behind the last component.
  fewer.components[15] = {};
  EXPECT_TRUE(is_valid(fewer));
}

TEST(Record, NamesAreShortAndPlainAndOccurOnce) {
  const auto named = [](std::string_view name) { return valid(1, {{name, 0, 8, kUint}}); };
  for (const char* name : {"a", "Z", "0", "_", "irr_dir2", "ABCDEFGH"}) {
    EXPECT_TRUE(named(name)) << name;
  }
  for (const char* name : {"", " ", "a b", "a-b", "a.b", "\x1B[2J", "\xC3\xA4", "a\n"}) {
    EXPECT_FALSE(named(name)) << name;
  }
  EXPECT_FALSE(valid(2, {{"a", 0, 8, kUint}, {"a", 8, 8, kUint}}));
  EXPECT_TRUE(valid(2, {{"a", 0, 8, kUint}, {"A", 8, 8, kUint}}));
  // Characters behind the end.
  Record hidden = record_of(1, {{"ab", 0, 8, kUint}});
  hidden.components[0].characters[3] = 'x';
  EXPECT_FALSE(is_valid(hidden));
  EXPECT_EQ(Component("abcdefghij", 0, 8, kUint).name(), "abcdefgh");
}

TEST(Record, KindsHaveTheirWidths) {
  const auto of = [](ComponentType kind, std::uint8_t bits) {
    Record record = record_of(8, {{"a", 0, bits, kind}});
    if (bits < 32) {
      const auto rest = static_cast<std::uint8_t>(32 - bits);
      record.components[record.count++] = {"b", bits, rest, ComponentType::opaque};
    }
    record.components[record.count++] = {"c", 32, 32, kUint};
    return is_valid(record);
  };
  for (std::uint8_t bits = 1; bits <= 32; ++bits) {
    for (const auto kind : {ComponentType::unorm, ComponentType::snorm, ComponentType::uint,
                            ComponentType::exponent, ComponentType::opaque}) {
      EXPECT_TRUE(of(kind, bits)) << int{bits};
    }
    EXPECT_EQ(of(ComponentType::sfloat, bits), bits == 16 || bits == 32) << int{bits};
    EXPECT_EQ(of(ComponentType::ufloat, bits), bits <= 11) << int{bits};
    EXPECT_FALSE(of(static_cast<ComponentType>(kComponentTypes), bits));
    EXPECT_FALSE(of(static_cast<ComponentType>(255), bits));
  }
}

/// Any record as bytes and back.
RC_GTEST_PROP(Record, DescriptionsAreReadBack, (std::uint64_t seed)) {
  Random random(seed);
  const Record record = any_record(random);
  RC_ASSERT(is_valid(record));
  Bytes bytes;
  ByteWriter writer(bytes);
  write_record(record, writer);
  const Exact exact{std::span(bytes)};
  ByteReader reader(exact.span());
  const Record back = read_record(reader);
  RC_ASSERT(reader.ok() && reader.rest().empty());
  RC_ASSERT(back == record);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const Exact cut{std::span(bytes).first(size)};
    ByteReader short_reader(cut.span());
    (void)read_record(short_reader);
    RC_ASSERT(!short_reader.ok());
  }
  // Whatever damage leaves is a record or refused.
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    const Exact damaged{flip_bit(bytes, bit)};
    ByteReader other(damaged.span());
    const Record read = read_record(other);
    RC_ASSERT(!other.ok() || is_valid(read));
    RC_ASSERT(!other.ok() || !(read == record) || !other.rest().empty());
  }
}

TEST(Record, UnknownNumbersAreUnsupported) {
  for (const std::uint64_t number : {1U, 86U, 130U, 185U}) {
    Bytes bytes;
    ByteWriter(bytes).varint(number);
    ByteReader reader(bytes);
    (void)read_record(reader);
    EXPECT_EQ(reader.status(), Status::unsupported_format) << number;
  }
}

/// The whole description: what a keyframe is for.
TEST(Record, EveryFieldButTheLayoutChangesTheDescriptionHash) {
  const TextureDesc desc = bricks();
  const std::uint32_t hash = description_hash(desc);
  const auto changes = [&](auto change) {
    TextureDesc other = desc;
    change(other);
    EXPECT_EQ(validate(other), Status::ok);
    return description_hash(other) != hash;
  };
  EXPECT_TRUE(changes([](auto& d) { d.record = Format::R32_UINT; }));
  EXPECT_TRUE(changes([](auto& d) { d.record.format = Format::UNDEFINED; }));
  EXPECT_TRUE(changes([](auto& d) {
    d.record.format = Format::UNDEFINED;
    d.record.components[0].type = ComponentType::opaque;
  }));
  EXPECT_TRUE(changes([](auto& d) { d.grid = {2, 3, 5}; }));
  EXPECT_TRUE(changes([](auto& d) { d.block = {8, 2, 8}; }));
  EXPECT_TRUE(changes([](auto& d) { d.block.z = 1; }));
  EXPECT_TRUE(changes([](auto& d) { d.records = {24, 16, 10}; }));
  EXPECT_TRUE(changes([](auto& d) { d.presence = Presence::mask; }));
  EXPECT_TRUE(changes([](auto& d) { d.model = Model::continuous; }));
  EXPECT_TRUE(changes([](auto& d) { d.model = Model::none; }));
  EXPECT_FALSE(changes([](auto& d) { d.layout = Tiling::blocks; }));
  EXPECT_FALSE(changes([](auto& d) { d.layout.pad_after = 1; }));
}

}  // namespace
}  // namespace gicodec
