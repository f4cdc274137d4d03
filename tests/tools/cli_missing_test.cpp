// What is not there, or not as meant: messages say what there is, and what to do.
#include "tools/cli_support.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <nlohmann/json.hpp>

#include <fstream>
#include <thread>

namespace gicodec::tools {
namespace {

namespace fs = std::filesystem;

class CliMissing : public testing::Test {
 protected:
  void SetUp() override {
    program_.make_dumps(4);
    program_.succeed({"encode", "-o", "x.gic", "in"});
  }
  Program program_;
};

TEST_F(CliMissing, DumpsToVerify) {
  for (const char* name : {"none", "none/", "none.0000.exr", "in/color.0099.exr"}) {
    program_.expect_failure(Exit::io, {"verify", "x.gic", name}, {name, "does not exist"});
  }
}

TEST_F(CliMissing, TexturesAndFrames) {
  program_.expect_failure(Exit::bad_input, {"preview", "x.gic", "--texture", "foo", "-o", "a.png"},
                          {"has no texture foo, only color, vis"});
  program_.expect_failure(Exit::bad_input, {"preview", "x.gic", "--frame", "77", "-o", "a.png"},
                          {"has no frame 77 of texture color; it holds frames 0-3"});
  program_.expect_failure(Exit::bad_input, {"decode", "x.gic", "--frames", "100-", "-o", "out"},
                          {"has no frame in 100-; it holds frames 0-3"});
  const Outcome pipe =
      program_.run({"preview", "-", "--frame", "77", "-o", "a.png"}, program_.path("x.gic"));
  EXPECT_NE(pipe.err.find("it holds frames 0-3"), std::string::npos) << pipe.err;

  // A frame that one texture lacks, behind a keyframe where the search enters.
  fs::remove(program_.path("in/color.0002.exr"));
  program_.succeed({"encode", "--allow-gaps", "--gop", "1", "-o", "gaps.gic", "in"});
  program_.expect_failure(Exit::bad_input, {"preview", "gaps.gic", "--frame", "2", "-o", "a.png"},
                          {"has no frame 2 of texture color; it holds frames 0-3, 3 of them"});
  fs::remove(program_.path("in/vis.0002.exr"));
  program_.succeed({"encode", "--allow-gaps", "-o", "gaps.gic", "in"});
  program_.expect_failure(Exit::bad_input, {"decode", "gaps.gic", "--frames", "2", "-o", "out"},
                          {"has no frame in 2; it holds frames 0-3, 3 of them"});
  // Between two frames, of which the second would be found: from a file, and from a pipe.
  fs::remove(program_.path("a.png"));
  program_.expect_failure(Exit::bad_input, {"preview", "gaps.gic", "--frame", "2", "-o", "a.png"},
                          {"has no frame 2 of texture color; it holds frames 0-3, 3 of them"});
  const Outcome gaps =
      program_.run({"preview", "-", "--frame", "2", "-o", "a.png"}, program_.path("gaps.gic"));
  EXPECT_EQ(gaps.exit, static_cast<int>(Exit::bad_input));
  EXPECT_NE(gaps.err.find("it holds frames 0-3, 3 of them"), std::string::npos) << gaps.err;
  EXPECT_FALSE(fs::exists(program_.path("a.png")));
}

TEST_F(CliMissing, ContainersThatAreNone) {
  write_bytes(program_.path("text.gic"), std::as_bytes(std::span(std::string_view("a text"))));
  write_bytes(program_.path("empty.gic"), {});
  const auto crop = [](const char* file) {
    return std::vector<std::string>{"crop",  "--origin", "0,0,0", "--size",
                                    "1x1x1", "-o",       "c",     file};
  };
  program_.expect_failure(Exit::io, {"preview", "nope.gic", "-o", "a.png"},
                          {"nope.gic: cannot be opened"});
  program_.expect_failure(Exit::io, {"compare", "nope.gic", "in"}, {"nope.gic", "does not exist"});
  program_.expect_failure(Exit::io, crop("nope.gic"), {"nope.gic", "does not exist"});
  program_.expect_failure(Exit::bad_input, {"preview", "text.gic", "-o", "a.png"},
                          {"text.gic: is not a .gic container"});
  program_.expect_failure(Exit::bad_input, {"compare", "text.gic", "in/vis.0000.exr"},
                          {"text.gic: is not a .gic container"});
  program_.expect_failure(Exit::bad_input, crop("text.gic"), {"is not a .gic container"});
  for (const char* command : {"info", "verify"}) {
    program_.expect_failure(Exit::bad_input, {command, "empty.gic"},
                            {"empty.gic: is empty", "before its first packet"});
  }
}

TEST_F(CliMissing, NumbersThatAreNone) {
  for (const char* frame : {"-1", "1.5", "0x1", "18446744073709551616", ""}) {
    const std::vector<std::string> arguments = {"--frame", frame, "-o", "a.png"};
    std::vector<std::string> preview = {"preview", "x.gic"};
    preview.insert(preview.end(), arguments.begin(), arguments.end());
    program_.expect_failure(Exit::usage, preview, {"--frame", frame});
#ifdef DDGI_RENDER
    std::vector<std::string> render = {"--stream", "x.gic"};
    render.insert(render.end(), arguments.begin(), arguments.end());
    const Outcome drawn = program_.run_in({.program = DDGI_RENDER, .kill_when = {}}, render);
    EXPECT_EQ(drawn.exit, static_cast<int>(Exit::usage)) << frame << drawn.err;
#endif
  }
  program_.succeed({"preview", "x.gic", "--frame", "0003", "-o", "a.png"});
  for (const char* flag : {"--gop", "--level", "--threads"}) {
    program_.expect_failure(Exit::usage, {"encode", "-o", "y.gic", flag, "-1", "in"}, {flag, "-1"});
  }
}

TEST_F(CliMissing, FoldersOfTheSameNames) {
  fs::copy(program_.path("in"), program_.path("other"));
  program_.expect_failure(
      Exit::bad_input, {"encode", "-o", "y.gic", "in", "other"},
      {"are both frame 0 of texture", "rename one of them, or give one folder at a time"});
  fs::create_directories(program_.path("renamed"));
  for (const char* frame : {"0000", "0001", "0002", "0003"}) {
    fs::copy(program_.path(fmt::format("in/vis.{}.exr", frame)),
             program_.path(fmt::format("renamed/far.{}.exr", frame)));
  }
  const Outcome encoded = program_.succeed({"encode", "-o", "y.gic", "in", "renamed"});
  EXPECT_NE(encoded.err.find("y.gic: 1 volume of 3 textures, 4 frames"), std::string::npos)
      << encoded.err;
}

TEST_F(CliMissing, WhoeverReadsNoFurther) {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"info", "x.gic"},
                                                    {"info", "x.gic", "--format", "json"},
                                                    {"verify", "x.gic", "in"},
                                                    {"backends"}}) {
    const Outcome outcome = program_.run_in({.unread = true, .kill_when = {}}, arguments);
    EXPECT_EQ(outcome.exit, 0) << arguments[0];
    EXPECT_EQ(outcome.err, "");
  }
  const Outcome different =
      program_.run_in({.unread = true, .kill_when = {}}, {"verify", "x.gic", "in/vis.0000.exr"});
  EXPECT_EQ(different.exit, static_cast<int>(Exit::different)) << different.err;
}

