#include <gicodec/texture.h>

#include <gtest/gtest.h>

namespace gicodec {
namespace {

TEST(Format, NumbersAndNamesAreThoseOfVkFormat) {
  EXPECT_EQ(find_format("VK_FORMAT_R16G16_SFLOAT")->format, static_cast<Format>(83));
  EXPECT_EQ(find_format("A2B10G10R10_UNORM_PACK32")->format, static_cast<Format>(64));
  EXPECT_EQ(find_format("R16G16"), nullptr);
  EXPECT_EQ(find_format(static_cast<Format>(1)), nullptr);
}

}  // namespace
}  // namespace gicodec
