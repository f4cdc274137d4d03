#include "dump/sequence.h"

#include "dump/error.h"
#include "tools/dump_support.h"

#include <gicodec/textures.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace gicodec::tools {
namespace {

std::string message_of(const std::vector<std::string>& paths, bool allow_gaps = false) {
  try {
    (void)group_sequences(paths, {.allow_gaps = allow_gaps});
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::bad_input);
    return error.what();
  }
  return "";
}

std::string name_of_first(const Sequence& sequence) {
  return sequence.file_name(sequence.frames[0].frame);
}

TEST(Sequence, GroupsByName) {
  const auto sequences =
      group_sequences({"a/color.0001.exr", "a/vis.0002.exr", "b/color.0002.exr", "vis.0001.exr"});
  ASSERT_EQ(sequences.size(), 2U);
  EXPECT_EQ(sequences[0].name, "color");
  EXPECT_EQ(sequences[0].names.digits, 4U);
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
    EXPECT_EQ(name_of_first(sequences[0]), name);
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
    EXPECT_EQ(sequences[0].names.separator, separator);
    EXPECT_EQ(sequences[0].names.digits, 4U);
    EXPECT_EQ(sequences[1].file_name(8), name("vis", 8));
    EXPECT_NE(message_of({name("color", 7), name("color", 9)}).find(name("color", 8)),
              std::string::npos);
  }
}

// A short number is a frame's only where it tells files apart.
TEST(Sequence, NumbersThatBelongToTheName) {
  const auto names = [](const std::vector<std::string>& paths) {
    std::vector<std::string> found;
    for (const Sequence& sequence : group_sequences(paths, {.allow_gaps = true}))
      found.push_back(sequence.name);
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
    return question_of(group_sequences(paths, {.allow_gaps = true}));
  };
  EXPECT_NE(question({"0_c.exr", "1_c.exr", "2_c.exr"}).find("put the number last"),
            std::string::npos);
  EXPECT_NE(question({"0001.exr", "0002.exr", "0003.exr"}), "");
  EXPECT_EQ(question({"color.0.exr", "vis.0.exr", "sky.0.exr"}), "");
  EXPECT_EQ(question({"c.1.exr", "c.2.exr", "c.3.exr"}), "");
}

