// Files that appear whole, and text that is safe to show. This program's own fsync() and umask()
// stand in front of the C library's, so that it sees them being called.
#include "dump/file.h"

#include "dump/error.h"
#include "dump/text.h"
#include "tools/dump_support.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <string>

namespace {
std::atomic<int> umask_calls = 0;
std::string synced;
}  // namespace

extern "C" int fsync(int file) {
  struct stat found {};
  fstat(file, &found);
  synced += S_ISDIR(found.st_mode) ? 'd' : 'f';
  return static_cast<int>(syscall(SYS_fsync, file));
}
extern "C" mode_t umask(mode_t mask) noexcept {
  ++umask_calls;
  return static_cast<mode_t>(syscall(SYS_umask, mask));
}

namespace gicodec::tools {
namespace {

namespace fs = std::filesystem;

const auto kText = std::as_bytes(std::span("some text"));

std::optional<Exit> refusal(const std::string& path, const InputFiles& inputs, Existing existing) {
  try {
    check_output(path, inputs, existing);
  } catch (const Error& error) {
    return error.code();
  }
  return std::nullopt;
}

TEST(File, ContentsThenNameReachTheDisk) {
  const TemporaryDirectory directory;
  synced.clear();
  write_file(directory.path("x"), kText);
  EXPECT_EQ(synced, "fd");
}

// Setting the mask and setting it back would give other threads' files the wrong mode.
TEST(File, TheMaskIsLeftAlone) {
  const TemporaryDirectory directory;
  const mode_t mask = umask(027);
  umask_calls = 0;
  write_file(directory.path("x"), kText);
  EXPECT_EQ(umask_calls, 0);
  umask(mask);
  struct stat file {};
  ASSERT_EQ(stat(directory.path("x").c_str(), &file), 0);
  EXPECT_EQ(file.st_mode & 0777U, 0640U);
}

TEST(File, OutputsThatWouldDestroySomething) {
  const TemporaryDirectory directory;
  const std::string file = directory.path("file"), empty = directory.path("empty");
  const std::string container = directory.path("x.gic"), link = directory.path("link");
  write_file(file, kText);
  write_file(empty, {});
  write_file(container, std::as_bytes(std::span("\x89GIC\r\n\x1a\n"
                                                "")));
  fs::create_symlink("file", link);
  EXPECT_EQ(refusal(file, {}, Existing::refuse), Exit::io);
  EXPECT_EQ(refusal(link, {}, Existing::refuse), Exit::io);
  EXPECT_EQ(refusal(file, {}, Existing::container), Exit::io);
  EXPECT_EQ(refusal(container, {}, Existing::container), std::nullopt);
  EXPECT_EQ(refusal(container, {}, Existing::refuse), Exit::io);
  EXPECT_EQ(refusal(file, {}, Existing::replace), std::nullopt);
  for (const std::string& path : {empty, directory.path("none"), std::string("/dev/null")}) {
    EXPECT_EQ(refusal(path, InputFiles({path}), Existing::refuse),
              path == empty ? std::optional(Exit::usage) : std::nullopt)
        << path;
    EXPECT_EQ(refusal(path, {}, Existing::container), std::nullopt) << path;
  }
  fs::create_hard_link(file, directory.path("hard"));
  for (const char* name : {"file", "link", "hard"}) {
    EXPECT_EQ(refusal(directory.path(name), InputFiles({link}), Existing::replace), Exit::usage);
  }
}

// What appears while the output is being written is kept as well.
TEST(File, NothingIsReplacedInTheEnd) {
  const TemporaryDirectory directory;
  AtomicFile file(directory.path("x"), Existing::refuse);
  file.write(kText);
  write_bytes(directory.path("x"), std::as_bytes(std::span("another's")));
  EXPECT_THROW(file.commit(), Error);
  EXPECT_EQ(file_bytes(directory.path("x")).size(), 10U);
}

TEST(File, OnlyContainersAreReplacedInTheEnd) {
  const TemporaryDirectory directory;
  for (const std::string_view other : {"another's", "",
                                       "\x89GIC\r\n\x1a\n"
                                       ""}) {
    AtomicFile file(directory.path("x"), Existing::container);
    file.write(kText);
    write_bytes(directory.path("x"), std::as_bytes(std::span(other)));
    if (other == "another's") {
      EXPECT_THROW(file.commit(), Error);
    } else {
      file.commit();
    }
    EXPECT_EQ(file_bytes(directory.path("x")).size(),
              other == "another's" ? other.size() : kText.size());
    fs::remove(directory.path("x"));
  }
  EXPECT_TRUE(directory.files().empty());
}

TEST(File, WhatAKilledProgramLeftStays) {
  const TemporaryDirectory directory;
  const std::string left = directory.path("x.gic.partial");
  const auto open = [&] {
    AtomicFile(directory.path("x.gic"), Existing::container, AtomicFile::Temporary::partial);
  };
  for (const std::string_view content : {"\x89GIC\r\n\x1a\n and some frames", "something else"}) {
    write_bytes(left, std::as_bytes(std::span(content)));
    EXPECT_THROW(open(), Error);
    EXPECT_EQ(file_bytes(left).size(), content.size());
  }
  write_bytes(left, {});
  open();
  EXPECT_FALSE(fs::exists(left));
}

// What is replaced hands on its protection.
TEST(File, ModesStay) {
  const TemporaryDirectory directory;
  const std::string path = directory.path("x");
  write_bytes(path, std::as_bytes(std::span("old")));
  fs::permissions(path, fs::perms::owner_read | fs::perms::owner_write);
  write_file(path, {}, Existing::replace);
  EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

// A partial file that another one has taken the place of is not its own any more.
TEST(File, PartialFilesOfOthersStay) {
  const TemporaryDirectory directory;
  const std::string partial = directory.path("x.gic.partial");
  for (const bool commit : {true, false}) {
    {
      AtomicFile file(directory.path("x.gic"), Existing::container, AtomicFile::Temporary::partial);
      fs::remove(partial);
      write_bytes(partial, std::as_bytes(std::span("\x89GIC\r\n\x1a\n of another")));
      if (commit) {
        EXPECT_THROW(file.commit(), Error);
      }
    }
    EXPECT_EQ(directory.files(), std::vector<std::string>{"x.gic.partial"});
    fs::remove(partial);
  }
}

// The work was done, so it stays.
TEST(File, ResultsWithoutAPlaceStayPartial) {
  const TemporaryDirectory directory;
  {
    AtomicFile file(directory.path("x.gic"), Existing::container, AtomicFile::Temporary::partial);
    file.write(kText);
    write_bytes(directory.path("x.gic"), std::as_bytes(std::span("another's")));
    EXPECT_THROW(file.commit(), Error);
  }
  EXPECT_EQ(file_bytes(directory.path("x.gic")).size(), 10U);
  EXPECT_EQ(file_bytes(directory.path("x.gic.partial")).size(), kText.size());
}

// What its descriptor is said to lead to may be the name of another file.
TEST(File, DescriptorsOfRemovedFiles) {
  const TemporaryDirectory directory;
  const std::string path = directory.path("x");
  const int descriptor = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  ASSERT_GE(descriptor, 0);
  fs::remove(path);
  write_bytes(path + " (deleted)", std::as_bytes(std::span("another's")));
  write_file(fmt::format("/proc/self/fd/{}", descriptor), kText);
  struct stat file {};
  ASSERT_EQ(fstat(descriptor, &file), 0);
  close(descriptor);
  EXPECT_EQ(static_cast<std::size_t>(file.st_size), kText.size());
  EXPECT_EQ(file_bytes(path + " (deleted)").size(), 10U);
  EXPECT_EQ(directory.files().size(), 1U);
}

TEST(File, NamesOfGreatestLength) {
  const TemporaryDirectory directory;
  const std::string name(255, 'x');
  write_file(directory.path(name), kText);
  EXPECT_EQ(directory.files(), std::vector<std::string>{name});
}

TEST(Text, EscapesWhatATerminalObeys) {
  EXPECT_EQ(printable("a\x1b[31m\n\x7f"), "a\\x1b[31m\\x0a\\x7f");
  EXPECT_EQ(printable("\xc2\x9b\xe2\x80\xae"), "\\xc2\\x9b\\xe2\\x80\\xae");
  EXPECT_EQ(printable("\xff\xc3(\xe2\x82"), "\\xff\\xc3(\\xe2\\x82");
  EXPECT_EQ(printable("\xed\xa0\x80\xc0\x80\xf4\x90\x80\x80").find_first_not_of("\\xedafc0849"),
            std::string::npos);
  EXPECT_EQ(printable("\xf0\x8f\xbf\xbf"), "\\xf0\\x8f\\xbf\\xbf");  // U+FFFF in four bytes
  const std::string safe = "Z\xc3\xbcrich \xe2\x82\xac \xf0\x9f\x98\x80 \\x1b";
  EXPECT_EQ(printable(safe), safe);
  EXPECT_EQ(printable(std::string("a\0b", 3)), "a\\x00b");
}

TEST(Text, OnlyTheMiddleOfLongMessagesIsCut) {
  const std::string whole = std::string(1200, 'a') + std::string(600, 'b');
  EXPECT_EQ(message(whole), whole);
  EXPECT_EQ(message(std::string(1200, 'a') + "\n" + std::string(600, 'b')),
            std::string(1200, 'a') + " [...] " + std::string(600, 'b'));
}

TEST(Text, ErrorsArePrintable) {
  try {
    fail(Exit::io, "{}: cannot be read",
         "a\x1b"
         "b");
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "a\\x1b"
                 "b: cannot be read");
  }
}

}  // namespace
}  // namespace gicodec::tools
