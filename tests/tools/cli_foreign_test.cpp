// Files that are no containers and no dumps, under any name: the exit codes of gicodec(1), and
// nothing that a terminal would obey.
#include "container_support.h"
#include "dump/text.h"
#include "tools/cli_support.h"

#include <gicodec/gicodec.h>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace gicodec::tools {
namespace {

namespace fs = std::filesystem;

/// Escape, a control sequence introducer in UTF-8 and a byte that is none.
const std::string kName = "n\x1b[31m\xc2\x9b\xff";
const std::string kShown = "n\\x1b[31m\\xc2\\x9b\\xff";

class CliForeign : public testing::Test {
 protected:
  void SetUp() override {
    program_.make_dumps(1);
    program_.succeed({"encode", "-o", "x.gic", "in"});
  }
  void write(const std::string& name, std::string_view content) const {
    write_bytes(program_.path(name), std::as_bytes(std::span(content)));
  }
  Outcome run(const std::vector<std::string>& arguments, Exit exit) const {
    Outcome outcome = program_.run(arguments);
    const std::string line = fmt::format("{}", fmt::join(arguments, " "));
    EXPECT_EQ(outcome.exit, static_cast<int>(exit)) << printable(line) << outcome.err;
    for (std::string text : {outcome.out, outcome.err}) {
      std::erase(text, '\n');
      EXPECT_EQ(printable(text), text) << printable(line);
    }
    return outcome;
  }

  Program program_;
};

TEST_F(CliForeign, ContentsOfAllKinds) {
  using namespace std::string_literals;
  const std::vector<std::string> contents = {""s,
                                             "a text\n"s,
                                             "\x7f"
                                             "ELF\2\1\1"s +
                                                 std::string(100, '\0'),
                                             "\x1f\x8b\x08\0\0\0\0\0"s,
                                             "GIF89a\1\0\1\0\0\0\0"s,
                                             "\x76\x2f\x31\x01\2\0\0\0"s,
                                             "\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR"s,
                                             "II*\0\x08\0\0\0"s,
                                             "SDPX"s + std::string(40, '\xff'),
                                             "\x89GIC\r\n\x1a\n"s,
                                             "\x89GIC\r\n\x1a\n\1\0\0\0\1\xff\xff\xff\xff\x7f"s,
                                             std::string(5000, '\x1b')};
  const std::vector<std::string> endings = {".exr", ".png", ".tif", ".dpx", ""};
  std::size_t next = 0;
  for (const std::string& content : contents) {
    const std::string container = kName + ".gic";
    write(container, content);
    for (const std::vector<std::string>& command :
         std::vector<std::vector<std::string>>{{"info", container},
                                               {"info", container, "--format", "json"},
                                               {"verify", container, "in"},
                                               {"decode", container, "-o", "out"},
                                               {"preview", container, "-o", "a.png"}}) {
      EXPECT_NE(run(command, Exit::bad_input).err.find(kShown), std::string::npos) << command[0];
    }
    // Each parser once, with its own beginning or another's.
    const std::string image = kName + endings[next++ % endings.size()];
    write(image, content);
    for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
             {"compare", image, image},
             {"encode", "-o", "y.gic", image},
             {"crop", "--origin", "0,0,0", "--size", "1x1x1", "-o", "out", image}}) {
      EXPECT_NE(run(command, Exit::bad_input).err.find(kShown), std::string::npos) << command[0];
    }
    fs::remove(program_.path(image));
  }
  EXPECT_EQ(program_.files(), (std::vector<std::string>{kName + ".gic", "x.gic"}));
}

TEST_F(CliForeign, NamesThatNothingReads) {
  for (const char* ending :
       {".gif", ".jpg", ".bmp", ".tga", ".jp2", ".webp", ".hdr", ".svg", ".mp4"}) {
    const std::string image = kName + ending;
    fs::copy_file(program_.path("in/color.0000.exr"), program_.path(image));
    EXPECT_NE(
        run({"encode", "-o", "y.gic", image}, Exit::bad_input).err.find("is named like no image"),
        std::string::npos);
    run({"compare", image, image}, Exit::bad_input);
  }
}

