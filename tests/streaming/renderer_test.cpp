// Pictures stay in their folder whatever the server calls its textures, and take the place of
// nothing else.
#include "stream/renderer.h"
#include "dump/error.h"

#include <gicodec/probes.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace gicodec::streaming {
namespace {

namespace fs = std::filesystem;
using tools::Existing;

class Pictures : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(root_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(root_); }

  /// A frame of one texture.
  static ClientFrame frame_of(const std::string& volume, const std::string& texture) {
    const TextureDesc desc = probe_texture(Format::R16G16_SFLOAT, {1, 1, 1}, 1, 0);
    ClientTexture held;
    held.name = texture;
    held.desc = desc;
    held.texels.resize(static_cast<std::size_t>(texture_bytes(desc)));
    held.changed = {1};
    ClientVolume one;
    one.name = volume;
    one.textures = {held};
    ClientFrame frame;
    frame.volumes = {one};
    return frame;
  }
  void draw(const ClientFrame& frame, std::uint32_t number, Existing existing) const {
    Renderer renderer(nullptr, {}, 1, PictureFolder(folder_.string(), existing), {});
    static_cast<void>(renderer.draw(frame, {}, number));
  }
  /// Everything below the parent of the folder.
  [[nodiscard]] std::vector<fs::path> files() const {
    std::vector<fs::path> found;
    for (const auto& entry : fs::recursive_directory_iterator(root_)) {
      if (entry.is_regular_file()) found.push_back(entry.path());
    }
    return found;
  }

  const fs::path root_ =
      fs::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name();
  const fs::path folder_ = root_ / "a" / "b";
};

TEST_F(Pictures, HostileNamesLeadNowhereElse) {
  const std::string names[] = {"../../x",
                               "/tmp/gicodec-x",
                               "a/b",
                               std::string("nul\0/../x", 9),
                               "..",
                               ".hidden",
                               "",
                               "\x1b[2J\r\n\x7f",
                               "\xff\xfe",
                               "CON:|?*\\",
                               "CON____",
                               std::string(255, 'x'),
                               std::string(255, '/')};
  std::uint32_t number = 0;
  for (const std::string& volume : names) {
    for (const std::string& texture : names) {
      ASSERT_NO_THROW(draw(frame_of(volume, texture), number, Existing::refuse)) << volume;
      const auto found = files();
      ASSERT_EQ(found.size(), ++number) << "a picture of " << volume << " is elsewhere";
    }
  }
  for (const fs::path& file : files()) {
    const std::string name = file.filename().string();
    EXPECT_EQ(file.parent_path(), folder_);
    EXPECT_NE(name.front(), '.') << name;
    EXPECT_LT(name.size(), 256U);
    EXPECT_EQ(name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                     "0123456789-_.%~"),
              name.npos)
        << name;
  }
}

TEST_F(Pictures, OrdinaryNamesStay) {
  draw(frame_of("world", "irradiance-2"), 7, Existing::refuse);
  EXPECT_TRUE(fs::exists(folder_ / "world.irradiance-2.0007.png"));
}

TEST_F(Pictures, AnEarlierPictureStaysUnlessItMayBeReplaced) {
  const fs::path picture = folder_ / "world.vis.0000.png";
  std::ofstream(picture) << "mine";
  const auto text = [&] {
    std::ifstream in(picture, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  try {
    draw(frame_of("world", "vis"), 0, Existing::refuse);
    FAIL() << "it was replaced";
  } catch (const tools::Error& error) {
    EXPECT_EQ(error.code(), tools::Exit::io);
    EXPECT_NE(std::string(error.what()).find("--overwrite"), std::string::npos) << error.what();
  }
  EXPECT_EQ(text(), "mine");
  draw(frame_of("world", "vis"), 0, Existing::replace);
  EXPECT_NE(text(), "mine");
}

TEST_F(Pictures, OfOneFrameWhoseNamesBecomeTheSameAreNoError) {
  ClientFrame frame = frame_of("a/b", "vis");
  frame.volumes.push_back(frame_of("a.b", "vis").volumes.front());
  EXPECT_NO_THROW(draw(frame, 0, Existing::refuse));
  EXPECT_THROW(draw(frame, 0, Existing::refuse), tools::Error);
}

}  // namespace
}  // namespace gicodec::streaming
