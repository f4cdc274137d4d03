// Files on Windows: names, what other programs have open, what is read-only, sizes beyond 32 bits.
#include "dump/error.h"
#include "dump/file.h"
#include "tools/dump_support.h"

#include <gicodec/io.h>

#include <windows.h>

#include <gtest/gtest.h>

#include <cerrno>
#include <filesystem>
#include <string>

namespace gicodec::tools {
namespace {

namespace fs = std::filesystem;

const auto kText = std::as_bytes(std::span("some text"));
const auto kOther = std::as_bytes(std::span("other text"));

/// The message of an Error; empty if there is none.
template <typename Call>
std::string message_of(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::io);
    return error.what();
  }
  return {};
}

bool holds(const std::string& path, std::span<const std::byte> bytes) {
  const auto found = file_bytes(path);
  return std::equal(found.begin(), found.end(), bytes.begin(), bytes.end());
}

TEST(FileWindows, PathsAreUtf8) {
  const TemporaryDirectory directory;
  const std::string name = "gr\u00F6\u00DFe \u65E5\u672C \U0001F30D.gic";
  const std::string path = directory.path(name);
  write_file(path, kText);
  EXPECT_EQ(directory.files(), std::vector{name});
  EXPECT_TRUE(fs::exists(native_path(path)));
  EXPECT_EQ(path_text(native_path(path)), path);
  EXPECT_TRUE(holds(path, kText));
  EXPECT_FALSE(state_of("not \xFF text"));
}

TEST(FileWindows, LongPaths) {
  if (!long_paths()) GTEST_SKIP() << "the system allows no long paths";
  const TemporaryDirectory directory;
  std::string folder = directory.path("f");
  while (folder.size() < 600) folder += "/" + std::string(100, 'f');
  fs::create_directories(native_path(folder));
  const std::string path = folder + "/x.gic";
  write_file(path, kText);
  write_file(path, kOther, Existing::replace);
  EXPECT_TRUE(holds(path, kOther));
  EXPECT_EQ(message_of([&] { require_exists(path); }), "");
  remove_file(path.c_str());
  EXPECT_FALSE(state_of(path.c_str()));
}

TEST(FileWindows, FormsOfPaths) {
  const TemporaryDirectory directory;
  const std::string path = directory.path("x");
  write_file(path, kText);
  const std::string slashes = path_text(fs::absolute(native_path(path)));
  ASSERT_EQ(slashes[1], ':');
  std::string whole = slashes;
  for (char& c : whole) c = c == '/' ? '\\' : c;
  const InputFiles inputs({path});
  for (const std::string& form : {whole, slashes, "\\\\?\\" + whole}) {
    EXPECT_TRUE(state_of(form.c_str())) << form;
    EXPECT_TRUE(inputs.contains(form)) << form;
  }
  EXPECT_EQ(path_text(native_path("\\\\server\\share\\x")), "//server/share/x");
}

TEST(FileWindows, WhatAnotherProgramHasOpenStays) {
  const TemporaryDirectory directory;
  const std::string path = directory.path("x");
  write_file(path, kText);
  const HANDLE reader = CreateFileW(native_path(path).c_str(), GENERIC_READ, FILE_SHARE_READ,
                                    nullptr, OPEN_EXISTING, 0, nullptr);
  ASSERT_NE(reader, INVALID_HANDLE_VALUE);
  const auto message = message_of([&] { write_file(path, kOther, Existing::replace); });
  CloseHandle(reader);
  EXPECT_NE(message.find("another program has it open; close it"), std::string::npos) << message;
  EXPECT_EQ(directory.files(), std::vector<std::string>{"x"});
  EXPECT_TRUE(holds(path, kText));
  write_file(path, kOther, Existing::replace);
  EXPECT_TRUE(holds(path, kOther));
}

TEST(FileWindows, ReadOnlyFilesStay) {
  const TemporaryDirectory directory;
  const std::string path = directory.path("x");
  write_file(path, kText);
  SetFileAttributesW(native_path(path).c_str(), FILE_ATTRIBUTE_READONLY);
  const auto message = message_of([&] { write_file(path, kOther, Existing::replace); });
  SetFileAttributesW(native_path(path).c_str(), FILE_ATTRIBUTE_NORMAL);
  EXPECT_NE(message.find("read-only; remove that attribute"), std::string::npos) << message;
  EXPECT_EQ(directory.files(), std::vector<std::string>{"x"});
  EXPECT_TRUE(holds(path, kText));
}