TEST(Sequence, NumbersMayGrowBeyondTheirDigits) {
  const auto sequences = group_sequences({"c.9.exr", "c.10.exr", "c.11.exr"});
  EXPECT_EQ(sequences[0].names.digits, 1U);
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

TEST(Sequence, NegativeFrames) {
  const auto sequences = group_sequences(
      {"foo.-003.exr", "foo.-002.exr", "foo.-001.exr", "foo.000.exr", "foo.001.exr"});
  ASSERT_EQ(sequences.size(), 1U);
  EXPECT_EQ(sequences[0].name, "foo");
  EXPECT_EQ(sequences[0].names.base, -3);
  EXPECT_EQ(sequences[0].frames[0].frame, 0U);
  EXPECT_EQ(sequences[0].frames[4].frame, 4U);
  EXPECT_EQ(name_of_first(sequences[0]), "foo.-003.exr");
  EXPECT_NE(message_of({"foo.-003.exr", "foo.-001.exr"}).find("foo.-002.exr"), std::string::npos);
  // As printf() pads them.
  const auto padded =
      group_sequences({"foo.-010.exr", "foo.-009.exr", "foo.0000.exr"}, {.allow_gaps = true});
  EXPECT_TRUE(padded[0].names.counts_sign);
  for (const FrameFile& file : padded[0].frames) {
    EXPECT_EQ(padded[0].file_name(file.frame), file.path);
  }
  EXPECT_NE(message_of({"foo.-01.exr", "foo.0000.exr"}, true).find("name it"), std::string::npos);
  EXPECT_EQ((FileNames{.digits = 4, .extension = "exr"}.of("foo", ~std::uint64_t{0})),
            "foo.18446744073709551615.exr");
  EXPECT_EQ((FileNames{4, "exr", "_", -12}.of("foo", 0)), "foo_-0012.exr");
  // Behind no other separator it is one.
  EXPECT_EQ(group_sequences({"foo-003.exr"})[0].names.base, 0);
  EXPECT_EQ(group_sequences({"-003.exr"})[0].name, "-003");
}

TEST(Sequence, NumbersThatAreNoFrames) {
  using Names = std::vector<std::string>;
  const auto names = [](const std::vector<std::string>& paths, const NumberOptions& options = {}) {
    Names found;
    for (const Sequence& sequence : group_sequences(paths, options)) {
      found.push_back(sequence.name + (sequence.names.digits > 0 ? "#" : ""));
    }
    return found;
  };
  // UDIM tiles, versions, sides.
  EXPECT_EQ(names({"irr_1001.exr", "irr_1002.exr", "irr_1011.exr"}),
            (Names{"irr_1001", "irr_1002", "irr_1011"}));
  EXPECT_EQ(names({"u1_v1.exr", "u1_v2.exr", "u2_v1.exr"}), (Names{"u1_v1", "u1_v2", "u2_v1"}));
  EXPECT_EQ(names({"sky_1024x1024.exr", "sky_2048x2048.exr"}),
            (Names{"sky_1024x1024", "sky_2048x2048"}));
  EXPECT_EQ(names({"Layer-3.exr", "Lightmap-0.exr"}), (Names{"Layer-3", "Lightmap-0"}));
  // A number that no other file has.
  EXPECT_EQ(names({"sky2048.exr", "floor.exr", "wall_1024.exr", "sun.0000.exr"}),
            (Names{"sky2048", "floor", "wall_1024", "sun#"}));
  EXPECT_EQ(names({"color_0007.exr", "vis_0007.exr"}), (Names{"color#", "vis#"}));
  // One run.
  EXPECT_EQ(names({"irr_1001.exr", "irr_1002.exr"}), Names{"irr#"});
  EXPECT_EQ(names({"Layer-3.exr", "Layer-4.exr"}), Names{"Layer#"});
  // As flags say.
  EXPECT_EQ(names({"irr.0001.exr", "irr.0002.exr"}, {.stills = true}),
            (Names{"irr.0001", "irr.0002"}));
  EXPECT_EQ(names({"irr_1001.exr", "irr_1002.exr", "b_1.exr", "b_2.exr"},
                  {.stills = true, .patterns = {"b_#"}}),
            (Names{"irr_1001", "irr_1002", "b#"}));
  EXPECT_EQ(names({"u1_v1.exr", "u1_v2.exr"}, {.patterns = {"*v##.exr"}}), Names{"u1_v#"});
  for (const NumberOptions& wrong : {NumberOptions{.patterns = {"a_"}},
                                     {.patterns = {"b_#"}},
                                     {.patterns = {"a_#", "a_#.dds"}}}) {
    EXPECT_THROW((void)names({"a_1.exr"}, wrong), Error);
  }
  // Stills are of the first frame.
  const auto beside = group_sequences({"sky.exr", "irr.0007.exr", "irr.0008.exr"});
  EXPECT_EQ(beside[0].frames[0].frame, 7U);
  EXPECT_EQ(all_frames(beside), (std::vector<std::uint64_t>{7, 8}));
  // As a container has them.
  Sequence still{.name = "irr_1001", .names = {.extension = "exr"}};
  EXPECT_EQ(names({"irr_1001.exr"}, {.known = {still}}), Names{"irr_1001"});
}

TEST(Sequence, FilesOfOtherShapesAreStills) {
  const TemporaryDirectory directory;
  std::vector<std::string> paths;
  SequenceRemarks remarks;
  for (const std::uint32_t side : {4U, 5U, 6U}) {
    const Dump dump = random_dump(map_texture(Format::R16_SFLOAT, {side, 4, 1}, {8, 8, 1}), side);
    paths.push_back(directory.path(fmt::format("a_{}.exr", side)));
    write_dump(paths.back(), dump.info, dump.texels);
  }
  EXPECT_EQ(group_sequences(paths, {}, &remarks).size(), 3U);
  ASSERT_EQ(remarks.guesses.size(), 1U);
  EXPECT_NE(remarks.guesses[0].find(
                "taken for a texture of its own, since their shapes or formats differ"),
            std::string::npos)
      << remarks.guesses[0];
  remarks.guesses.clear();
  const Dump same = read_dump(paths[0]);
  for (const std::string& path : paths) write_dump(path, same.info, same.texels, Existing::replace);
  EXPECT_EQ(group_sequences(paths, {}, &remarks).size(), 1U);
  ASSERT_EQ(remarks.guesses.size(), 1U);
  EXPECT_NE(remarks.guesses[0].find("taken for those of frames; --stills"), std::string::npos);
}

// Patterns of many stars take no longer than others.
TEST(Sequence, PatternsOfManyStars) {
  const std::string name = std::string(240, 'a') + "1.exr";
  std::string pattern;
  for (int i = 0; i < 100; ++i) pattern += "*a";
  EXPECT_EQ(group_sequences({name}, {.patterns = {pattern + "*#"}})[0].names.digits, 1U);
  EXPECT_THROW((void)group_sequences({name}, {.patterns = {pattern + "*b#"}}), Error);
}

TEST(Sequence, LinksToNothingAreLeftOut) {
  const TemporaryDirectory directory;
  std::ofstream(directory.path("a.exr")) << "x";
  std::error_code error;
  std::filesystem::create_symlink("nowhere", directory.path("b.exr"), error);
#if defined(_WIN32)
  if (error) GTEST_SKIP() << "no links: " << error.message();
#endif
  ASSERT_FALSE(error) << error.message();
  SequenceRemarks remarks;
  EXPECT_EQ(group_sequences({directory.path("")}, {}, &remarks).size(), 1U);
  ASSERT_EQ(remarks.left_out.size(), 1U);
  EXPECT_NE(remarks.left_out[0].find("leaves out b.exr (a link to nothing), which is no dump"),
            std::string::npos)
      << remarks.left_out[0];
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
