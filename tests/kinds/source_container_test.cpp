// What a source gives comes back from its container, frame by frame, whatever the kind.
#include "kinds/source_container.h"
#include "payload_conformance.h"
#include "tools/dump_support.h"

#include "gicodec/container_input.h"

#include <gtest/gtest.h>

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

class SourceContainers : public testing::TestWithParam<std::size_t> {};

TEST_P(SourceContainers, GiveBackEveryFrame) {
  const test::Row row = test::payload_rows()[GetParam()];
  if (find_kind(row.volume.kind) == nullptr) GTEST_SKIP() << "a kind of the tests' own";
  if (row.volume.kind == kKindTextures) GTEST_SKIP() << "slots are placed by metadata";
  tools::TemporaryDirectory directory;
  const std::string path = directory.path("x.gic");
  Source source;
  source.scene = {"somewhere", 7};
  source.volumes = {{"first", {row.volume.sets[0].textures[0].desc.grid}, row.volume},
                    {"second", {row.volume.sets[0].textures[0].desc.grid}, row.volume}};
  test::Generator random(GetParam() + 1);
  std::vector<test::Contents> first, second;
  test::Contents a = test::blank(row.volume), b = a;
  SourceContainer container(path, source, {2, 5}, "native");
  for (std::uint64_t frame = 0; frame < 5; ++frame) {
    if (frame != 3) test::change(row.volume, a, random);
    if (frame % 2 == 0) test::change(row.volume, b, random);
    first.push_back(a);
    second.push_back(b);
    container.add(frame, {0, 0, {{{}, {}, a}, {{}, {}, b}}});
  }
  container.finish();

  tools::ContainerInput input(path);
  EXPECT_EQ(input.description().scene, source.scene);
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

INSTANTIATE_TEST_SUITE_P(All, SourceContainers,
                         testing::Range(std::size_t{0}, test::payload_rows().size()));

}  // namespace
}  // namespace gicodec::kinds
