// Files that appear complete or not at all.
#pragma once

#include <cstddef>
#include <cstdio>
#include <span>
#include <string>

namespace gicodec::tools {

/// Writes next to `path` and renames on commit(); without commit() nothing is left behind. Devices
/// and pipes are written directly; "-" is standard output. Every failure is an Error of Exit::io.
class AtomicFile {
 public:
  explicit AtomicFile(std::string path);
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile();

  /// For writing; belongs to this object.
  [[nodiscard]] std::FILE* stream() noexcept { return stream_; }
  void write(std::span<const std::byte> bytes);
  /// Flushes, syncs, and gives the file its name. To be called at most once.
  void commit();

 private:
  [[noreturn]] void fail_errno(const char* what) const;

  std::string path_;       ///< as given, for messages
  std::string target_;     ///< with symbolic links resolved
  std::string temporary_;  ///< empty if written directly
  std::FILE* stream_ = nullptr;
};

/// AtomicFile with one write.
void write_file(const std::string& path, std::span<const std::byte> bytes);
/// Makes a directory and its parents; Error of Exit::io if that fails or `path` is something else.
void make_directory(const std::string& path);

/// make_directory() for results: one that was made here and is left empty goes again.
class OutputDirectory {
 public:
  explicit OutputDirectory(std::string path);
  OutputDirectory(const OutputDirectory&) = delete;
  OutputDirectory& operator=(const OutputDirectory&) = delete;
  ~OutputDirectory();

 private:
  std::string path_;
  bool made_ = false;
};

}  // namespace gicodec::tools
