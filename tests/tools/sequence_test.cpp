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
                                 "color.000000000000000007.exr", "v1.2.exr", "color_7.exr",
                                 "color-0007.exr", "color0007.exr", "_0007.exr", "0007.exr"}) {
    const auto sequences = group_sequences({name});
    EXPECT_EQ(frame_file_name(sequences[0].name, sequences[0].digits, sequences[0].frames[0].frame,
                              sequences[0].extension, sequences[0].separator),
              name);
  }
}

TEST(Sequence, OtherSeparators) {
  for (const std::string separator : {"_", "-", ""}) {
    const auto name = [&](const char* texture, int frame) {
      return fmt::format("{}{}{:04}.exr", texture, separator, frame);
    };
    const auto sequences =
        group_sequences({name("color", 7), name("color", 8), name("vis", 7), name("vis", 8)});
    ASSERT_EQ(sequences.size(), 2U) << separator;
    EXPECT_EQ(sequences[0].name, "color");
    EXPECT_EQ(sequences[0].separator, separator);
    EXPECT_EQ(sequences[0].digits, 4U);
    EXPECT_EQ(frame_file_name("vis", 4, 8, "exr", sequences[1].separator), name("vis", 8));
    EXPECT_NE(message_of({name("color", 7), name("color", 9)}).find(name("color", 8)),
              std::string::npos);
  }
}

// A short number is a frame's only where it tells files apart.
TEST(Sequence, NumbersThatBelongToTheName) {
  const auto names = [](const std::vector<std::string>& paths) {
    std::vector<std::string> found;
    for (const Sequence& sequence : group_sequences(paths, true)) found.push_back(sequence.name);
    return found;
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(names({"irr8.exr", "vis16.exr"}), (Names{"irr8", "vis16"}));
  EXPECT_EQ(names({"color_2.exr"}), Names{"color_2"});
  EXPECT_EQ(names({"color_002.exr"}), Names{"color"});
  EXPECT_EQ(names({"probe123.exr"}), Names{"probe123"});
  EXPECT_EQ(names({"color_1.exr", "color_2.exr"}), Names{"color"});
  EXPECT_EQ(names({"color9.exr", "color10.exr"}), Names{"color"});
  EXPECT_EQ(names({"0001.exr"}), Names{"0001"});
  EXPECT_NE(message_of({"color.0001.exr", "color_0001.exr"}).find("rename"), std::string::npos);
  EXPECT_NE(message_of({"c_09.exr", "c_10.exr", "c_011.exr"}).find("differ in width"),
            std::string::npos);
}

TEST(Sequence, QuestionsNumbersThatAreNotLast) {
  const auto question = [](const std::vector<std::string>& paths) {
    return question_of(group_sequences(paths, true));
  };
  EXPECT_NE(question({"0_c.exr", "1_c.exr", "2_c.exr"}).find("put the number last"),
            std::string::npos);
  EXPECT_NE(question({"0001.exr", "0002.exr", "0003.exr"}), "");
  EXPECT_EQ(question({"color.0.exr", "vis.0.exr", "sky.0.exr"}), "");
  EXPECT_EQ(question({"c.1.exr", "c.2.exr", "c.3.exr"}), "");
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
  EXPECT_EQ(message_of({"sky.exr", "color.0000.exr", "color.0001.exr"}), "");
}

TEST(Sequence, FramesTwice) {
  const std::string message = message_of({"a/color.0001.exr", "b/color.0001.exr"}, true);
  EXPECT_NE(message.find("a/color.0001.exr"), std::string::npos);
  EXPECT_NE(message.find("b/color.0001.exr"), std::string::npos);
  EXPECT_NE(message_of({"color.0000.exr", "color.exr"}, true), "");
}

TEST(Sequence, Directories) {
  const TemporaryDirectory directory;
  for (const char* name : {"vis.0000.EXR", "color.0000.exr", "notes.txt", ".hidden.0000.exr"}) {
    std::ofstream(directory.path(name)) << "x";
  }
  const auto sequences = group_sequences({directory.path("")});
  ASSERT_EQ(sequences.size(), 2U);
  EXPECT_EQ(sequences[0].name, "color");
  const TemporaryDirectory empty;
  EXPECT_NE(message_of({empty.path("")}).find("has no .exr"), std::string::npos);
}

}  // namespace
}  // namespace gicodec::tools
