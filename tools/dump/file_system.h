// What the tools ask of the operating system about files: file_system_posix.cpp and
// file_system_windows.cpp answer. Paths are UTF-8. Functions that fail set errno.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gicodec::tools {

#if defined(_WIN32)
inline constexpr bool kWindows = true;
#else
inline constexpr bool kWindows = false;
#endif

/// Closes a file, but not standard input.
struct CloseFile {
  void operator()(std::FILE* file) const noexcept {
    if (file != stdin) std::fclose(file);
  }
};
using OwnedFile = std::unique_ptr<std::FILE, CloseFile>;

/// A path for the standard library.
[[nodiscard]] std::filesystem::path native_path(std::string_view path);
/// Back.
[[nodiscard]] std::string path_text(const std::filesystem::path& path);

/// A name as the file system compares it with others.
[[nodiscard]] std::string folded(const std::string& name);

/// The reason of an errno, for messages.
[[nodiscard]] std::string reason(int error);
/// True of the errno of writing to standard output after its reader ended: "gicodec info | head".
[[nodiscard]] bool reader_ended(int error);

struct FileState {
  enum class Kind : std::uint8_t { regular, directory, link, character, other };

  [[nodiscard]] bool same_file(const FileState& other) const noexcept {
    return identity == other.identity && identity != std::pair<std::uint64_t, std::uint64_t>{};
  }

  Kind kind = Kind::other;
  std::uint64_t size = 0;
  std::pair<std::uint64_t, std::uint64_t> identity;  ///< device, number on it; 0, 0: not known
};
/// The file that a link leads to, whether there is one or not.
[[nodiscard]] std::string resolved(const std::string& link);
enum class Links : std::uint8_t { follow, show };
/// nullopt if nothing has that name or it cannot be examined.
[[nodiscard]] std::optional<FileState> state_of(const char* path, Links links = Links::follow);
[[nodiscard]] std::optional<FileState> state_of(std::FILE* file);
/// Bytes of a regular file; nullopt if there is none of that name.
[[nodiscard]] inline std::optional<std::uint64_t> size_of_file(const std::string& path) {
  const auto state = state_of(path.c_str());
  if (!state || state->kind != FileState::Kind::regular) return std::nullopt;
  return state->size;
}

/// The names of what a folder holds; nullopt if it cannot be listed.
[[nodiscard]] std::optional<std::vector<std::string>> names_in(const std::string& folder);
[[nodiscard]] bool is_readable(const std::string& path);
/// Whether people read what is written there.
[[nodiscard]] bool is_terminal(const std::string& path);
[[nodiscard]] bool is_terminal(std::FILE* stream);

/// Opens for reading; nullptr on failure.
[[nodiscard]] std::FILE* open_input(const std::string& path);
/// The first bytes of a file, which stays open where it is; how many there were, nullopt on
/// failure.
[[nodiscard]] std::optional<std::size_t> read_head(std::FILE* file, std::span<char> into);
/// Opens a device or pipe for writing.
[[nodiscard]] std::FILE* open_device(const std::string& path);
/// Makes a file that did not exist, for writing. `like`: a file whose owner and mode it gets, if
/// there is one.
[[nodiscard]] std::FILE* create_file(const std::string& path, const std::string& like);
/// Opens or makes a file for reading and writing, locked until it is closed or the program ends. On
/// failure errno is EWOULDBLOCK if another program has locked it.
[[nodiscard]] std::FILE* open_locked(const std::string& path, const std::string& like);

/// What is read next begins there; false on failure.
[[nodiscard]] bool seek_file(std::FILE* file, std::uint64_t offset);
/// Writes all that the stream holds to the disk; false on failure.
[[nodiscard]] bool sync_file(std::FILE* file);
/// Renames a file that may be open, at once; what has the new name is replaced, unless `replace` is
/// false: errno is EEXIST.
[[nodiscard]] bool rename_file(const std::string& from, const std::string& to, bool replace);
/// Allocates nothing.
void remove_file(const char* path) noexcept;

/// To be called first. Occupies the descriptors of standard input, output and error if the caller
/// closed them; reading or writing them fails. Otherwise a file or socket opened later would get
/// the number, and the data meant for the stream. On Windows bytes pass as they are, text is UTF-8.
void prepare_standard_streams() noexcept;

}  // namespace gicodec::tools
