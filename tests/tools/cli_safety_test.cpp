// No command takes the place of a file that the user may need.
#include "tools/cli_support.h"

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <string_view>

namespace gicodec::tools {
namespace {

namespace fs = std::filesystem;

class CliSafety : public testing::Test {
 protected:
  void SetUp() override {
    dumps_ = program_.make_dumps(2);
    program_.succeed({"encode", "-o", "x.gic", "in"});
  }
  /// The command is refused, and every file stays what it is.
  void expect_refused(Exit exit, const std::vector<std::string>& arguments,
                      const std::vector<std::string>& parts) const {
    const auto before = contents();
    program_.expect_failure(exit, arguments, parts);
    EXPECT_EQ(contents(), before);
  }
  [[nodiscard]] std::map<std::string, std::vector<std::byte>> contents() const {
    std::map<std::string, std::vector<std::byte>> all;
    for (const auto& entry : fs::recursive_directory_iterator(program_.path(""))) {
      if (entry.is_regular_file()) all[entry.path()] = file_bytes(entry.path());
    }
    return all;
  }
  void write(const std::string& name, std::string_view text) const {
    write_bytes(program_.path(name), std::as_bytes(std::span(text)));
  }

  Program program_;
  std::vector<std::string> dumps_;
};

TEST_F(CliSafety, EncodeDoesNotTakeADumpForItsOutput) {
  expect_refused(Exit::io, {"encode", "-o", dumps_[0], dumps_[1], dumps_[2], dumps_[3]},
                 {"color.0000.exr", "is no .gic container", "-o x.gic"});
  write("notes.txt", "important");
  expect_refused(Exit::io, {"encode", "-o", "notes.txt", "in"}, {"notes.txt", "remove it first"});
  program_.succeed({"encode", "-o", "x.gic", "--backend", "raw", "in"});
  write("empty", "");
  program_.succeed({"encode", "-o", "empty", "in"});
  program_.succeed({"encode", "-o", "/dev/null", "in"});
}

TEST_F(CliSafety, EncodeKeepsItsInputs) {
  fs::create_symlink("in/color.0000.exr", program_.path("link.gic"));
  fs::create_hard_link(dumps_[1], program_.path("hard.gic"));
  expect_refused(Exit::io, {"encode", "-o", "link.gic", "in"}, {"link.gic"});
  expect_refused(Exit::io, {"encode", "-o", "hard.gic", "in"}, {"hard.gic"});
  write("list",
        "\x89GIC\r\n\x1a\n"
        "");
  expect_refused(Exit::usage, {"encode", "-o", "list", "--inactive", "list", "in"},
                 {"list", "one of the inputs"});
}

TEST_F(CliSafety, DecodeReplacesOnlyWhenTold) {
  program_.succeed({"decode", "x.gic", "-o", "out"});
  expect_refused(Exit::io, {"decode", "x.gic", "-o", "out"}, {"0000.exr", "--overwrite"});
  write("out/color.0001.exr", "something else");
  program_.succeed({"decode", "x.gic", "-o", "out", "--overwrite"});
  program_.succeed({"compare", "in", "out"});
}

TEST_F(CliSafety, FilesDoNotGoToStandardOutput) {
  expect_refused(Exit::usage, {"decode", "x.gic", "-o", "-"}, {"./- names such a folder"});
  program_.succeed({"decode", "x.gic", "-o", "./-"});
  EXPECT_EQ(program_.files("-").size(), 4U);
}

TEST_F(CliSafety, DecodeKeepsWhatIsNoFile) {
  program_.succeed({"encode", "-o", "y.gic", dumps_[0]});
  const std::string file = fs::path(dumps_[0]).filename(), path = "out/" + file;
  fs::create_directories(program_.path("out"));
  fs::create_symlink("nowhere", program_.path(path));
  expect_refused(Exit::io, {"decode", "y.gic", "-o", "out"}, {file, "a link to nothing"});
  EXPECT_TRUE(fs::is_symlink(program_.path(path)));
  fs::remove(program_.path(path));
  // What a link leads to may be an original.
  fs::create_symlink("../in/" + file, program_.path(path));
  expect_refused(Exit::io, {"decode", "y.gic", "-o", "out", "--overwrite"}, {file, "a link"});
  fs::remove(program_.path(path));
  ASSERT_EQ(mkfifo(program_.path(path).c_str(), 0600), 0);
  expect_refused(Exit::io, {"decode", "y.gic", "-o", "out"}, {"in the way", "no regular file"});
}

TEST_F(CliSafety, DecodeKeepsTheContainer) {
  fs::create_directories(program_.path("out"));
  fs::create_hard_link(program_.path("x.gic"), program_.path("out/vis.0001.exr"));
  fs::create_symlink("../x.gic", program_.path("out/color.0001.exr"));
  const auto before = file_bytes(program_.path("x.gic"));
  const Outcome outcome = program_.run({"decode", "x.gic", "-o", "out", "--overwrite"});
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_NE(outcome.err.find("one of the inputs"), std::string::npos) << outcome.err;
  EXPECT_EQ(file_bytes(program_.path("x.gic")), before);
  EXPECT_EQ(file_bytes(program_.path("out/vis.0001.exr")), before);
}

TEST_F(CliSafety, DecodeKeepsWhatTheContainerLacks) {
  write("inactive.txt", "3 5-7");
  program_.succeed({"encode", "-o", "part.gic", "--inactive", "inactive.txt", "in"});
  expect_refused(Exit::io, {"decode", "part.gic", "-o", "in", "--overwrite"},
                 {"may be the original", "4 inactive probes", "another folder"});
  // A file that cannot be read may be one as well.
  fs::copy(program_.path("in"), program_.path("damaged"));
  fs::resize_file(program_.path("damaged/color.0000.exr"), 500);
  expect_refused(Exit::io, {"decode", "part.gic", "-o", "damaged", "--overwrite"},
                 {"may be the original", "it cannot be compared"});
  // A result of its own is replaced all the same.
  program_.succeed({"decode", "part.gic", "-o", "out"});
  program_.succeed({"decode", "part.gic", "-o", "out", "--overwrite"});
}

TEST_F(CliSafety, DecodeKeepsAContainerNamedLikeASidecar) {
  program_.succeed({"decode", "x.gic", "-o", "raw", "--files", "raw"});
  fs::copy_file(program_.path("x.gic"), program_.path("raw/vis.0001.json"),
                fs::copy_options::overwrite_existing);
  fs::remove(program_.path("raw/color.0000.raw"));
  const auto container = file_bytes(program_.path("x.gic"));
  const Outcome outcome =
      program_.run({"decode", "raw/vis.0001.json", "-o", "raw", "--files", "raw", "--overwrite"});
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_NE(outcome.err.find("one of the inputs"), std::string::npos) << outcome.err;
  EXPECT_EQ(file_bytes(program_.path("raw/vis.0001.json")), container);
}

TEST_F(CliSafety, CropReplacesOnlyWhenToldAndNeverItsInputs) {
  const std::vector<std::string> crop = {"crop", "--origin", "0,0,0", "--size", "2x2x2", "-o"};
  const auto with = [&](std::vector<std::string> rest) {
    rest.insert(rest.begin(), crop.begin(), crop.end());
    return rest;
  };
  expect_refused(Exit::usage, with({"in", "in", "--overwrite"}), {"one of the inputs"});
  // The first frames could be written; the last one is an input by another name.
  fs::create_directories(program_.path("small"));
  fs::create_hard_link(dumps_[3], program_.path("small/vis.0001.exr"));
  expect_refused(Exit::usage, with({"small", "in", "--overwrite"}), {"one of the inputs"});
  EXPECT_EQ(program_.files("small").size(), 1U);
  fs::remove(program_.path("small/vis.0001.exr"));
  write("small/vis.0001.exr", "something else");
  expect_refused(Exit::io, with({"small", "in"}), {"small/vis.0001.exr", "--overwrite"});
  program_.succeed(with({"small", "in", "--overwrite"}));
}

TEST_F(CliSafety, PreviewReplacesOnlyWhenTold) {
  program_.succeed({"preview", "x.gic", "-o", "a.png"});
  expect_refused(Exit::io, {"preview", "x.gic", "-o", "a.png"}, {"a.png", "--overwrite"});
  program_.succeed({"preview", "x.gic", "-o", "a.png", "--overwrite"});
  fs::create_hard_link(program_.path("x.gic"), program_.path("x.png"));
  expect_refused(Exit::usage, {"preview", "x.gic", "-o", "x.png", "--overwrite"},
                 {"one of the inputs"});
}

TEST_F(CliSafety, IncompleteContainersAreRefused) {
  const auto bytes = file_bytes(program_.path("x.gic"));
  write_bytes(program_.path("cut.gic"), std::span(bytes).first(end_of_packets(bytes) - 1));
  const std::string missing =
      "its end is missing (cut off, or still being written): it holds frames 0-1 of frames 0-1, "
      "and of frame 1 only color";
  expect_refused(Exit::bad_input, {"preview", "cut.gic", "--frame", "0", "-o", "a.png"},
                 {"cut.gic", missing, "--allow-incomplete"});
  program_.succeed({"preview", "cut.gic", "--allow-incomplete", "-o", "a.png"});
  for (const std::vector<std::string>& command : {std::vector<std::string>{"info", "cut.gic"},
                                                  {"verify", "cut.gic", "in"},
                                                  {"decode", "cut.gic", "-o", "out"}}) {
    const Outcome outcome = program_.run(command);
    EXPECT_EQ(outcome.exit, 3);
    EXPECT_NE(outcome.err.find(missing), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(program_.files("out").size(), 3U);
  const Outcome pipe =
      program_.run({"preview", "-", "--frame", "1", "-o", "b.png"}, program_.path("cut.gic"));
  EXPECT_EQ(pipe.exit, 3) << pipe.err;
}

TEST_F(CliSafety, FramePatternsComeBack) {
  fs::create_directories(program_.path("names"));
  for (const std::string& dump : dumps_) {
    std::string name = fs::path(dump).filename();
    name.replace(name.find('.'), 1, name[0] == 'c' ? "_" : "");
    fs::copy(dump, program_.path("names/" + name));
  }
  const Outcome encoded = program_.succeed({"encode", "-o", "names.gic", "names"});
  EXPECT_NE(encoded.err.find("2 textures, 2 frames"), std::string::npos) << encoded.err;
  program_.succeed({"verify", "names.gic", "names"});
  program_.succeed({"decode", "names.gic", "-o", "out"});
  EXPECT_EQ(program_.files("out"), program_.files("names"));
}

TEST_F(CliSafety, ManyTexturesOfOneFrameAreQuestioned) {
  fs::create_directories(program_.path("odd"));
  for (int i = 0; i < 3; ++i) {
    fs::copy(dumps_[0], program_.path(fmt::format("odd/{}_color.exr", i)));
  }
  const Outcome outcome = program_.succeed({"encode", "-o", "odd.gic", "odd"});
  EXPECT_NE(outcome.err.find("3 textures of one frame differ only in a number"), std::string::npos)
      << outcome.err;
  EXPECT_NE(outcome.err.find("NAME.FFFF.exr"), std::string::npos);
}

}  // namespace
}  // namespace gicodec::tools