TEST_F(CliMissing, RoomForTheOutput) {
  // More than a buffer holds fails while it is printed, less at the end.
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"info", "x.gic"}, {"info", "x.gic", "--format", "json"}}) {
    const Outcome outcome = program_.run_in({.output = "/dev/full", .kill_when = {}}, arguments);
    EXPECT_EQ(outcome.exit, static_cast<int>(Exit::io));
    EXPECT_NE(outcome.err.find("standard output: cannot be written: No space left on device"),
              std::string::npos)
        << outcome.err;
  }
}

// What comes through a pipe has no size beforehand.
TEST_F(CliMissing, SizeOfAPipe) {
  const std::string pipe = program_.path("pipe");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  for (const char* format : {"text", "json"}) {
    std::thread writer([&] {
      const auto bytes = file_bytes(program_.path("x.gic"));
      std::ofstream(pipe, std::ios::binary)
          .write(reinterpret_cast<const char*>(bytes.data()),
                 static_cast<std::streamsize>(bytes.size()));
    });
    std::string piped = program_.run({"info", "-", "--format", format}, pipe).out;
    writer.join();
    const std::string name = "standard input";
    ASSERT_NE(piped.find(name), std::string::npos);
    piped.replace(piped.find(name), name.size(), "x.gic");
    EXPECT_EQ(piped, program_.succeed({"info", "x.gic", "--format", format}).out);
  }
}

