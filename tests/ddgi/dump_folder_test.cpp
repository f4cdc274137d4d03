// The folder of a trace: what may be replaced, and what stays whatever happens to it meanwhile.
#include "ddgi/dump_folder.h"
#include "dump/error.h"
#include "rooms.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace gicodec::ddgi {
namespace {

namespace fs = std::filesystem;

class Folder : public testing::Test {
 protected:
  Folder() {
    std::string name = (fs::temp_directory_path() / "gicodec-folder-XXXXXX").string();
    root_ = mkdtemp(name.data());
    traced_.volume.update(0);
  }
  ~Folder() override { fs::remove_all(root_); }

  [[nodiscard]] DumpFolder open(Former former, const std::string& ending = "exr") const {
    return DumpFolder(root_.string(), "room", shape_, "settings\n", former, {},
                      {{kColorName, kVisibilityName}, ending});
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(root_ / name) << text;
  }
  [[nodiscard]] std::string read(const std::string& name) const {
    std::ifstream in(root_ / name);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  [[nodiscard]] std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(root_), fs::directory_iterator()));
  }
  [[nodiscard]] std::vector<FrameTexture> textures() const {
    return frame_textures(traced_.volume.textures());
  }

  fs::path root_;
  test::Traced traced_{test::busy_room(), {.rays = 16}, 1};
  VolumeShape shape_ = traced_.volume.shape();
};

TEST_F(Folder, WhatAppearsMeanwhileStays) {
  for (const Former former : {Former::refuse, Former::resume}) {
    {
      DumpFolder folder = open(former);
      write("color.0000.exr", "another's");
      EXPECT_THROW(folder.write_frame(0, 0, textures()), tools::Error);
    }
    EXPECT_EQ(read("color.0000.exr"), "another's");
    EXPECT_EQ(files(), 1U);
    fs::remove(root_ / "color.0000.exr");
  }
}

TEST_F(Folder, SidecarsAppearAndGoWithTheirTexels) {
  for (const char* taken : {"vis.0000.json", "vis.0000.raw"}) {
    {
      DumpFolder folder = open(Former::refuse, "raw");
      write(taken, "another's");
      EXPECT_THROW(folder.write_frame(0, 0, textures()), tools::Error);
    }
    EXPECT_EQ(read(taken), "another's");
    EXPECT_EQ(files(), 1U) << taken;
    fs::remove(root_ / taken);
  }
  {
    DumpFolder folder = open(Former::refuse, "raw");
    folder.write_frame(0, 0, textures());
  }
  EXPECT_EQ(files(), 5U);
  EXPECT_TRUE(open(Former::resume, "raw").holds(0));
  fs::remove(root_ / "color.0000.json");
  DumpFolder folder = open(Former::resume, "raw");
  EXPECT_FALSE(folder.holds(0));
  folder.write_frame(0, 0, textures());
  EXPECT_EQ(files(), 5U);
}

TEST_F(Folder, WhatTookItsPlaceStays) {
  {
    DumpFolder folder = open(Former::refuse);
    folder.write_positions({}, true);
    write("another", "another's");
    fs::rename(root_ / "another", root_ / "positions.csv");
  }
  EXPECT_EQ(read("positions.csv"), "another's");
  EXPECT_EQ(files(), 1U);
}

TEST_F(Folder, OnlyWhatATraceWroteIsReplaced) {
  write("color.0000.exr", "another's");
  write("views.jsonl", "notes");
  EXPECT_THROW((void)open(Former::replace), tools::Error);
  EXPECT_EQ(read("color.0000.exr"), "another's");
  EXPECT_EQ(files(), 2U);
}

// A step that fails undoes those before it.
TEST_F(Folder, FormerResultsComeBack) {
  {
    DumpFolder folder = open(Former::refuse);
    folder.write_frame(0, 0, textures());
    folder.finish();
  }
  const std::string before = read("vis.0000.exr");
  {
    DumpFolder folder = open(Former::replace);
    folder.write_frame(0, 0, textures());
    folder.write_frame(1, 0, textures());
    fs::create_directory(root_ / "vis.0001.exr");
    write("vis.0001.exr/precious", "another's");
    EXPECT_THROW(folder.finish(), tools::Error);
  }
  EXPECT_EQ(read("vis.0000.exr"), before);
  EXPECT_FALSE(fs::exists(root_ / "color.0001.exr"));
  EXPECT_EQ(read("trace.json"), "settings\n");
  EXPECT_EQ(read("vis.0001.exr/precious"), "another's");

  fs::remove_all(root_ / "vis.0001.exr");
  {
    DumpFolder folder = open(Former::replace);
    folder.write_frame(1, 0, textures());
    folder.finish();
  }
  EXPECT_FALSE(fs::exists(root_ / "color.0000.exr"));
  EXPECT_FALSE(read("color.0001.exr").empty());
}

}  // namespace
}  // namespace gicodec::ddgi
