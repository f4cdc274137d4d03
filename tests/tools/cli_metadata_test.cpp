// Attributes of any length, and those that change from frame to frame, through the command line.
#include "dump/dump.h"
#include "tools/cli_support.h"
#include "tools/dump_support.h"

#include <gicodec/textures.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace gicodec::tools {
namespace {

class CliMetadata : public testing::Test {
 protected:
  CliMetadata() { std::filesystem::create_directories(program_.path("in")); }

  void write(const std::string& name, const std::string& value) {
    Dump dump = random_dump(map_texture(Format::R16_SFLOAT, {3, 2, 1}, {8, 8, 1}), 1);
    set_attribute(dump.info.attributes, {"manifest", "string", value});
    write_dump(program_.path("in/" + name), dump.info, dump.texels);
  }
  void expect_all_back(const std::string& container) {
    program_.succeed({"decode", container, "-o", "out"});
    for (const std::string& name : program_.files("in")) {
      EXPECT_EQ(file_bytes(program_.path("out/" + name)), file_bytes(program_.path("in/" + name)))
          << name;
    }
    const auto verified = program_.succeed({"verify", container, "in"});
    EXPECT_NE(verified.out.find("are bit-exact"), std::string::npos) << verified.out;
  }

  Program program_;
};

TEST_F(CliMetadata, ManifestsOfMegabytesThatDifferByFrame) {
  for (int frame = 0; frame < 6; ++frame) {
    write(fmt::format("a.{:04}.exr", frame),
          fmt::format("{{\"object {}\":\"{}\"}}", frame, std::string(1'300'000, 'm')));
  }
  write("b.exr", std::string(2'000'000, 'b'));
  program_.succeed({"encode", "-o", "x.gic", "in"});
  EXPECT_LT(std::filesystem::file_size(program_.path("x.gic")), 10'000U);
  expect_all_back("x.gic");
  const auto shown = program_.succeed({"info", "--metadata", "x.gic"});
  EXPECT_NE(shown.out.find("attribute@5:manifest = string {\"object 5\""), std::string::npos);
  const std::vector<std::string> json = {"info", "--format", "json", "x.gic"};
  EXPECT_EQ(program_.succeed(json).out.find("attribute@5"), std::string::npos);
  EXPECT_NE(
      program_.succeed({"info", "--format", "json", "--metadata", "x.gic"}).out.find("attribute@5"),
      std::string::npos);
}

TEST_F(CliMetadata, ManySmallAttributesLeaveTheDescriptionSmall) {
  Dump dump = random_dump(map_texture(Format::R16_SFLOAT, {3, 2, 1}, {8, 8, 1}), 1);
  for (int i = 0; i < 1000; ++i) {
    set_attribute(dump.info.attributes,
                  {fmt::format("attribute number {}", i), "string", std::string(900, 'v')});
  }
  for (const char* name : {"in/a.exr", "in/b.exr"}) {
    write_dump(program_.path(name), dump.info, dump.texels);
  }
  program_.succeed({"encode", "-o", "x.gic", "in"});
  expect_all_back("x.gic");
}

TEST_F(CliMetadata, DamageIsNamed) {
  write("a.exr", std::string(5000, 'm'));
  program_.succeed({"encode", "-o", "x.gic", "in"});
  auto bytes = file_bytes(program_.path("x.gic"));
  constexpr std::array frame{std::byte{0x28}, std::byte{0xB5}, std::byte{0x2F}, std::byte{0xFD}};
  const auto at =
      std::search(bytes.begin(), bytes.end(), frame.begin(), frame.end());  // Zstandard's
  ASSERT_LT(at, bytes.end() - 8);
  at[8] ^= std::byte{1};
  write_bytes(program_.path("y.gic"), bytes);
  for (const char* command : {"verify", "info"}) {
    program_.expect_failure(Exit::bad_input, {command, "y.gic"},
                            {"metadata of texture a", "checksum"});
  }
  program_.expect_failure(Exit::bad_input, {"decode", "y.gic", "-o", "out"},
                          {"metadata of texture a", "checksum", "--allow-incomplete"});
  const auto decoded = program_.succeed({"decode", "y.gic", "-o", "out", "--allow-incomplete"});
  EXPECT_NE(decoded.err.find("its files lack it"), std::string::npos) << decoded.err;
  EXPECT_EQ(read_dump(program_.path("out/a.exr")).texels,
            read_dump(program_.path("in/a.exr")).texels);
}

}  // namespace
}  // namespace gicodec::tools
