// The reader of HEVC syntax and the checks in front of the third-party decoders.
#include "backend/hevc/access_unit.h"
#include "backend/hevc/codec.h"
#include "backend/hevc/syntax_reader.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace gicodec::hevc {
namespace {

std::vector<std::byte> bytes_of(std::initializer_list<int> values) {
  std::vector<std::byte> bytes;
  for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

TEST(HevcSyntax, ExpGolomb) {
  // 1 010 011 00100 00101 | 1: the codes of 0 1 2 3 4, then a stop bit.
  const auto bytes = bytes_of({0b10100110, 0b01000010, 0b11000000});
  SyntaxReader in(bytes);
  for (std::uint32_t value = 0; value < 5; ++value) EXPECT_EQ(in.ue(), value);
  in.trailing_bits();
  EXPECT_TRUE(in.ok());
  SyntaxReader with_signs(bytes);
  for (const int value : {0, 1, -1, 2, -2}) EXPECT_EQ(with_signs.se(2), value);
  EXPECT_TRUE(with_signs.ok());
}

TEST(HevcSyntax, LimitsAndEnds) {
  const auto bytes = bytes_of({0b00101000});
  SyntaxReader limited(bytes);
  EXPECT_EQ(limited.ue(3), 0U);  // the code is that of 4
  EXPECT_FALSE(limited.ok());
  const auto zeros = bytes_of({0, 0, 0, 0, 0, 0, 0});
  SyntaxReader endless(zeros);
  endless.ue();
  EXPECT_FALSE(endless.ok());
  SyntaxReader past(bytes);
  EXPECT_EQ(past.bits(8), 0b00101000U);
  EXPECT_FALSE(past.flag());
  EXPECT_FALSE(past.ok());
}

TEST(HevcSyntax, EmulationPrevention) {
  const auto bytes = bytes_of({0, 0, 3, 1, 0, 0, 3, 0, 0, 3, 2});
  SyntaxReader in(bytes);
  EXPECT_EQ(in.bits(24), 1U);
  EXPECT_EQ(in.bits(32), 0U);
  EXPECT_EQ(in.bits(8), 2U);
  EXPECT_TRUE(in.ok());
}

RC_GTEST_PROP(HevcSyntax, AnyBytesAreRead, (const std::vector<std::uint8_t>& data)) {
  SyntaxReader in(std::as_bytes(std::span(data)));
  for (int i = 0; i < 100; ++i) {
    in.ue();
    in.se(7);
    in.bits(5);
  }
  RC_ASSERT(!in.ok() || data.size() > 10);
}

struct Encoded {
  PictureFormat format;
  std::vector<std::byte> idr, next;
};

Encoded encode(const PictureFormat& format) {
  Encoded encoded{.format = format, .idr = {}, .next = {}};
  auto encoder = open_x265(format, {.preset = "ultrafast"});
  EXPECT_TRUE(encoder.ok());
  Picture picture;
  picture.reset(format);
  std::vector<std::byte> raw;
  EXPECT_EQ((*encoder)->encode(picture, true, raw), Status::ok);
  append_access_unit(raw, encoded.idr);
  EXPECT_EQ((*encoder)->encode(picture, false, raw), Status::ok);
  append_access_unit(raw, encoded.next);
  return encoded;
}

TEST(HevcChecks, AcceptWhatX265Writes) {
  for (const PictureFormat format :
       {PictureFormat{16, 16, 8, true}, PictureFormat{40, 24, 8, false},
        PictureFormat{64, 32, 10, false}, PictureFormat{88, 16, 12, false}}) {
    const Encoded encoded = encode(format);
    ParameterSets sets;
    const auto idr = parse_access_unit(encoded.idr, format, sets);
    ASSERT_TRUE(idr.ok());
    EXPECT_TRUE(idr->idr);
    EXPECT_EQ(idr->units.size(), 4U);
    const auto next = parse_access_unit(encoded.next, format, sets);
    ASSERT_TRUE(next.ok());
    EXPECT_FALSE(next->idr);
  }
}

TEST(HevcChecks, RefuseOtherPictures) {
  const PictureFormat format{64, 32, 10, false};
  const Encoded encoded = encode(format);
  ParameterSets sets;
  for (const PictureFormat other :
       {PictureFormat{72, 32, 10, false}, PictureFormat{64, 24, 10, false},
        PictureFormat{64, 32, 8, false}, PictureFormat{64, 32, 12, false},
        PictureFormat{64, 32, 10, true}}) {
    EXPECT_EQ(parse_access_unit(encoded.idr, other, sets).status(), Status::corrupt);
  }
}

TEST(HevcChecks, RefuseOtherNalUnits) {
  const PictureFormat format{32, 32, 8, false};
  const Encoded encoded = encode(format);
  ParameterSets sets;
  for (unsigned type = 0; type < 64; ++type) {
    auto changed = encoded.idr;
    changed[4] = static_cast<std::byte>(type << 1);  // header of the first NAL unit
    EXPECT_EQ(parse_access_unit(changed, format, sets).ok(), type == 32) << type;
  }
  auto layered = encoded.idr;
  layered[5] = std::byte{9};
  EXPECT_EQ(parse_access_unit(layered, format, sets).status(), Status::corrupt);
  EXPECT_FALSE(parse_access_unit({}, format, sets).ok());
  EXPECT_FALSE(parse_access_unit(bytes_of({0, 0, 0, 1}), format, sets).ok());
  EXPECT_FALSE(parse_access_unit(bytes_of({0, 0, 0, 1, 0, 0, 0, 1}), format, sets).ok());
}

TEST(HevcChecks, RefuseTwoPicturesInOne) {
  const PictureFormat format{32, 32, 8, false};
  const Encoded encoded = encode(format);
  ParameterSets sets;
  auto twice = encoded.idr;
  twice.insert(twice.end(), encoded.next.begin(), encoded.next.end());
  EXPECT_EQ(parse_access_unit(twice, format, sets).status(), Status::corrupt);
  auto again = encoded.next;
  again.insert(again.end(), encoded.next.begin(), encoded.next.end());
  EXPECT_EQ(parse_access_unit(again, format, sets).status(), Status::corrupt);
}

}  // namespace
}  // namespace gicodec::hevc
