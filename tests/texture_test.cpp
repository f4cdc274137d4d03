// What descriptions may say.
#include "shapes.h"
#include "support.h"

#include "texture/view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

namespace gicodec {
namespace {

using namespace test;

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
  EXPECT_EQ(codes, 45);
  EXPECT_EQ(texts.size(), 45U);
}

/// What validate() says after a change.
template <typename Change>
Status with(TextureDesc desc, Change&& change) {
  change(desc);
  EXPECT_EQ(problem(desc).empty(), validate(desc) == Status::ok) << problem(desc);
  return validate(desc);
}
constexpr auto kBad = Status::invalid_description;

TEST(Desc, ValidateOfProbes) {
  const TextureDesc good = probe_texture(Format::R16G16_SFLOAT, {3, 2, 5}, 8);
  EXPECT_EQ(validate(good), Status::ok);
  EXPECT_EQ(with(good, [](auto& d) { d.record.format = static_cast<Format>(1); }),
            Status::unsupported_format);
  EXPECT_EQ(with(good, [](auto& d) { d.record = static_cast<Format>(1); }),
            Status::unsupported_format);
  EXPECT_EQ(validate(TextureDesc{}), Status::unsupported_format);
  EXPECT_EQ(with(good, [](auto& d) { d.grid.x = 0; }), kBad);
  EXPECT_EQ(with(good, [](auto& d) { d.grid.y = 0; }), kBad);
  EXPECT_EQ(with(good, [](auto& d) { d.grid.z = 0; }), kBad);
  EXPECT_EQ(with(good, [](auto& d) { d.grid = {kMaxGridSide + 1, 1, 1}; }), kBad);
  EXPECT_EQ(with(good, [](auto& d) { d.grid = {kMaxGridSide, kMaxGridSide, 1}; }), kBad);
  EXPECT_EQ(with(good, [](auto& d) { d.grid = {UINT32_MAX, UINT32_MAX, UINT32_MAX}; }), kBad);
  EXPECT_EQ(with(good, [](auto& d) { d.grid = {4096, 4096, 2}; }), kBad);
  EXPECT_EQ(with(good, [](auto& d) { d.block.x = 0; }), kBad);
  EXPECT_EQ(with(good, [](auto& d) { d.block = {kMaxBlockSide + 1, kMaxBlockSide + 1, 1}; }), kBad);
  EXPECT_EQ(with(good, [](auto& d) { d.guard_band = 2; }), kBad);
  EXPECT_EQ(with(good, [](auto& d) { d.layout = static_cast<Tiling>(kTilingCount); }), kBad);
  EXPECT_EQ(with(good,
                 [](auto& d) {
                   d.grid = {4096, 4096, 1};
                 }),
            kHoldsTheLargest ? Status::ok : Status::limit_exceeded);
  EXPECT_EQ(with(good, [](auto& d) { d.grid = {kMaxGridSide, 1, 1}; }), Status::ok);
  EXPECT_EQ(validate(probe_texture(Format::R16G16_SFLOAT, {3, 2, 5}, 1, 0)), Status::ok);
  EXPECT_EQ(validate(probe_texture(Format::R16G16_SFLOAT, {3, 2, 5}, kMaxBlockSide)), Status::ok);
}

TEST(Desc, ValidateOfBlockShapes) {
  EXPECT_EQ(validate(bricks()), Status::ok);
  const auto shaped = [](BlockShape shape, std::uint8_t guard_band = 0) {
    return with(bricks(), [&](auto& d) {
      d.block = shape;
      d.guard_band = guard_band;
    });
  };
  EXPECT_EQ(shaped({1, 1, 1}), Status::ok);
  EXPECT_EQ(shaped({64, 1, 3}), Status::ok);
  EXPECT_EQ(shaped({32, 32, 32}), Status::ok);  // As many records as a block may have.
  EXPECT_EQ(shaped({64, 64, 8}), Status::ok);
  EXPECT_EQ(shaped({64, 64, 9}), kBad);
  EXPECT_EQ(shaped({33, 32, 32}), kBad);
  EXPECT_EQ(shaped({65, 1, 1}), kBad);
  EXPECT_EQ(shaped({1, 65, 1}), kBad);
  EXPECT_EQ(shaped({1, 1, 65}), kBad);
  EXPECT_EQ(shaped({4, 0, 4}), kBad);
  EXPECT_EQ(shaped({4, 4, 0}), kBad);
  // Guard bands stand around squares.
  EXPECT_EQ(shaped({4, 4, 1}, 1), Status::ok);
  EXPECT_EQ(shaped({4, 5, 1}, 1), kBad);
  EXPECT_EQ(shaped({4, 4, 2}, 1), kBad);
}

TEST(Desc, ValidateOfPools) {
  const auto pool = [](Grid grid, Grid slots = {}) {
    return with(bricks(), [&](auto& d) {
      d.space = Space::pool;
      d.model = Model::none;
      d.grid = grid;
      d.layout.slots = slots;
    });
  };
  EXPECT_EQ(pool({1, 1, 1}), Status::ok);
  EXPECT_EQ(pool({kMaxBlocks, 1, 1}), kHoldsTheLargest ? Status::ok : Status::limit_exceeded);
  EXPECT_EQ(pool({kMaxBlocks + 1, 1, 1}), kBad);
  EXPECT_EQ(pool({0, 1, 1}), kBad);
  EXPECT_EQ(pool({4, 2, 1}), kBad);
  EXPECT_EQ(pool({4, 1, 2}), kBad);
  EXPECT_EQ(pool({10, 1, 1}, {4, 3, 1}), Status::ok);
  EXPECT_EQ(pool({12, 1, 1}, {2, 3, 2}), Status::ok);
  EXPECT_EQ(pool({13, 1, 1}, {2, 3, 2}), kBad);  // Slots that stand nowhere.
  EXPECT_EQ(pool({10, 1, 1}, {4, 3, 0}), kBad);
  EXPECT_EQ(pool({10, 1, 1}, {0, 3, 4}), kBad);
  EXPECT_EQ(pool({10, 1, 1}, {UINT32_MAX, UINT32_MAX, UINT32_MAX}), kBad);
  EXPECT_EQ(pool({10, 1, 1}, {1U << 16, 1U << 16, 1}), kBad);
  // Blocks of a grid stand where its tiling says.
  EXPECT_EQ(with(bricks(), [](auto& d) { d.layout.slots = {30, 1, 1}; }), kBad);
  EXPECT_EQ(with(bricks(), [](auto& d) { d.space = static_cast<Space>(2); }), kBad);
}

TEST(Desc, ValidateOfRecordsWithinTheLastBlocks) {
  const auto ending = [](Grid records, auto&&... change) {
    return with(bricks(), [&](auto& d) {
      d.records = records;
      (change(d), ...);
    });
  };
  EXPECT_EQ(ending({24, 16, 10}), Status::ok);
  EXPECT_EQ(ending({17, 9, 9}), Status::ok);
  EXPECT_EQ(ending({16, 16, 10}), kBad);  // A column of blocks that holds nothing.
  EXPECT_EQ(ending({25, 16, 10}), kBad);
  EXPECT_EQ(ending({24, 8, 10}), kBad);
  EXPECT_EQ(ending({24, 17, 10}), kBad);
  EXPECT_EQ(ending({24, 16, 8}), kBad);
  EXPECT_EQ(ending({24, 16, 11}), kBad);
  EXPECT_EQ(ending({24, 16, 0}), kBad);
  EXPECT_EQ(ending({0, 16, 10}), kBad);
  EXPECT_EQ(ending({UINT32_MAX, 16, 10}), kBad);
  const auto pad_before = [](auto& d) { d.layout.pad_before = 1; };
  const auto pad_after = [](auto& d) { d.layout.pad_after = 1; };
  EXPECT_EQ(ending({20, 16, 10}, pad_before), kBad);
  EXPECT_EQ(ending({20, 16, 10}, pad_after), kBad);
  const auto banded = [](auto& d) {
    d.block.z = 1;
    d.guard_band = 1;
  };
  EXPECT_EQ(ending({20, 16, 5}, banded), kBad);
  const auto pool = [](auto& d) {
    d.space = Space::pool;
    d.model = Model::none;
    d.grid = {3, 1, 1};
  };
  EXPECT_EQ(ending({20, 8, 2}, pool), kBad);
  EXPECT_EQ(ending({}, pool), Status::ok);
}

TEST(Desc, ValidateOfPaddingAndPresence) {
  EXPECT_EQ(with(bricks(), [](auto& d) { d.layout.pad_before = kMaxPadding; }), Status::ok);
  EXPECT_EQ(with(bricks(), [](auto& d) { d.layout.pad_after = kMaxPadding; }), Status::ok);
  EXPECT_EQ(with(bricks(), [](auto& d) { d.layout.pad_before = kMaxPadding + 1; }), kBad);
  EXPECT_EQ(with(bricks(), [](auto& d) { d.layout.pad_after = kMaxPadding + 1; }), kBad);
  EXPECT_EQ(with(bricks(), [](auto& d) { d.presence = Presence::count; }), Status::ok);
  EXPECT_EQ(with(bricks(), [](auto& d) { d.presence = Presence::mask; }), Status::ok);
  EXPECT_EQ(with(bricks(), [](auto& d) { d.presence = static_cast<Presence>(3); }), kBad);
}

TEST(Desc, ValidateOfModels) {
  const auto modelled = [](Model model, auto&&... change) {
    return with(bricks(), [&](auto& d) {
      d.model = model;
      (change(d), ...);
    });
  };
  const auto pool = [](auto& d) {
    d.space = Space::pool;
    d.grid = {4, 1, 1};
  };
  EXPECT_EQ(modelled(Model::none), Status::ok);
  EXPECT_EQ(modelled(Model::none, pool), Status::ok);
  for (const auto model : {Model::stacked, Model::continuous}) {
    EXPECT_EQ(modelled(model), Status::ok);
    EXPECT_EQ(modelled(model, pool), kBad);
  }
  // Sets: nothing says which record is which.
  EXPECT_EQ(modelled(Model::unordered), Status::ok);
  EXPECT_EQ(modelled(Model::unordered, pool), Status::ok);
  EXPECT_EQ(modelled(Model::unordered, [](auto& d) { d.presence = Presence::count; }), Status::ok);
  EXPECT_EQ(modelled(Model::unordered, [](auto& d) { d.presence = Presence::mask; }), kBad);
  EXPECT_EQ(modelled(Model::unordered, [](auto& d) { d.records = {23, 16, 10}; }), kBad);
  const auto banded = [](auto& d) {
    d.block.z = 1;
    d.guard_band = 1;
  };
  EXPECT_EQ(modelled(Model::none, banded), Status::ok);
  EXPECT_EQ(modelled(Model::unordered, banded), kBad);
  // Bricks: their places are in what says which voxels exist.
  const auto bricked = [](auto& d) {
    d.block = {2 * kVoxelDirections, 2, 2};
    d.presence = Presence::brick;
  };
  EXPECT_EQ(modelled(Model::octree, pool, bricked), Status::ok);
  EXPECT_EQ(modelled(Model::octree, bricked), kBad);
  EXPECT_EQ(modelled(Model::octree, pool), kBad);
  EXPECT_EQ(modelled(Model::none, pool, bricked), kBad);
  EXPECT_EQ(modelled(static_cast<Model>(6)), kBad);
}

TEST(Desc, ValidateOfHemispheres) {
  const auto vertices = [](auto&&... change) {
    return with(bricks(), [&](auto& d) {
      d.record = colored_direction(false);
      d.block = {6, 1, 1};
      d.model = Model::hemispheres;
      (change(d), ...);
    });
  };
  EXPECT_EQ(vertices(), Status::ok);
  EXPECT_EQ(vertices([](auto& d) { d.record = colored_direction(true); }), Status::ok);
  EXPECT_EQ(vertices([](auto& d) { d.record = Format::R32_SFLOAT; }), kBad);
  EXPECT_EQ(vertices([](auto& d) { d.block = {3, 2, 1}; }), kBad);
  EXPECT_EQ(vertices([](auto& d) { d.presence = Presence::count; }), kBad);
  EXPECT_EQ(vertices([](auto& d) { d.records = {17, 2, 5}; }), kBad);
  EXPECT_EQ(vertices([](auto& d) {
              d.space = Space::pool;
              d.grid = {4, 1, 1};
            }),
            kBad);
}

TEST(Desc, ProblemsNameTheField) {
  const auto field = [](const TextureDesc& good, auto&& change) {
    TextureDesc desc = good;
    change(desc);
    const std::string_view found = problem(desc);
    return std::string(found.substr(0, found.find(':')));
  };
  const TextureDesc probes = probe_texture(Format::R16G16_SFLOAT, {3, 2, 5}, 8);
  const TextureDesc pool = pool_texture(Format::R16G16_SFLOAT, 9, {2, 2, 2});
  EXPECT_EQ(problem(probes), "");
  EXPECT_EQ(problem(TextureDesc{}).substr(0, 7), "format:");
  EXPECT_EQ(field(probes, [](auto& d) { d.block.x = 65; }), "block");
  EXPECT_EQ(field(probes, [](auto& d) { d.guard_band = 2; }), "guard_band");
  EXPECT_EQ(field(probes, [](auto& d) { d.block.y = 7; }), "guard_band");
  EXPECT_EQ(field(probes, [](auto& d) { d.layout.tiling = static_cast<Tiling>(8); }), "tiling");
  EXPECT_EQ(field(probes, [](auto& d) { d.layout.pad_before = 9; }), "pad_before");
  EXPECT_EQ(field(probes, [](auto& d) { d.layout.pad_after = 9; }), "pad_after");
  EXPECT_EQ(field(probes, [](auto& d) { d.layout.slots = {1, 1, 1}; }), "slots");
  EXPECT_EQ(field(probes, [](auto& d) { d.grid.z = 0; }), "grid");
  EXPECT_EQ(field(probes, [](auto& d) { d.records = {24, 16, 5}; }), "records");
  EXPECT_EQ(field(bricks(), [](auto& d) { d.records = {1, 1, 1}; }), "records");
  EXPECT_EQ(field(probes, [](auto& d) { d.space = static_cast<Space>(2); }), "space");
  EXPECT_EQ(field(probes, [](auto& d) { d.presence = static_cast<Presence>(4); }), "presence");
  EXPECT_EQ(field(probes, [](auto& d) { d.presence = Presence::brick; }), "presence");
  EXPECT_EQ(field(probes, [](auto& d) { d.model = static_cast<Model>(6); }), "model");
  EXPECT_EQ(field(probes, [](auto& d) { d.model = Model::unordered; }), "model");
  EXPECT_EQ(field(pool, [](auto& d) { d.model = Model::stacked; }), "model");
  EXPECT_EQ(field(pool, [](auto& d) { d.grid.y = 2; }), "grid");
  EXPECT_EQ(field(pool, [](auto& d) { d.layout.slots = {2, 2, 2}; }), "slots");
  EXPECT_EQ(field(pool, [](auto& d) { d.layout.slots = {9, 1, 0}; }), "slots");
}

Record custom_64_bytes() {
  Record record;
  record.bytes = 64;
  for (; record.count < 16; ++record.count) {
    record.components[record.count] = {"c" + std::to_string(record.count),
                                       static_cast<std::uint16_t>(32 * record.count), 32,
                                       ComponentType::uint};
  }
  return record;
}

TEST(Desc, TheLargestTextureDoesNotOverflow) {
  const TextureDesc desc =
      probe_texture(Format::R32G32B32A32_SFLOAT, {4096, 4096, 1}, 64, 1, Tiling::atlas_xy_z);
  const auto verdict = kHoldsTheLargest ? Status::ok : Status::limit_exceeded;
  ASSERT_EQ(validate(desc), verdict);
  EXPECT_EQ(extent(desc), (Extent{4096U * 4096U * 66U, 66, 1}));
  EXPECT_EQ(texture_bytes(desc), std::uint64_t{4096} * 4096 * 66 * 66 * 16);
  // The largest of all, in every tiling and with all padding there may be.
  TextureDesc largest = bricks();
  largest.record = custom_64_bytes();
  largest.block = {64, 64, 8};
  largest.grid = {4096, 4096, 1};
  largest.layout.pad_before = largest.layout.pad_after = kMaxPadding;
  for (std::uint8_t tiling = 0; tiling < kTilingCount; ++tiling) {
    largest.layout.tiling = static_cast<Tiling>(tiling);
    ASSERT_EQ(validate(largest), verdict);
    EXPECT_EQ(texture_bytes(largest), (std::uint64_t{1} << 24) * 80 * 80 * 24 * 64);
    EXPECT_EQ(check_view(largest, ConstTextureView({}, 0, 0, 0)).status(), Status::view_too_small);
  }
}

TEST(Desc, PaperTextures) {
  const auto color = ddgi_irradiance({16, 8, 16});
  EXPECT_EQ(extent(color), (Extent{1280, 160, 1}));
  EXPECT_EQ(block_bytes(color), 256U);
  const auto visibility = ddgi_visibility({16, 8, 16});
  EXPECT_EQ(extent(visibility), (Extent{2304, 288, 1}));
  EXPECT_EQ(block_count(visibility), 2048U);
}

}  // namespace
}  // namespace gicodec
