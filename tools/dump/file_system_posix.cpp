#include "dump/file_system.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

namespace gicodec::tools {
namespace {

constexpr mode_t kMode = 0666;  // less the umask

FileState state_from(const struct stat& file) {
  FileState state;
  state.identity = {file.st_dev, file.st_ino};
  state.size = static_cast<std::uint64_t>(file.st_size);
  using enum FileState::Kind;
  state.kind = S_ISREG(file.st_mode)   ? regular
               : S_ISDIR(file.st_mode) ? directory
               : S_ISLNK(file.st_mode) ? link
               : S_ISCHR(file.st_mode) ? character
                                       : other;
  return state;
}

/// Gives a file the owner and mode of the one that it is to replace.
void keep_mode(int descriptor, const std::string& like) {
  struct stat old {};
  if (stat(like.c_str(), &old) != 0 || !S_ISREG(old.st_mode)) return;
  const bool owned = fchown(descriptor, old.st_uid, old.st_gid) == 0 || old.st_uid == geteuid();
  if (owned) static_cast<void>(fchmod(descriptor, old.st_mode & 0777));
}

std::FILE* stream_of(int descriptor, const char* mode) {
  std::FILE* const stream = fdopen(descriptor, mode);
  if (stream != nullptr) return stream;
  const int code = errno;
  close(descriptor);
  errno = code;
  return nullptr;
}

/// Makes a new name survive a crash of the machine, if the file system can.
void sync_directory(const std::filesystem::path& directory) {
  const int file =
      open(directory.empty() ? "." : directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return;
  (void)fsync(file);
  close(file);
}

/// The same of a file that is of no use without.
std::FILE* new_stream_of(int descriptor, const char* mode, const std::string& path) {
  std::FILE* const stream = stream_of(descriptor, mode);
  const int code = errno;
  if (stream == nullptr) unlink(path.c_str());
  errno = code;
  return stream;
}

bool rename_new(const char* from, const char* to) {
#if defined(__linux__)
  if (renameat2(AT_FDCWD, from, AT_FDCWD, to, RENAME_NOREPLACE) == 0) return true;
  if (errno != EINVAL && errno != ENOSYS) return false;
#endif
  // File systems without such a call.
  struct stat file {};
  if (lstat(to, &file) == 0) {
    errno = EEXIST;
    return false;
  }
  return std::rename(from, to) == 0;
}

}  // namespace

std::filesystem::path native_path(std::string_view path) { return path; }
std::string path_text(const std::filesystem::path& path) { return path.string(); }

std::string folded(const std::string& name) { return name; }

std::string reason(int error) { return std::strerror(error); }

bool reader_ended(int error) { return error == EPIPE; }

std::string resolved(const std::string& link) {
  std::error_code error;
  return std::filesystem::weakly_canonical(link, error);
}

std::optional<FileState> state_of(const char* path, Links links) {
  struct stat file {};
  if ((links == Links::follow ? stat(path, &file) : lstat(path, &file)) != 0) return std::nullopt;
  return state_from(file);
}

std::optional<FileState> state_of(std::FILE* file) {
  struct stat state {};
  if (fstat(fileno(file), &state) != 0) return std::nullopt;
  return state_from(state);
}

std::optional<std::vector<std::string>> names_in(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    names.push_back(entry.path().filename());
  }
  if (!error) return names;
  errno = error.value();
  return std::nullopt;
}

bool is_readable(const std::string& path) { return access(path.c_str(), R_OK) == 0; }

bool is_terminal(const std::string& path) {
  const auto state = state_of(path.c_str());
  if (!state || state->kind != FileState::Kind::character) return false;
  const int file = open(path.c_str(), O_WRONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return false;
  const bool terminal = isatty(file) != 0;
  close(file);
  return terminal;
}

bool is_terminal(std::FILE* stream) { return isatty(fileno(stream)) != 0; }

std::FILE* open_input(const std::string& path) { return std::fopen(path.c_str(), "rbe"); }

std::optional<std::size_t> read_head(std::FILE* file, std::span<char> into) {
  const ssize_t size = pread(fileno(file), into.data(), into.size(), 0);
  if (size < 0) return std::nullopt;
  return static_cast<std::size_t>(size);
}

std::FILE* open_device(const std::string& path) { return std::fopen(path.c_str(), "wbe"); }

std::FILE* create_file(const std::string& path, const std::string& like) {
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kMode);
  if (file < 0) return nullptr;
  keep_mode(file, like);
  return new_stream_of(file, "wb", path);
}

std::FILE* open_locked(const std::string& path, const std::string& like) {
  for (;;) {
    const int file = open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, kMode);
    if (file < 0) return nullptr;
    if (flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      close(file);
      errno = EWOULDBLOCK;
      return nullptr;
    }
    struct stat opened {
    }, named{};
    if (fstat(file, &opened) != 0 || stat(path.c_str(), &named) != 0 ||
        opened.st_dev != named.st_dev || opened.st_ino != named.st_ino) {
      close(file);  // its writer has just renamed it
      continue;
    }
    if (!S_ISREG(opened.st_mode) || opened.st_size > 0) return stream_of(file, "r+b");
    keep_mode(file, like);
    return new_stream_of(file, "r+b", path);
  }
}

bool seek_file(std::FILE* file, std::uint64_t offset) {
  return fseeko(file, static_cast<off_t>(offset), SEEK_SET) == 0;
}

bool sync_file(std::FILE* file) { return std::fflush(file) == 0 && fsync(fileno(file)) == 0; }

bool rename_file(const std::string& from, const std::string& to, bool replace) {
  if (replace ? std::rename(from.c_str(), to.c_str()) != 0 : !rename_new(from.c_str(), to.c_str()))
    return false;
  sync_directory(std::filesystem::path(to).parent_path());
  return true;
}

void remove_file(const char* path) noexcept { unlink(path); }

void prepare_standard_streams() noexcept {
  for (int number = STDIN_FILENO; number <= STDERR_FILENO; ++number) {
    if (fcntl(number, F_GETFD) >= 0) continue;
    static_cast<void>(open("/dev/null", number == STDIN_FILENO ? O_WRONLY : O_RDONLY));
  }
}

}  // namespace gicodec::tools