class CliPlaces : public testing::Test {
 protected:
  void write(const std::string& name, unsigned frame, const TextureDesc& desc,
             const std::string& origin, const std::string& spacing) {
    Dump dump = random_dump(desc, frame);
    if (!origin.empty()) set_attribute(dump.info.attributes, {kOriginAttribute, "v3f", origin});
    if (!spacing.empty()) set_attribute(dump.info.attributes, {kSpacingAttribute, "v3f", spacing});
    fs::create_directories(program_.path("in"));
    write_dump(program_.path(fmt::format("in/{}.{:04}.exr", name, frame)), dump.info, dump.texels,
               Existing::replace);
  }
  nlohmann::json volumes() {
    program_.succeed({"encode", "-o", "x.gic", "in"});
    fs::remove_all(program_.path("out"));
    program_.succeed({"decode", "x.gic", "-o", "out"});
    for (const std::string& name : program_.files("in")) {
      EXPECT_EQ(file_bytes(program_.path("out/" + name)), file_bytes(program_.path("in/" + name)));
    }
    return nlohmann::json::parse(
        program_.succeed({"info", "x.gic", "--format", "json"}).out)["volumes"];
  }
  Program program_;
};

TEST_F(CliPlaces, VolumesStandWhereAllTheirDumpsSay) {
  const TextureDesc wide = ddgi_visibility({5, 2, 3});
  for (unsigned frame = 0; frame < 2; ++frame) {
    write("color", frame, kColourDesc, "-1 0.1 2", "0.5 1.5 2");
    write("vis", frame, kVisDesc, "-1 0.1 2", "0.5 1.5 2");
    write("wide", frame, wide, "7 8 9", "");
  }
  auto found = volumes();
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0]["geometry"]["origin"], (std::vector<float>{-1, 0.1F, 2}));
  EXPECT_EQ(found[0]["geometry"]["spacing"], (std::vector<float>{0.5F, 1.5F, 2}));
  EXPECT_EQ(found[0]["geometry"]["scroll"], (std::vector<int>{0, 0, 0}));
  EXPECT_EQ(found[1]["geometry"], nullptr) << "no spacing is told";
  program_.succeed(
      {"crop", "--origin", "1,0,2", "--size", "2x1x1", "-o", "box", "in/vis.0000.exr"});
  program_.succeed({"encode", "-o", "box.gic", "box"});
  const auto box = nlohmann::json::parse(
      program_.succeed({"info", "box.gic", "--format", "json"}).out)["volumes"][0];
  EXPECT_EQ(box["geometry"]["origin"], (std::vector<float>{-0.5F, 0.1F, 6}));

  write("vis", 1, kVisDesc, "-1 0.1 3", "0.5 1.5 2");
  EXPECT_EQ(volumes()[0]["geometry"], nullptr) << "a frame says otherwise";
  for (unsigned frame = 0; frame < 2; ++frame) write("vis", frame, kVisDesc, "", "");
  EXPECT_EQ(volumes()[0]["geometry"], nullptr) << "a texture does not say";
  for (unsigned frame = 0; frame < 2; ++frame) write("wide", frame, wide, "7 8 9", "1 -1 1");
  EXPECT_EQ(volumes()[1]["geometry"], nullptr) << "that is no spacing";
}

}  // namespace
}  // namespace gicodec::tools
