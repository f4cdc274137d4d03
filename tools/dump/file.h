// Files that appear complete or not at all, and what they may take the place of.
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

/// What may happen to a regular file of the output's name, also to one that appears while the
/// output is being made. Empty files hold nothing and always go; devices and pipes are written to.
enum class Existing : std::uint8_t {
  replace,    ///< it goes
  refuse,     ///< an Error that names --overwrite
  container,  ///< only a .gic container goes
};
/// The choice that a flag --overwrite makes.
[[nodiscard]] constexpr Existing overwrite_if(bool overwrite) noexcept {
  return overwrite ? Existing::replace : Existing::refuse;
}

/// Files that no output may take the place of, whatever names and links lead to them.
class InputFiles {
 public:
  InputFiles() = default;
  explicit InputFiles(const std::vector<std::string>& paths) {
    for (const std::string& path : paths) add(path);
  }
  /// Files that cannot be looked at, devices and pipes are no one's input.
  void add(const std::string& path);
  [[nodiscard]] bool contains(const std::string& path) const;

 private:
  std::set<std::pair<std::uint64_t, std::uint64_t>> files_;  ///< device, inode
};

/// Throws Error of Exit::io if there is no file, folder or device of that name.
void require_exists(const std::string& path);

/// Throws unless an output of that name destroys nothing: Exit::usage for an input and for a
/// terminal, Exit::io for a file that `existing` keeps. "-" is standard output.
void check_output(const std::string& path, const InputFiles& inputs, Existing existing);
/// True for a regular file that begins as .gic containers do.
[[nodiscard]] bool is_container_file(const std::string& path);
/// True if what is written to `path` ("-": standard output) and standard error end up in one place.
[[nodiscard]] bool shares_standard_error(const std::string& path);

/// Where the caller closed standard input, output or error, a file or socket opened later would get
/// its number, and what was meant for it. Takes the number; reading or writing there fails.
void keep_standard_numbers() noexcept;
/// At a program's end: throws Error of Exit::io with the reason unless all that was printed has
/// been written. A reader that has read enough, as in "gicodec info x.gic | head", is no error.
void finish_standard_output();

/// Writes next to `path` and renames on commit(); without commit() nothing is left behind. Devices
/// and pipes are written directly; "-" is standard output. Every failure is an Error of Exit::io.
class AtomicFile {
 public:
  enum class Temporary : std::uint8_t {
    hidden,   ///< of a name of its own
    partial,  ///< PATH.partial, for what is worth keeping if the program is killed. One that is
              ///< left over, or that another program writes, is an Error of Exit::io
  };
  explicit AtomicFile(std::string path, Existing existing = Existing::refuse,
                      Temporary temporary = Temporary::hidden);
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile();

  /// For writing; belongs to this object.
  [[nodiscard]] std::FILE* stream() noexcept { return stream_; }
  void write(std::span<const std::byte> bytes);
  /// Flushes, syncs, and gives the file its name. To be called at most once.
  void commit();
  /// Instead of commit(): what was written stays under the temporary name, which is returned; empty
  /// if there is none. To be called at most once.
  [[nodiscard]] std::string leave() noexcept { return std::exchange(temporary_, {}); }

 private:
  [[noreturn]] void fail_errno(const char* what) const;
  void open_temporary(Temporary temporary);
  /// Whether the temporary name still is that of the file that was opened.
  [[nodiscard]] bool owns_name() const;

  std::string path_;       ///< as given, for messages
  std::string target_;     ///< with symbolic links resolved
  std::string temporary_;  ///< empty if written directly
  Existing existing_;
  bool kept_ = false;  ///< Temporary::partial
  std::FILE* stream_ = nullptr;
};

/// Throws Error of Exit::usage if `path` is a file whose first bytes (64 at most) are not those of
/// such a report, so that none takes the place of anything else.
void check_report(const std::string& path, bool (*is_report)(std::string_view head));

/// AtomicFile with one write.
void write_file(const std::string& path, std::span<const std::byte> bytes,
                Existing existing = Existing::refuse);
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
