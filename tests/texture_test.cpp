// Formats, volume geometry and the checks of views.
#include "support.h"

#include "texture/view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

namespace gicodec {
namespace {

using namespace test;

TEST(Format, NumbersAndNamesAreThoseOfVkFormat) {
  const std::pair<std::string_view, std::uint32_t> expected[] = {{"R8G8B8A8_UNORM", 37},
                                                                 {"A2R10G10B10_UNORM_PACK32", 58},
                                                                 {"A2B10G10R10_UNORM_PACK32", 64},
                                                                 {"R16_SFLOAT", 76},
                                                                 {"R16G16_SFLOAT", 83},
                                                                 {"R16G16B16A16_SFLOAT", 97},
                                                                 {"R32_SFLOAT", 100},
                                                                 {"R32G32_SFLOAT", 103},
                                                                 {"R32G32B32A32_SFLOAT", 109},
                                                                 {"B10G11R11_UFLOAT_PACK32", 122},
                                                                 {"E5B9G9R9_UFLOAT_PACK32", 123}};
  ASSERT_EQ(formats().size(), std::size(expected));
  for (std::size_t i = 0; i < std::size(expected); ++i) {
    const auto& info = formats()[i];
    EXPECT_EQ(info.name, expected[i].first);
    EXPECT_EQ(static_cast<std::uint32_t>(info.format), expected[i].second);
    EXPECT_EQ(find_format(info.format), &info);
    EXPECT_EQ(find_format(info.name), &info);
    EXPECT_EQ(find_format("VK_FORMAT_" + std::string(info.name)), &info);
  }
  for (const char* name : {"", "VK_FORMAT_", "R16G16", "r16g16_sfloat", "R16G16_SFLOAT "}) {
    EXPECT_EQ(find_format(name), nullptr) << name;
  }
  for (const std::uint32_t number : {0U, 1U, 84U, 124U, UINT32_MAX}) {
    EXPECT_EQ(find_format(static_cast<Format>(number)), nullptr);
  }
}

TEST(Format, ComponentsCoverTheTexelWithoutOverlap) {
  for (const auto& info : formats()) {
    std::vector<int> uses(info.texel_bytes * 8U, 0);
    for (const auto& component : info.used()) {
      EXPECT_EQ(component.offset / 32, (component.offset + component.bits - 1) / 32) << info.name;
      for (unsigned bit = 0; bit < component.bits; ++bit) ++uses.at(component.offset + bit);
    }
    EXPECT_TRUE(std::ranges::all_of(uses, [](int n) { return n == 1; })) << info.name;
  }
}

TEST(Format, TheTwoPackingsOfTenBitsSwapRedAndBlue) {
  const auto* argb = find_format(Format::A2R10G10B10_UNORM_PACK32);
  const auto* abgr = find_format(Format::A2B10G10R10_UNORM_PACK32);
  EXPECT_EQ(argb->components[0].offset, 20);
  EXPECT_EQ(argb->components[2].offset, 0);
  EXPECT_EQ(abgr->components[0].offset, 0);
  EXPECT_EQ(abgr->components[2].offset, 20);
}

TEST(Status, EveryCodeHasItsOwnText) {
  std::set<std::string_view> texts;
  int codes = 0;
  for (int code = 0; code < 600; ++code) {
    const auto text = to_string(static_cast<Status>(code));
    EXPECT_FALSE(text.empty());
    if (text == "unknown status") continue;
    ++codes;
    texts.insert(text);
  }
  EXPECT_EQ(codes, 26);
  EXPECT_EQ(texts.size(), 26U);
}

TEST(Desc, Validate) {
  const TextureDesc good{Format::R16G16_SFLOAT, {3, 2, 5}, 8, 1, Tiling::atlas_xy_z};
  EXPECT_EQ(validate(good), Status::ok);
  const auto with = [&](auto change) {
    TextureDesc desc = good;
    change(desc);
    return validate(desc);
  };
  const auto bad = Status::invalid_description;
  EXPECT_EQ(with([](auto& d) { d.format = static_cast<Format>(1); }), Status::unsupported_format);
  EXPECT_EQ(with([](auto& d) { d.grid.x = 0; }), bad);
  EXPECT_EQ(with([](auto& d) { d.grid.y = 0; }), bad);
  EXPECT_EQ(with([](auto& d) { d.grid.z = 0; }), bad);
  EXPECT_EQ(with([](auto& d) { d.grid = {kMaxGridSide + 1, 1, 1}; }), bad);
  EXPECT_EQ(with([](auto& d) { d.grid = {kMaxGridSide, kMaxGridSide, 1}; }), bad);
  EXPECT_EQ(with([](auto& d) { d.grid = {UINT32_MAX, UINT32_MAX, UINT32_MAX}; }), bad);
  EXPECT_EQ(with([](auto& d) { d.grid = {4096, 4096, 2}; }), bad);
  EXPECT_EQ(with([](auto& d) { d.core = 0; }), bad);
  EXPECT_EQ(with([](auto& d) { d.core = kMaxCore + 1; }), bad);
  EXPECT_EQ(with([](auto& d) { d.border = 2; }), bad);
  EXPECT_EQ(with([](auto& d) { d.tiling = static_cast<Tiling>(kTilingCount); }), bad);
  EXPECT_EQ(with([](auto& d) { d.grid = {4096, 4096, 1}; }), Status::ok);
  EXPECT_EQ(with([](auto& d) { d.grid = {kMaxGridSide, 1, 1}; }), Status::ok);
  EXPECT_EQ(with([](auto& d) {
              d.core = 1;
              d.border = 0;
            }),
            Status::ok);
  EXPECT_EQ(with([](auto& d) { d.core = kMaxCore; }), Status::ok);
}

TEST(Desc, TheLargestTextureDoesNotOverflow) {
  const TextureDesc desc{Format::R32G32B32A32_SFLOAT, {4096, 4096, 1}, 64, 1, Tiling::atlas_xy_z};
  ASSERT_EQ(validate(desc), Status::ok);
  EXPECT_EQ(extent(desc), (Extent{4096U * 4096U * 66U, 66, 1}));
  EXPECT_EQ(texture_bytes(desc), std::uint64_t{4096} * 4096 * 66 * 66 * 16);
}

TEST(Desc, PaperTextures) {
  const auto color = ddgi_irradiance({16, 8, 16});
  EXPECT_EQ(extent(color), (Extent{1280, 160, 1}));
  EXPECT_EQ(core_bytes(color), 256U);
  const auto visibility = ddgi_visibility({16, 8, 16});
  EXPECT_EQ(extent(visibility), (Extent{2304, 288, 1}));
  EXPECT_EQ(probe_count(visibility), 2048U);
}

TEST(Tiling, Names) {
  for (std::uint8_t i = 0; i < kTilingCount; ++i) {
    const auto tiling = static_cast<Tiling>(i);
    ASSERT_FALSE(to_string(tiling).empty());
    const auto back = tiling_from_string(to_string(tiling));
    ASSERT_TRUE(back.ok());
    EXPECT_EQ(*back, tiling);
  }
  EXPECT_EQ(to_string(Tiling::atlas_xy_z), "atlas_xy_z");
  EXPECT_TRUE(to_string(static_cast<Tiling>(kTilingCount)).empty());
  EXPECT_EQ(tiling_from_string("atlas").status(), Status::invalid_argument);
  EXPECT_EQ(tiling_from_string("").status(), Status::invalid_argument);
}

TEST(Tiling, DocumentedPlaceOfAProbe) {
  const Grid grid{3, 4, 5};
  const std::uint32_t x = 2, y = 1, z = 3, probe = x + 3 * (y + 4 * z);
  const auto at = [&](Tiling tiling) {
    const auto o = block_origin({Format::R16_SFLOAT, grid, 6, 1, tiling}, probe);
    return std::array{o.x / 8, o.y / 8, o.slice};
  };
  EXPECT_EQ(at(Tiling::atlas_xy_z), (std::array{x + 3 * y, z, 0U}));
  EXPECT_EQ(at(Tiling::atlas_xz_y), (std::array{x + 3 * z, y, 0U}));
  EXPECT_EQ(at(Tiling::atlas_x_yz), (std::array{x, y + 4 * z, 0U}));
  EXPECT_EQ(at(Tiling::slices_xz_y), (std::array{x, z, y}));
  EXPECT_EQ(at(Tiling::slices_xy_z), (std::array{x, y, z}));
}

TEST(Tiling, BlocksFillTheTextureExactly) {
  Random random(1);
  for (int round = 0; round < 300; ++round) {
    const auto desc = random_desc(random);
    const auto size = extent(desc);
    const auto side = block_side(desc);
    std::set<std::array<std::uint32_t, 3>> places;
    for (std::uint32_t probe = 0; probe < probe_count(desc); ++probe) {
      const auto origin = block_origin(desc, probe);
      ASSERT_TRUE(origin.x % side == 0 && origin.y % side == 0) << desc;
      ASSERT_TRUE(origin.x + side <= size.width && origin.y + side <= size.height &&
                  origin.slice < size.slices)
          << desc;
      places.insert({origin.x, origin.y, origin.slice});
    }
    ASSERT_EQ(places.size(), probe_count(desc)) << desc;
    ASSERT_EQ(texture_bytes(desc),
              std::uint64_t{probe_count(desc)} * side * side * texel_bytes(desc))
        << desc;
  }
}

TEST(View, ExactSizesFitAndOneByteLessDoesNot) {
  Random random(2);
  for (int round = 0; round < 300; ++round) {
    const auto desc = random_desc(random);
    const Texture texture(desc, random() % 40, random() % 300);
    auto view = texture.view();
    ASSERT_TRUE(check_view(desc, view).ok()) << desc;
    view.bytes = view.bytes.first(view.bytes.size() - 1);
    ASSERT_EQ(check_view(desc, view).status(), Status::view_too_small) << desc;
    view.bytes = {};
    ASSERT_EQ(check_view(desc, view).status(), Status::view_too_small) << desc;
  }
}

TEST(View, PitchZeroIsTightAndSmallerPitchesAreRefused) {
  Random random(3);
  for (int round = 0; round < 300; ++round) {
    const auto desc = random_desc(random);
    const auto size = extent(desc);
    const std::size_t row = std::size_t{size.width} * texel_bytes(desc);
    const Exact buffer(texture_bytes(desc));
    ASSERT_TRUE(check_view(desc, ConstTextureView(buffer.span())).ok()) << desc;
    ASSERT_EQ(check_view(desc, ConstTextureView(buffer.span(), row - 1)).status(),
              row == 1 ? Status::ok : Status::view_too_small)
        << desc;
    if (size.slices > 1) {
      ASSERT_EQ(
          check_view(desc, ConstTextureView(buffer.span(), row, row * size.height - 1)).status(),
          Status::view_too_small)
          << desc;
    }
  }
}

TEST(View, HugePitchesDoNotWrapAround) {
  const std::size_t huge[] = {
      SIZE_MAX,         SIZE_MAX - 1, SIZE_MAX / 2,         SIZE_MAX / 2 + 1,
      SIZE_MAX / 3 + 1, SIZE_MAX / 7, std::size_t{1} << 32, std::size_t{1} << 63};
  const Exact buffer(4096);
  for (const auto pitch : huge) {
    for (const auto tiling : {Tiling::atlas_xy_z, Tiling::slices_xy_z}) {
      const TextureDesc desc{Format::R16_SFLOAT, {2, 2, 3}, 2, 1, tiling};
      EXPECT_EQ(check_view(desc, ConstTextureView(buffer.span(), pitch)).status(),
                Status::view_too_small);
      EXPECT_EQ(check_view(desc, ConstTextureView(buffer.span(), pitch, pitch)).status(),
                Status::view_too_small);
      EXPECT_EQ(check_view(desc, ConstTextureView(buffer.span(), 0, pitch)).ok(),
                extent(desc).slices == 1);
    }
  }
}

// With one row or one slice its pitch is never added, however large.
TEST(View, UnusedPitchesMayBeAnything) {
  const TextureDesc desc{Format::R32_SFLOAT, {4, 1, 1}, 1, 0, Tiling::slices_xy_z};
  Exact buffer(16);
  Random random(4);
  std::ranges::copy(noise(random, 16), buffer.span().begin());
  auto encoder = Encoder::create(desc);
  auto decoder = Decoder::create(desc);
  ASSERT_TRUE(encoder.ok() && decoder.ok());
  for (const std::size_t pitch : {SIZE_MAX, SIZE_MAX / 2 + 3}) {
    const auto packet = encoder->encode({buffer.span(), pitch, pitch}, Selection::all());
    ASSERT_TRUE(packet.ok()) << packet.status();
    ASSERT_TRUE(encoder->encode({buffer.span(), pitch, pitch}).ok());
    encoder->request_keyframe();
    Exact out(16);
    ASSERT_EQ(decoder->decode(*packet, TextureView{out.span(), pitch, pitch}), Status::ok);
    EXPECT_TRUE(std::ranges::equal(out.span(), buffer.span()));
  }
}

}  // namespace
}  // namespace gicodec
