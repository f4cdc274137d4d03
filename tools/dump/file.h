// Files that appear complete or not at all, and which files they may replace.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gicodec::tools {

/// Whether an output may replace a regular file of its name, also one that appears while the output
/// is made. Empty files are always replaced; devices and pipes are written to.
enum class Existing : std::uint8_t {
  replace,    ///< yes
  refuse,     ///< no: an Error that names --overwrite
  container,  ///< only a .gic container
};
/// The choice by a flag --overwrite.
[[nodiscard]] constexpr Existing overwrite_if(bool overwrite) noexcept {
  return overwrite ? Existing::replace : Existing::refuse;
}

/// Files that no output may replace, through any name or link.
class InputFiles {
 public:
  InputFiles() = default;
  explicit InputFiles(const std::vector<std::string>& paths) {
    for (const std::string& path : paths) add(path);
  }
  /// Adds a file. Ignores devices, pipes, and files that cannot be examined.
  void add(const std::string& path);
  [[nodiscard]] bool contains(const std::string& path) const;

 private:
  std::set<std::pair<std::uint64_t, std::uint64_t>> files_;  ///< device, inode
};

/// Throws Error of Exit::io if what has that name is no regular file.
void require_place(const std::string& path);
/// Throws Error of Exit::io if there is no file, folder or device of that name.
void require_exists(const std::string& path);

/// Throws Error of Exit::io if the folder of a file to write is missing.
void require_folder(const std::string& path);

/// Throws Error unless an output of that name destroys nothing: Exit::usage for an input or a
/// terminal, Exit::io for a file that `existing` protects. "-" is standard output.
void check_output(const std::string& path, const InputFiles& inputs, Existing existing);
/// True for a regular file that begins like a .gic container.
[[nodiscard]] bool is_container_file(const std::string& path);
/// True if `path` ("-": standard output) and standard error are the same file.
[[nodiscard]] bool shares_standard_error(const std::string& path);

/// Call it at a program's end: throws Error of Exit::io unless all printed text was written. A
/// reader that closes early, as in "gicodec info x.gic | head", is no error.
void finish_standard_output();

/// Writes a temporary file beside `path` and renames it on commit(); without commit() nothing
/// remains. Writes devices and pipes directly; "-" is standard output. Throws Error of Exit::io.
class AtomicFile {
 public:
  enum class Temporary : std::uint8_t {
    hidden,   ///< a unique name
    partial,  ///< PATH.partial, which is worth keeping if the program is killed. One that exists,
              ///< or that another program writes, is an Error of Exit::io
    restart,  ///< the same, but replaces what a program that was killed left over
  };
  explicit AtomicFile(std::string path, Existing existing = Existing::refuse,
                      Temporary temporary = Temporary::hidden);
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile();

  /// The stream to write to; this object owns it.
  [[nodiscard]] std::FILE* stream() noexcept { return stream_; }
  void write(std::span<const std::byte> bytes);
  /// Writes all to the disk, so that commit() fails only if the name cannot be had.
  void sync();
  /// Syncs and renames the file. Call it at most once.
  void commit();
  /// Instead of commit(): keeps the temporary file and returns its name; empty if there is none.
  /// Call it at most once.
  [[nodiscard]] std::string leave() noexcept;

 private:
  friend void remove_temporaries() noexcept;
  [[noreturn]] void fail_errno(const char* what) const;
  std::FILE* open_hidden();
  std::FILE* open_partial(bool restart);
  void open_temporary(Temporary temporary);
  void list() noexcept;
  /// True if the temporary name still belongs to the opened file.
  [[nodiscard]] bool owns_name() const;

  std::string path_;       ///< as given, for messages
  std::string target_;     ///< with symbolic links resolved
  std::string temporary_;  ///< empty if written directly
  Existing existing_;
  bool kept_ = false;  ///< Temporary::partial
  std::FILE* stream_ = nullptr;
  AtomicFile* next_ = nullptr;  ///< of all that have a temporary file
};

/// For a program that cannot go on: removes the temporary files of every AtomicFile. Allocates
/// nothing.
void remove_temporaries() noexcept;

/// Throws Error of Exit::usage if `path` is a file that is not such a report, by its first bytes
/// (at most 64), so that a report replaces only reports.
void check_report(const std::string& path, bool (*is_report)(std::string_view head));

/// The bytes of a whole file. Throws Error of Exit::io.
[[nodiscard]] std::string file_contents(const std::string& path);

/// Writes a whole file by AtomicFile.
void write_file(const std::string& path, std::span<const std::byte> bytes,
                Existing existing = Existing::refuse);

}  // namespace gicodec::tools