TEST_F(CliForeign, WhatIsNotThere) {
  const std::string none = kName + ".gic", image = kName + ".exr";
  for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
           {"info", none},
           {"verify", none, "in"},
           {"decode", none, "-o", "out"},
           {"preview", image, "-o", "a.png"},
           {"compare", image, image},
           {"encode", "-o", "y.gic", image},
           {"encode", "-o", "y.gic", "--inactive", image, "in"},
           {"encode", "-o", none + "/y.gic", "in"},
           {"crop", "--origin", "0,0,0", "--size", "1x1x1", "-o", "out", image}}) {
    EXPECT_NE(run(command, Exit::io).err.find(kShown), std::string::npos) << command[0];
  }
}

// Whole ones, under such names.
TEST_F(CliForeign, JsonIsJson) {
  fs::copy_file(program_.path("x.gic"), program_.path(kName + ".gic"));
  fs::rename(program_.path("in"), program_.path(kName));
  const auto json_of = [&](const std::vector<std::string>& arguments, Exit exit) {
    const auto json = nlohmann::json::parse(run(arguments, exit).out, nullptr, false);
    EXPECT_FALSE(json.is_discarded()) << arguments[0];
    return json;
  };
  const std::string in_json = "n\x1b[31m\xc2\x9b\\xff";  // as a reader of JSON gets it
  EXPECT_EQ(json_of({"info", kName + ".gic", "--format", "json"}, Exit::ok)["file"],
            in_json + ".gic");
  const auto verified = json_of({"verify", kName + ".gic", kName, "--format", "json"}, Exit::ok);
  EXPECT_EQ(verified["findings"][0]["file"], in_json + "/color.0000.exr");
  const auto compared =
      json_of({"compare", kName + "/color.0000.exr", kName + "/color.0000.exr", "--format", "json"},
              Exit::ok);
  EXPECT_EQ(compared["left"], in_json + "/color.0000.exr");
}

// The longest that a file may have, and one more byte.
TEST_F(CliForeign, LongNames) {
  const std::string longest = std::string(255 - 9, 'x');
  fs::copy_file(program_.path("in/color.0000.exr"), program_.path(longest + ".0000.exr"));
  program_.succeed({"encode", "-o", "y.gic", longest + ".0000.exr"});
  program_.succeed({"decode", "y.gic", "-o", "out"});
  EXPECT_EQ(file_bytes(program_.path("out/" + longest + ".0000.exr")),
            file_bytes(program_.path("in/color.0000.exr")));
  program_.succeed(
      {"crop", "--origin", "0,0,0", "--size", "1x1x1", "-o", "small", longest + ".0000.exr"});
  program_.succeed({"preview", "x.gic", "-o", std::string(251, 'p') + ".png"});
}

TEST_F(CliForeign, FilesWithoutNumbersHaveOneFrame) {
  std::FILE* file = std::fopen(program_.path("y.gic").c_str(), "wb");
  ASSERT_NE(file, nullptr);
  FileSink sink(file);
  const test::ProbeTexture texture{"t", kVisDesc, {{"digits", "0"}}};
  auto writer = ContainerWriter::create(sink, test::probe_description({&texture, 1}));
  auto encoder = Encoder::create(kVisDesc);
  const auto texels = random_texels(kVisDesc, 1);
  for (std::uint64_t frame = 0; frame < 5; ++frame) {
    ASSERT_EQ(writer->add(frame, *encoder->encode(ConstTextureView(texels))), Status::ok);
  }
  ASSERT_EQ(writer->finish(), Status::ok);
  std::fclose(file);
  for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"--overwrite"}}) {
    std::vector<std::string> arguments{"decode", "y.gic", "-o", "out"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run(arguments, Exit::bad_input);
    EXPECT_NE(outcome.err.find("--frames 1 gives that one alone"), std::string::npos)
        << outcome.err;
    EXPECT_NE(outcome.err.find("1 file was written"), std::string::npos) << outcome.err;
    fs::remove_all(program_.path("out"));
  }
  program_.succeed({"decode", "y.gic", "-o", "out", "--frames", "3"});
  EXPECT_EQ(program_.files("out"), std::vector<std::string>{"t.exr"});
}

}  // namespace
}  // namespace gicodec::tools
