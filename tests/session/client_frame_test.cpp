// A client's frames: what changed in them, and copies that follow.
#include "support.h"
#include "volumes.h"

#include <gicodec/client.h>

#include <gtest/gtest.h>

#include <algorithm>

namespace gicodec {
namespace {

using namespace test;

ClientFrame frame_of(const TextureDesc& desc, std::uint64_t serial) {
  ClientFrame frame;
  frame.serial = serial;
  frame.volumes.push_back({0, 1, "volume", probes_of({{"t", desc}}), {desc.grid}, {}, {}});
  frame.volumes[0].textures.push_back({"t", desc, std::vector<std::byte>(texture_bytes(desc)),
                                       std::vector<std::uint64_t>(block_count(desc), serial), 0});
  return frame;
}

TEST(ClientFrames, CopiesFollowWithWhatChanged) {
  const TextureDesc desc = probe_texture(Format::R8_UINT, {4, 2, 1}, 2);
  ClientFrame from = frame_of(desc, 1), to;
  ASSERT_EQ(copy_changes(from, to), Status::ok);
  ClientTexture& texture = from.volumes[0].textures[0];
  std::fill(texture.texels.begin(), texture.texels.end(), std::byte{7});
  from.serial = texture.changed[3] = 2;
  ASSERT_EQ(copy_changes(from, to), Status::ok);
  const ClientTexture& copy = to.volumes[0].textures[0];
  EXPECT_EQ(copy.changed, texture.changed);
  EXPECT_EQ(std::ranges::count(copy.texels, std::byte{7}), 16) << "of one block";
  EXPECT_EQ(to.serial, 2U);
}

TEST(ClientFrames, ChangedBlocksAreThoseOfTheTexture) {
  const TextureDesc desc = probe_texture(Format::R8_UINT, {4, 2, 1}, 2);
  ClientTexture texture = frame_of(desc, 1).volumes[0].textures[0];
  texture.changed.assign(9, 5);
  texture.changed.resize(8);  // What lies behind it changed as well.
  texture.changed[6] = 4;
  std::vector<std::uint32_t> blocks;
  ASSERT_EQ(texture.changed_blocks(4, blocks), Status::ok);
  EXPECT_EQ(blocks, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 7}));
  ASSERT_EQ(texture.changed_blocks(5, blocks), Status::ok);
  EXPECT_TRUE(blocks.empty());
}

}  // namespace
}  // namespace gicodec
