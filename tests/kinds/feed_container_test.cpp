// What a feed gives comes back from its container, frame by frame, whatever the kind.
#include "programs/feed_container.h"
#include "payload_conformance.h"
#include "tools/dump_support.h"

#include "common/container_input.h"
#include "dump/error.h"
#include "programs/stored_volume.h"

#include <gicodec/photons.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

namespace gicodec::kinds {
namespace {

/// The textures of a container's volume after a frame, as a client would have them.
ClientVolume shown(const tools::ContainerInput& input, std::size_t first, std::size_t textures) {
  ClientVolume volume;
  for (std::size_t id = first; id < first + textures; ++id) {
    volume.textures.emplace_back().texels = input.texels(id);
  }
  return volume;
}

class FeedContainers : public testing::TestWithParam<std::size_t> {};

TEST_P(FeedContainers, GiveBackEveryFrame) {
  const test::Row row = test::payload_rows()[GetParam()];
  if (find_kind(row.volume.kind) == nullptr) GTEST_SKIP() << "a kind of the tests' own";
  if (row.volume.kind == kKindTextures) GTEST_SKIP() << "slots are placed by metadata";
  tools::TemporaryDirectory directory;
  const std::string path = directory.path("x.gic");
  Feed feed;
  feed.scene = {"somewhere", 7};
  feed.volumes = {{"first", {row.volume.groups[0].textures[0].desc.grid}, row.volume},
                  {"second", {row.volume.groups[0].textures[0].desc.grid}, row.volume}};
  test::Generator random(GetParam() + 1);
  std::vector<test::Contents> first, second;
  test::Contents a = test::blank(row.volume), b = a;
  FeedContainer container(path, feed, {2, 5}, "native");
  for (std::uint64_t frame = 0; frame < 5; ++frame) {
    if (frame != 3) test::change(row.volume, a, random);
    if (frame % 2 == 0) test::change(row.volume, b, random);
    first.push_back(a);
    second.push_back(b);
    container.add(frame, {0, 0, {{{}, {}, a}, {{}, {}, b}}});
  }
  container.finish();

  tools::ContainerInput input(path);
  EXPECT_EQ(input.description().scene, feed.scene);
  const auto times = times_of(input.description());
  ASSERT_TRUE(times);
  EXPECT_EQ(times->at(3), 2.6);
  const std::size_t textures = first[0].size();
  for (std::uint64_t frame = 0; frame < 5; ++frame) {
    ASSERT_TRUE(input.next_frame());
    ASSERT_EQ(input.frame(), frame);
    EXPECT_EQ(test::compare(row.volume, first[frame], shown(input, 0, textures)), "") << row.name;
    EXPECT_EQ(test::compare(row.volume, second[frame], shown(input, textures, textures)), "")
        << row.name;
  }
  EXPECT_FALSE(input.next_frame());
}

/// Keeps what it is shown.
class Kept final : public VolumeLight {
 public:
  void update(const HeldVolume& volume, double /*time*/) override {
    held.textures.clear();
    for (const HeldTexture& texture : volume.textures) {
      held.textures.emplace_back().texels.assign(texture.texels.begin(), texture.texels.end());
    }
  }
  [[nodiscard]] ddgi::Vec3 irradiance(const ddgi::SeenSurface& /*seen*/) const override {
    return {};
  }
  ClientVolume held;
};

/// Wherever a container is cut off: a frame that is shown is whole.
TEST(StoredVolumes, ShowWholeFramesOnly) {
  const auto rows = test::payload_rows();
  const auto row =
      std::ranges::find(rows, kKindPhotons, [](const test::Row& one) { return one.volume.kind; });
  ASSERT_NE(row, rows.end());
  tools::TemporaryDirectory directory;
  const std::string path = directory.path("x.gic"), cut = directory.path("cut.gic");
  Feed feed;
  feed.volumes = {{"first", {row->volume.groups[0].textures[0].desc.grid}, row->volume}};
  test::Generator random(1);
  std::vector<test::Contents> frames(3, test::blank(row->volume));
  FeedContainer container(path, feed, {}, "native");
  for (std::uint64_t frame = 0; frame < frames.size(); ++frame) {
    if (frame > 0) frames[frame] = frames[frame - 1];
    test::change(row->volume, frames[frame], random);
    container.add(frame, {0, 0, {{{}, {}, frames[frame]}}});
  }
  container.finish();
  const std::uintmax_t size = std::filesystem::file_size(path);
  std::size_t shown = 0, refused = 0;
  for (std::uintmax_t left = size; left > size / 4; left -= 5) {
    std::filesystem::copy_file(path, cut, std::filesystem::copy_options::overwrite_existing);
    std::filesystem::resize_file(cut, left);
    for (std::uint64_t frame = 0; frame < frames.size(); ++frame) {
      try {
        StoredVolume stored(cut, true, {});
        Kept light;
        stored.show(frame, light);
        ++shown;
        EXPECT_EQ(test::compare(row->volume, frames[frame], light.held), "")
            << left << " of " << size << ", frame " << frame;
      } catch (const tools::Error& error) {
        ++refused;
        EXPECT_EQ(error.code(), tools::Exit::bad_input) << error.what();
      }
    }
  }
  EXPECT_GT(shown, 10U);
  EXPECT_GT(refused, 10U);
}

INSTANTIATE_TEST_SUITE_P(All, FeedContainers,
                         testing::Range(std::size_t{0}, test::payload_rows().size()));

}  // namespace
}  // namespace gicodec::kinds
