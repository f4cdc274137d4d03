// Output that cannot be written: exit code 4 and nothing partial.
#include "dump/file.h"
#include "tools/cli_support.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

namespace gicodec::tools {
namespace {

class CliOutput : public testing::Test {
 protected:
  void SetUp() override {
    program_.make_dumps(2);
    program_.succeed({"encode", "-o", "x.gic", "in"});
  }
  Program program_;
};

TEST_F(CliOutput, FullDevice) {
  program_.expect_failure(Exit::io, {"encode", "-o", "/dev/full", "in"}, {"/dev/full", "No space"});
  program_.expect_failure(Exit::io, {"preview", "x.gic", "-o", "/dev/full"}, {"/dev/full"});
  struct stat device {};
  ASSERT_EQ(stat("/dev/full", &device), 0);
  EXPECT_TRUE(S_ISCHR(device.st_mode)) << "the device was replaced by a file";
}

TEST_F(CliOutput, NoSuchFolder) {
  program_.expect_failure(Exit::io, {"encode", "-o", "none/x.gic", "in"}, {"none/x.gic"});
  program_.expect_failure(Exit::io, {"decode", "x.gic", "-o", "x.gic"}, {"x.gic"});
  program_.expect_failure(Exit::io, {"decode", "x.gic", "-o", "/proc/none"}, {"/proc/none"});
  program_.expect_failure(Exit::io, {"encode", "-o", "in", "in"}, {"is a directory"});
}

TEST_F(CliOutput, Unwritable) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  std::filesystem::create_directories(program_.path("locked"));
  ASSERT_EQ(chmod(program_.path("locked").c_str(), 0500), 0);
  program_.expect_failure(Exit::io, {"encode", "-o", "locked/x.gic", "in"}, {"locked/x.gic"});
  program_.expect_failure(Exit::io, {"decode", "x.gic", "-o", "locked"}, {"locked"});
}

TEST_F(CliOutput, FailureKeepsTheOldFile) {
  const auto before = file_bytes(program_.path("x.gic"));
  std::filesystem::resize_file(program_.path("in/vis.0001.exr"), 2000);
  program_.expect_failure(Exit::bad_input, {"encode", "-o", "x.gic", "in"}, {"vis.0001.exr"});
  EXPECT_EQ(file_bytes(program_.path("x.gic")), before);
}

TEST_F(CliOutput, LinksAreFollowed) {
  std::filesystem::create_symlink("x.gic", program_.path("link.gic"));
  program_.succeed({"encode", "-o", "link.gic", "--backend", "raw", "in"});
  EXPECT_TRUE(std::filesystem::is_symlink(program_.path("link.gic")));
  program_.succeed({"verify", "x.gic", "in"});
}

TEST_F(CliOutput, QuietIsQuiet) {
  const Outcome outcome = program_.succeed({"encode", "-q", "-o", "x.gic", "in"});
  EXPECT_EQ(outcome.out + outcome.err, "");
}

TEST(AtomicFile, NothingWithoutCommit) {
  const TemporaryDirectory directory;
  {
    AtomicFile file(directory.path("x"));
    file.write(std::as_bytes(std::span("abc")));
    EXPECT_EQ(directory.files().size(), 1U);
  }
  EXPECT_TRUE(directory.files().empty());
}

TEST(AtomicFile, ModeFollowsTheMask) {
  const TemporaryDirectory directory;
  const mode_t mask = umask(027);
  write_file(directory.path("x"), {});
  umask(mask);
  struct stat file {};
  ASSERT_EQ(stat(directory.path("x").c_str(), &file), 0);
  EXPECT_EQ(file.st_mode & 0777U, 0640U);
}

}  // namespace
}  // namespace gicodec::tools
