// Dumps that encode must refuse: exit code 3, a message that says where, nothing left behind.
#include "tools/cli_support.h"

#include <gtest/gtest.h>

#include <cstring>

namespace gicodec::tools {
namespace {

class CliBadDump : public testing::Test {
 protected:
  void SetUp() override { program_.make_dumps(3); }
  void expect_refused(const std::vector<std::string>& parts,
                      const std::vector<std::string>& extra = {}) {
    std::vector<std::string> arguments = {"encode", "-o", "x.gic", "in"};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    program_.expect_failure(Exit::bad_input, arguments, parts);
  }
  void rewrite(const char* name, const Dump& dump) {
    write_dump(program_.path(name), dump.info, dump.texels, Existing::replace);
  }

  Program program_;
};

TEST_F(CliBadDump, Truncated) {
  const std::string path = program_.path("in/vis.0001.exr");
  const auto bytes = file_bytes(path);
  for (std::size_t i = 0; i < 24; ++i) {
    write_bytes(path, std::span(bytes).first(bytes.size() * i / 24));
    expect_refused({"vis.0001.exr"});
  }
  write_bytes(path, std::span(bytes).first(bytes.size() - 1));
  expect_refused({"vis.0001.exr"});
}

// A damaged frame late in the sequence is found while the output is being written.
TEST_F(CliBadDump, DamagedTexels) {
  const std::string path = program_.path("in/color.0002.exr");
  auto bytes = file_bytes(path);
  std::memset(&bytes[bytes.size() - 300], 0x5A, 200);
  write_bytes(path, bytes);
  expect_refused({"color.0002.exr"});
}

TEST_F(CliBadDump, NoCode) {
  Dump dump = read_dump(program_.path("in/color.0002.exr"));
  // A colour file whose texels are read as 10-bit codes, but hold arbitrary halves.
  const TextureDesc halves = probe_texture(Format::R16G16B16A16_SFLOAT, kColourDesc.grid, 8);
  Dump wrong{make_info(halves),
             std::vector<std::byte>(static_cast<std::size_t>(texture_bytes(halves)))};
  wrong.info.attributes = dump.info.attributes;
  const std::size_t texel = 13 * std::size_t{image_extent(halves).width} + 44;
  const std::uint16_t nan = 0x7E00;
  std::memcpy(&wrong.texels[8 * texel + 2], &nan, 2);
  rewrite("in/color.0002.exr", wrong);
  for (const char* frame : {"in/color.0000.exr", "in/color.0001.exr"}) {
    Dump alpha = random_dump(kColourDesc, 9);
    rewrite(frame, alpha);
  }
  expect_refused({"color.0002.exr", "channel G", "texel (44, 13)", "probe 12 (0, 1, 1)", "nan"});
}

TEST_F(CliBadDump, OtherShape) {
  rewrite("in/vis.0001.exr", random_dump(ddgi_visibility({4, 2, 2}), 1));
  expect_refused({"vis.0001.exr", "another shape", "4x2x2", "4x2x3"});
}

TEST_F(CliBadDump, OtherChannels) {
  rewrite("in/color.0001.exr", random_dump(kColourDesc, 1));
  expect_refused({"color.0001.exr", "other channels"});
}

TEST_F(CliBadDump, MissingFrame) {
  std::filesystem::remove(program_.path("in/vis.0001.exr"));
  expect_refused({"frame 1 of texture vis", "vis.0001.exr"});
  program_.succeed({"encode", "-o", "x.gic", "--allow-gaps", "in"});
  program_.succeed({"verify", "x.gic", "in"});
}

TEST_F(CliBadDump, SameFrameTwice) {
  std::filesystem::create_directories(program_.path("more"));
  std::filesystem::copy(program_.path("in/vis.0001.exr"), program_.path("more/vis.0001.exr"));
  expect_refused({"in/vis.0001.exr", "more/vis.0001.exr", "frame 1"}, {"more/vis.0001.exr"});
}

TEST_F(CliBadDump, GridMismatch) {
  expect_refused({"color.0000.exr", "does not match grid 4x4x4"}, {"--grid", "4x4x4"});
  expect_refused({"color.0000.exr", "multiple of its 9x9"}, {"--core", "color=7"});
}

TEST_F(CliBadDump, NoSuchFile) {
  program_.expect_failure(Exit::io, {"encode", "-o", "x.gic", "absent.0000.exr"},
                          {"absent.0000.exr", "does not exist"});
}

TEST_F(CliBadDump, Usage) {
  program_.expect_failure(Exit::usage, {}, {"subcommand"});
  program_.expect_failure(Exit::usage, {"encode", "in"}, {"--output"});
  program_.expect_failure(Exit::usage, {"frobnicate"}, {"frobnicate"});
  program_.expect_failure(Exit::usage, {"encode", "-o", "x.gic", "--backend", "best", "in"},
                          {"best"});
  program_.expect_failure(Exit::usage, {"encode", "-o", "x.gic", "--level", "99", "in"}, {"99"});
  program_.expect_failure(Exit::usage, {"encode", "-o", "x.gic", "--grid", "4x", "in"}, {"4x"});
  program_.expect_failure(Exit::usage, {"encode", "-o", "x.gic", "--tiling", "color=x", "in"},
                          {"x"});
  program_.expect_failure(Exit::usage, {"compare", "in", "in/vis.0000.exr"}, {"two"});
}

}  // namespace
}  // namespace gicodec::tools
