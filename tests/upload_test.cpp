// What is to be uploaded: copying these boxes, and nothing else, brings a texture up to date.
#include "shapes.h"
#include "support.h"

#include <gicodec/upload.h>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cstring>

namespace gicodec {
namespace {

using namespace test;

/// As a graphics API does it: a row of a box at a time, into the view of another texture.
void copy_box(const UploadRegion& box, const ConstTextureView& from, const TextureDesc& desc,
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
  std::vector<std::uint64_t> changed(block_count(desc), 3);
  for (const std::uint32_t block : blocks) changed[block] = 4 + random() % 3;
  std::vector<UploadRegion> boxes;
  const auto view = std::as_const(from).view();
  RC_ASSERT(upload_regions(desc, view, changed, 3, boxes) == Status::ok);
  RC_ASSERT(boxes.size() <= blocks.size());
  std::vector<std::uint32_t> list;
  RC_ASSERT(changed_blocks(changed, 3, list) == Status::ok);
  RC_ASSERT(std::ranges::is_permutation(list, blocks));
  RC_ASSERT(std::ranges::is_sorted(list));
  for (const UploadRegion& box : boxes) copy_box(box, view, desc, to);
  const Bytes after = to.blocks();
  const std::size_t size = guarded_bytes(desc);
  for (std::uint32_t block = 0; block < changed.size(); ++block) {
    const auto of = [&](const Bytes& all) { return std::span(all).subspan(block * size, size); };
    const Bytes wanted = changed[block] > 3 ? from.block(block) : Bytes();
    RC_ASSERT(
        same(of(after), changed[block] > 3 ? std::span<const std::byte>(wanted) : of(before)));
  }
  RC_ASSERT(to.padding_untouched());
}

TEST(Upload, RowsAreOneBox) {
  const TextureDesc desc = ddgi_irradiance({4, 2, 3});
  const Bytes texels(texture_bytes(desc));
  std::vector<std::uint64_t> changed(24, 1);
  std::vector<UploadRegion> boxes;
  ASSERT_EQ(upload_regions(desc, ConstTextureView(texels), changed, 0, boxes), Status::ok);
  ASSERT_EQ(boxes.size(), 3U);  // Rows of tiles of the atlas.
  EXPECT_EQ(boxes[1], (UploadRegion{80 * 4 * 10, 80 * 4, 80 * 4 * 30, 0, 10, 0, 80, 10, 1}));
  changed[1] = 0;
  ASSERT_EQ(upload_regions(desc, ConstTextureView(texels), changed, 0, boxes), Status::ok);
  EXPECT_EQ(boxes.size(), 4U);
  changed.pop_back();
  EXPECT_EQ(upload_regions(desc, ConstTextureView(texels), changed, 0, boxes),
            Status::mask_mismatch);
  changed.push_back(0);
  const auto less = std::span(texels).first(texels.size() - 1);
  EXPECT_EQ(upload_regions(desc, ConstTextureView(less), changed, 0, boxes),
            Status::view_too_small);
}

}  // namespace
}  // namespace gicodec
