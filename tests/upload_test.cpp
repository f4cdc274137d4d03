// What is to be uploaded: copying these boxes, and nothing else, brings a texture up to date.
#include "shapes.h"
#include "support.h"

#include <gicodec/client.h>
#include <gicodec/upload.h>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cstring>
#include <numeric>

namespace gicodec {
namespace {

using namespace test;

/// As a graphics API does it: a row of a box at a time, into the view of another texture.
void copy_box(const UploadBox& box, const ConstTextureView& from, const TextureDesc& desc,
              Texture& to) {
  const auto target = to.view();
  const std::size_t row = box.width * desc.record.bytes;
  for (std::uint64_t z = 0; z < box.slices; ++z) {
    for (std::uint64_t y = 0; y < box.height; ++y) {
      const std::byte* const source =
          from.bytes.data() + box.offset + z * box.slice_pitch + y * box.row_pitch;
      const std::uint64_t slice = box.slice + z;
      const bool array = desc.layout.tiling == Tiling::blocks;
      const std::uint64_t of_block = extent(desc).slices / block_count(desc);
      const std::uint64_t block = array ? slice / of_block : 0;
      std::byte* const place = target.bytes.data() + block * target.block_pitch +
                               (array ? slice % of_block : slice) * target.slice_pitch +
                               (box.y + y) * target.row_pitch + box.x * desc.record.bytes;
      std::memcpy(place, source, row);
    }
  }
}

RC_GTEST_PROP(Upload, BoxesAreWhatChanged, (std::uint64_t seed)) {
  Random random(seed);
  const TextureDesc desc = any_desc(random);
  Texture from(desc, pick(random, 0, 9), pick(random, 0, 9), pick(random, 0, 9));
  Texture to(desc, pick(random, 1, 9), pick(random, 1, 9), pick(random, 1, 9));
  from.fill(Fill::noise, random);
  to.fill(Fill::noise, random);
  const Bytes before = to.blocks();
  const auto blocks = random_selection(random, block_count(desc));
  std::vector<UploadBox> boxes;
  const auto view = std::as_const(from).view();
  RC_ASSERT(upload_boxes(desc, view, blocks, boxes) == Status::ok);
  RC_ASSERT(boxes.size() <= blocks.size());
  for (const UploadBox& box : boxes) copy_box(box, view, desc, to);
  const Bytes after = to.blocks();
  const std::size_t size = guarded_bytes(desc);
  for (std::uint32_t block = 0; block < block_count(desc); ++block) {
    const auto of = [&](const Bytes& all) { return std::span(all).subspan(block * size, size); };
    const bool copied = std::ranges::find(blocks, block) != blocks.end();
    const Bytes wanted = copied ? from.block(block) : Bytes();
    RC_ASSERT(same(of(after), copied ? std::span<const std::byte>(wanted) : of(before)));
  }
  RC_ASSERT(to.padding_untouched());
}

TEST(Upload, BlocksAreThoseOfLaterFrames) {
  ClientTexture texture;
  texture.changed = {3, 4, 0, 9};
  std::vector<std::uint32_t> blocks{7};
  ASSERT_EQ(texture.changed_blocks(3, blocks), Status::ok);
  EXPECT_EQ(blocks, (std::vector<std::uint32_t>{1, 3}));
  ASSERT_EQ(texture.changed_blocks(0, blocks), Status::ok);
  EXPECT_EQ(blocks, (std::vector<std::uint32_t>{0, 1, 3}));
}

TEST(Upload, RowsAreOneBox) {
  const TextureDesc desc = ddgi_irradiance({4, 2, 3});
  const Bytes texels(texture_bytes(desc));
  std::vector<std::uint32_t> blocks(24);
  std::iota(blocks.begin(), blocks.end(), 0U);
  std::vector<UploadBox> boxes;
  ASSERT_EQ(upload_boxes(desc, ConstTextureView(texels), blocks, boxes), Status::ok);
  ASSERT_EQ(boxes.size(), 3U);  // Rows of tiles of the atlas.
  EXPECT_EQ(boxes[1], (UploadBox{80 * 4 * 10, 80 * 4, 80 * 4 * 30, 0, 10, 0, 80, 10, 1}));
  blocks.erase(blocks.begin() + 1);
  std::ranges::reverse(blocks);
  ASSERT_EQ(upload_boxes(desc, ConstTextureView(texels), blocks, boxes), Status::ok);
  EXPECT_EQ(boxes.size(), 4U);
  const auto less = std::span(texels).first(texels.size() - 1);
  EXPECT_EQ(upload_boxes(desc, ConstTextureView(less), blocks, boxes), Status::view_too_small);
  blocks[3] = 24;
  EXPECT_EQ(upload_boxes(desc, ConstTextureView(texels), blocks, boxes),
            Status::block_out_of_range);
}

}  // namespace
}  // namespace gicodec
