#include "dump/sequence.h"

#include "dump/error.h"
#include "tools/dump_support.h"

#include <gtest/gtest.h>

#include <fstream>

namespace gicodec::tools {
namespace {

std::string message_of(const std::vector<std::string>& paths, bool allow_gaps = false) {
  try {
    (void)group_sequences(paths, allow_gaps);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::bad_input);
    return error.what();
  }
  return "";
}

TEST(Sequence, GroupsByName) {
  const auto sequences =
      group_sequences({"a/color.0001.exr", "a/vis.0002.exr", "b/color.0002.exr", "vis.0001.exr"});
  ASSERT_EQ(sequences.size(), 2U);
  EXPECT_EQ(sequences[0].name, "color");
  EXPECT_EQ(sequences[0].digits, 4U);
  EXPECT_EQ(sequences[1].name, "vis");
  ASSERT_EQ(sequences[1].frames.size(), 2U);
  EXPECT_EQ(sequences[1].frames[0].frame, 1U);
  EXPECT_EQ(sequences[1].frames[0].path, "vis.0001.exr");
  EXPECT_EQ(all_frames(sequences), (std::vector<std::uint64_t>{1, 2}));
}

TEST(Sequence, NamesComeBack) {
  for (const std::string name : {"color.0007.exr", "color.7.exr", "a.b.12345.exr", "color.exr",
                                 "color.000000000000000007.exr", "v1.2.exr"}) {
    const auto sequences = group_sequences({name});
    EXPECT_EQ(frame_file_name(sequences[0].name, sequences[0].digits, sequences[0].frames[0].frame,
                              sequences[0].extension),
              name);
  }
}

TEST(Sequence, NumbersMayGrowBeyondTheirDigits) {
  const auto sequences = group_sequences({"c.9.exr", "c.10.exr", "c.11.exr"});
  EXPECT_EQ(sequences[0].digits, 1U);
  EXPECT_NE(message_of({"c.09.exr", "c.10.exr", "c.011.exr"}).find("differ in width"),
            std::string::npos);
}

TEST(Sequence, MissingFrames) {
  EXPECT_NE(message_of({"color.0000.exr", "color.0002.exr"}).find("color.0001.exr"),
            std::string::npos);
  EXPECT_NE(message_of({"color.0000.exr", "color.0001.exr", "vis.0000.exr"}).find("vis.0001.exr"),
            std::string::npos);
  EXPECT_EQ(message_of({"color.0000.exr", "color.0002.exr", "vis.0001.exr"}, true), "");
}

TEST(Sequence, FramesTwice) {
  const std::string message = message_of({"a/color.0001.exr", "b/color.0001.exr"}, true);
  EXPECT_NE(message.find("a/color.0001.exr"), std::string::npos);
  EXPECT_NE(message.find("b/color.0001.exr"), std::string::npos);
  EXPECT_NE(message_of({"color.0000.exr", "color.exr"}, true), "");
}

TEST(Sequence, Directories) {
  const TemporaryDirectory directory;
  for (const char* name : {"vis.0000.exr", "color.0000.exr", "notes.txt", ".hidden.0000.exr"}) {
    std::ofstream(directory.path(name)) << "x";
  }
  const auto sequences = group_sequences({directory.path("")});
  ASSERT_EQ(sequences.size(), 2U);
  EXPECT_EQ(sequences[0].name, "color");
  const TemporaryDirectory empty;
  EXPECT_NE(message_of({empty.path("")}).find("no .exr files"), std::string::npos);
}

}  // namespace
}  // namespace gicodec::tools