TEST(FileWindows, OneWriterOfAPartialFile) {
  const TemporaryDirectory directory;
  const std::string path = directory.path("x.gic");
  AtomicFile first(path, Existing::refuse, AtomicFile::Temporary::partial);
  first.write(
      std::as_bytes(std::span("\x89GIC\r\n\x1a\n"
                              "")));
  first.sync();
  const auto message = message_of(
      [&] { AtomicFile second(path, Existing::refuse, AtomicFile::Temporary::partial); });
  EXPECT_NE(message.find("another program is writing it"), std::string::npos) << message;
  std::FILE* const reader = open_input(path + ".partial");
  EXPECT_NE(reader, nullptr) << "others may read what is there";
  if (reader != nullptr) std::fclose(reader);
  first.commit();
  EXPECT_EQ(directory.files(), std::vector<std::string>{"x.gic"});
}

TEST(FileWindows, NothingIsReplacedInTheEnd) {
  const TemporaryDirectory directory;
  const std::string path = directory.path("x");
  {
    AtomicFile file(path);
    file.write(kText);
    write_bytes(path, kOther);
    EXPECT_NE(message_of([&] { file.commit(); }), "");
  }
  EXPECT_TRUE(holds(path, kOther));
  EXPECT_EQ(directory.files(), std::vector<std::string>{"x"});
}

TEST(FileWindows, DevicesAreWrittenTo) {
  write_file("NUL", kText);
  const auto state = state_of("NUL");
  ASSERT_TRUE(state);
  EXPECT_EQ(state->kind, FileState::Kind::character);
  EXPECT_FALSE(is_terminal("NUL"));
}

// Bytes are bytes: no end of line is added, no 0x1A ends a file.
TEST(FileWindows, NoFileIsText) {
  const TemporaryDirectory directory;
  const auto bytes = std::as_bytes(std::span("a\n\r\n\x1A z\n"));
  write_file(directory.path("x"), bytes);
  EXPECT_TRUE(holds(directory.path("x"), bytes));
  std::FILE* const file = open_input(directory.path("x"));
  ASSERT_NE(file, nullptr);
  FileSource source(file);
  EXPECT_EQ(source.size(), std::optional<std::uint64_t>(bytes.size()));
  std::fclose(file);
}

TEST(FileWindows, FilesBeyondFourGibibytes) {
  const TemporaryDirectory directory;
  const std::string path = directory.path("large");
  constexpr std::uint64_t kFar = (std::uint64_t{5} << 30) + 3;
  std::FILE* const file = create_file(path, path);
  ASSERT_NE(file, nullptr);
  DWORD size = 0;
  const HANDLE handle = CreateFileW(native_path(path).c_str(), FILE_WRITE_ATTRIBUTES, 7, nullptr,
                                    OPEN_EXISTING, 0, nullptr);
  DeviceIoControl(handle, FSCTL_SET_SPARSE, nullptr, 0, nullptr, 0, &size, nullptr);
  CloseHandle(handle);
  ASSERT_TRUE(seek_file(file, kFar));
  FileSink sink(file);
  ASSERT_EQ(sink.write(kText), Status::ok);
  EXPECT_EQ(state_of(file)->size, kFar + kText.size());
  std::FILE* const reading = open_input(path);
  ASSERT_NE(reading, nullptr);
  FileSource source(reading);
  EXPECT_EQ(source.size(), std::optional(kFar + kText.size()));
  ASSERT_EQ(source.seek(kFar), Status::ok);
  std::vector<std::byte> found(kText.size());
  EXPECT_EQ(source.read(found).value_or(0), found.size());
  EXPECT_TRUE(std::equal(found.begin(), found.end(), kText.begin()));
  std::fclose(reading);
  std::fclose(file);
}

}  // namespace
}  // namespace gicodec::tools
