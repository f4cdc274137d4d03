// The command line on Windows.
#include "tools/cli_support.h"

#include <windows.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace gicodec::tools {
namespace {

TEST(CliWindows, NamesOfAnyLanguageAndLength) {
  const std::size_t long_name = long_paths() ? 120 : 20;
  const Program program;
  const Arguments dumps = program.make_dumps(2);
  const std::string folder = program.path("\u65E5\u672C/" + std::string(long_name, 'l') + "/" +
                                          std::string(long_name, 'm'));
  program.succeed(Arguments{"encode", "-o", "gr\u00F6\u00DFe.gic"} + dumps);
  program.succeed({"decode", "gr\u00F6\u00DFe.gic", "-o", folder});
  for (const std::string& name : program.files("in")) {
    EXPECT_EQ(file_bytes(folder + "/" + name), file_bytes(program.path("in/" + name))) << name;
  }
  program.succeed({"encode", "-o", program.path("again.gic"), folder});
  program.expect_failure(Exit::io, {"info", "fehlt-\u00E4.gic"},
                         {"fehlt-\u00E4.gic", "cannot be opened"});
}

// What a pipe or a file gets has no end of line of its own.
TEST(CliWindows, BytesPassAsTheyAre) {
  const Program program;
  const Arguments dumps = program.make_dumps(2);
  program.succeed(Arguments{"encode", "-o", "x.gic"} + dumps);
  const Outcome piped = program.succeed(Arguments{"encode", "-o", "-"} + dumps);
  const auto bytes = file_bytes(program.path("x.gic"));
  EXPECT_TRUE(std::ranges::equal(std::as_bytes(std::span(piped.out)), bytes));
  const Outcome read = program.run({"info", "-", "--format", "json"}, program.path("x.gic"));
  EXPECT_EQ(read.exit, 0) << read.err;
  EXPECT_EQ(read.out.find('\r'), std::string::npos);
  EXPECT_TRUE(nlohmann::json::accept(read.out));
}

// No shell stands between that would have done it.
TEST(CliWindows, PatternsAreExpanded) {
  const Program program;
  program.make_dumps(3);
  program.succeed({"encode", "-o", "x.gic", "in/*.exr"});
  EXPECT_NE(program.succeed({"verify", "x.gic", "in"}).out.find("6 of 6 files"), std::string::npos);
}

TEST(CliWindows, SidecarsWithItsEndsOfLines) {
  const Program program;
  const Arguments dumps = program.make_dumps(1);
  program.succeed({"encode", "-o", "x.gic", "in/color.0000.exr"});
  program.succeed({"decode", "x.gic", "-o", "raw", "--files", "raw"});
  const std::string sidecar = program.path("raw/color.0000.json");
  std::string text;
  for (const std::byte byte : file_bytes(sidecar)) {
    if (byte == std::byte{'\n'}) text += '\r';
    text += static_cast<char>(byte);
  }
  ASSERT_NE(text.find('\r'), std::string::npos);
  write_bytes(sidecar, std::as_bytes(std::span(text)));
  program.succeed({"compare", "raw/color.0000.raw", "in/color.0000.exr"});
}

TEST(CliWindows, CtrlBreakLeavesNothing) {
  const Program program;
  const Arguments dumps = program.make_dumps(40);
  Circumstances ended{.kill_when = {}};
  ended.kill_when = [&] {
    const auto files = program.files();
    return std::ranges::any_of(files,
                               [](const std::string& name) { return name.ends_with("partial"); });
  };
  if (GetConsoleCP() == 0 && !AllocConsole()) GTEST_SKIP() << "there is no console";
  const Outcome outcome =
      program.run_in(ended, Arguments{"encode", "-o", "x.gic", "--preset", "strong"} + dumps);
  EXPECT_EQ(static_cast<std::uint32_t>(outcome.exit), 0xC000013AU) << outcome.err;
  EXPECT_EQ(program.files(), Arguments());
}

}  // namespace
}  // namespace gicodec::tools
