#include "dump/file.h"

#include "dump/cure.h"
#include "dump/error.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <random>
#include <system_error>
#include <utility>

namespace gicodec::tools {
namespace {

namespace fs = std::filesystem;

constexpr mode_t kMode = 0666;  // less the umask

struct Descriptor {
  explicit Descriptor(int file) : value(file) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (value >= 0) close(value);
  }
  int value;
};

bool same_file(const struct stat& a, const struct stat& b) {
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

bool holds_something(const struct stat& file) { return S_ISREG(file.st_mode) && file.st_size > 0; }

bool is_container(int descriptor) {
  std::array<unsigned char, 4> magic{};
  return pread(descriptor, magic.data(), magic.size(), 0) == 4 &&
         magic == std::array<unsigned char, 4>{0x89, 'G', 'I', 'C'};
}

/// True unless the output would replace a file that `existing` protects.
bool may_go(const std::string& path, Existing existing) {
  struct stat file {};
  if (existing == Existing::replace) return true;
  if (stat(path.c_str(), &file) != 0) {
    // What a link without a file stands for is not known.
    return lstat(path.c_str(), &file) != 0 || !S_ISLNK(file.st_mode);
  }
  if (!holds_something(file)) return true;
  return existing == Existing::container && is_container_file(path);
}

bool is_terminal(const std::string& path) {
  if (path == "-") return isatty(STDOUT_FILENO) != 0;
  std::error_code error;
  if (!fs::is_character_file(path, error)) return false;
  const Descriptor file(open(path.c_str(), O_WRONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  return file.value >= 0 && isatty(file.value) != 0;
}

/// Opens a new file beside the target. Cuts its name to the longest that a file may have.
int open_hidden(const fs::path& target, std::string& name) {
  constexpr std::size_t kKept = 200;
  std::random_device random;
  for (int attempt = 0; attempt < 100; ++attempt) {
    name = (target.parent_path() /
            fmt::format(".{}.{:08x}", target.filename().string().substr(0, kKept), random()))
               .string();
    const int file = open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kMode);
    if (file >= 0 || errno != EEXIST) return file;
  }
  return -1;
}

/// Gives a file the mode, and the owner if it may, of the one that it will replace.
void keep_mode(int descriptor, const std::string& target) {
  struct stat old {};
  if (stat(target.c_str(), &old) != 0 || !S_ISREG(old.st_mode)) return;
  const bool owned = fchown(descriptor, old.st_uid, old.st_gid) == 0 || old.st_uid == geteuid();
  if (owned) static_cast<void>(fchmod(descriptor, old.st_mode & 0777));
}

/// Opens PATH.partial, empty and locked. The lock ends with the program.
int open_partial(const std::string& name) {
  for (;;) {
    const int file = open(name.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, kMode);
    if (file < 0) return file;
    struct stat opened {
    }, named{};
    const bool locked = flock(file, LOCK_EX | LOCK_NB) == 0;
    if (!locked && errno == EWOULDBLOCK) {
      close(file);
      fail(Exit::io, "{}: another program is writing it", name);
    }
    if (fstat(file, &opened) != 0 || stat(name.c_str(), &named) != 0 || !same_file(opened, named)) {
      close(file);  // its writer has just renamed it
      continue;
    }
    if (S_ISREG(opened.st_mode) && opened.st_size == 0) return file;
    const bool left = S_ISREG(opened.st_mode) && is_container(file);
    close(file);
    if (left) {
      fail(Exit::io,
           "{}: was left over by a program that was killed; \"gicodec decode\" and \"gi-render\" "
           "read what it holds with --allow-incomplete; move or remove it to go on",
           name);
    }
    fail(Exit::io, "{}: is in the way; move it or name another output", name);
  }
}

/// Makes the new name survive a crash of the machine, if the file system can.
void sync_directory(const fs::path& directory) {
  const Descriptor file(
      open(directory.empty() ? "." : directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (file.value >= 0) (void)fsync(file.value);
}

/// Renames, after checking `existing` again: a file may have appeared since the start.
int rename_to(const std::string& from, const std::string& to, Existing existing) {
  if (existing == Existing::replace) return std::rename(from.c_str(), to.c_str());
  const int result = renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE);
  const bool no_such_call = result != 0 && (errno == EINVAL || errno == ENOSYS);
  if (result == 0 || (errno != EEXIST && !no_such_call)) return result;
  if (may_go(to, existing)) return std::rename(from.c_str(), to.c_str());
  errno = EEXIST;
  return -1;
}

[[noreturn]] void fail_existing(const std::string& path, Existing existing) {
  if (access(path.c_str(), R_OK) != 0) {
    const bool nowhere = errno == ENOENT;
    fail(Exit::io, "{}: {}; name another output", path,
         nowhere ? "is a link to nothing"
                 : "exists and cannot be read, so that it is not replaced: permission denied");
  }
  if (existing == Existing::container) {
    fail(Exit::io, "{}: exists and is no .gic container; {}", path, to_cure(Cure::name_container));
  }
  fail(Exit::io, "{}: exists; {}", path, to_cure(Cure::overwrite));
}

}  // namespace

void InputFiles::add(const std::string& path) {
  struct stat file {};
  if (stat(path.c_str(), &file) == 0 && S_ISREG(file.st_mode)) {
    files_.emplace(file.st_dev, file.st_ino);
  }
}

bool InputFiles::contains(const std::string& path) const {
  struct stat file {};
  return stat(path.c_str(), &file) == 0 && files_.count({file.st_dev, file.st_ino}) > 0;
}

void require_folder(const std::string& path) {
  const std::string folder = fs::path(path).parent_path().string();
  std::error_code error;
  if (!folder.empty() && !fs::exists(folder, error) && !error)
    fail(Exit::io, "{}: cannot be written: there is no folder {}; make it first", path, folder);
}

void check_output(const std::string& path, const InputFiles& inputs, Existing existing) {
  if (is_terminal(path)) {
    fail(Exit::usage, "{} is a terminal, and the output is not text; redirect it or name a file",
         path == "-" ? "standard output" : path);
  }
  if (path == "-") return;
  if (inputs.contains(path)) {
    fail(Exit::usage, "{}: is one of the inputs and would be overwritten; name another output",
         path);
  }
  if (!may_go(path, existing)) fail_existing(path, existing);
}

void require_place(const std::string& path) {
  struct stat file {};
  if (lstat(path.c_str(), &file) != 0 || S_ISREG(file.st_mode)) return;
  // What a link leads to may be an original.
  fail(Exit::io, "{}: is in the way and {}; move it or name another output", path,
       S_ISLNK(file.st_mode) ? "a link" : "no regular file");
}

bool is_container_file(const std::string& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return false;
  const Descriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC));
  return file.value >= 0 && is_container(file.value);
}

void require_exists(const std::string& path) {
  std::error_code error;
  if (fs::exists(path, error)) return;
  fail(Exit::io, "{}: {}", path, error ? error.message() : "does not exist");
}

void finish_standard_output() {
  const int flushed = std::fflush(stdout) == 0 ? 0 : errno;
  if (flushed == 0 && std::ferror(stdout) == 0) return;
  const int error = output_error() != 0 ? output_error() : flushed;
  if (error == EPIPE) return;
  fail(Exit::io, "standard output: cannot be written: {}", std::strerror(error));
}

void keep_standard_numbers() noexcept {
  for (int number = STDIN_FILENO; number <= STDERR_FILENO; ++number) {
    if (fcntl(number, F_GETFD) >= 0) continue;
    static_cast<void>(open("/dev/null", number == STDIN_FILENO ? O_WRONLY : O_RDONLY));
  }
}

void check_report(const std::string& path, bool (*is_report)(std::string_view head)) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return;
  std::array<char, 64> head{};
  const Descriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC));
  const ssize_t size = file.value < 0 ? -1 : pread(file.value, head.data(), head.size(), 0);
  if (size == 0 || (size > 0 && is_report({head.data(), static_cast<std::size_t>(size)}))) return;
  fail(Exit::usage, "{}: holds something else and would be overwritten; name another file", path);
}

bool shares_standard_error(const std::string& path) {
  struct stat output {
  }, errors{};
  const int found = path == "-" ? fstat(STDOUT_FILENO, &output) : stat(path.c_str(), &output);
  if (found != 0 || fstat(STDERR_FILENO, &errors) != 0) return false;
  if (S_ISCHR(output.st_mode))
    return false;  // a terminal is refused elsewhere, /dev/null keeps nothing
  return same_file(output, errors);
}

namespace {

/// AtomicFiles with a temporary file.
std::mutex unfinished_mutex;
AtomicFile* unfinished = nullptr;

}  // namespace

void AtomicFile::list() noexcept {
  const std::lock_guard lock(unfinished_mutex);
  next_ = std::exchange(unfinished, this);
}

std::string AtomicFile::leave() noexcept {
  const std::lock_guard lock(unfinished_mutex);
  for (AtomicFile** link = &unfinished; *link != nullptr; link = &(*link)->next_) {
    if (*link != this) continue;
    *link = next_;
    break;
  }
  return std::exchange(temporary_, {});
}

void remove_temporaries() noexcept {
  // A thread may hold it that will never go on.
  const std::unique_lock lock(unfinished_mutex, std::try_to_lock);
  if (!lock) return;
  for (const AtomicFile* file = unfinished; file != nullptr; file = file->next_) {
    if (file->owns_name()) unlink(file->temporary_.c_str());
  }
}

AtomicFile::AtomicFile(std::string path, Existing existing, Temporary temporary)
    : path_(std::move(path)), existing_(existing) {
  if (path_.find('\0') != std::string::npos) {
    fail(Exit::usage, "{}: holds a NUL byte, which no file name has", path_);
  }
  if (path_ == "-") {
    stream_ = stdout;
    return;
  }
  if (path_.empty()) fail(Exit::usage, "the output has no name; give it one by -o");
  std::error_code error;
  target_ = fs::is_symlink(path_, error) ? fs::weakly_canonical(path_, error).string() : path_;
  const auto kind = fs::status(path_, error).type();
  if (kind == fs::file_type::directory) fail(Exit::io, "{}: is a directory", path_);
  // An unlinked file that a descriptor's path leads to has no name, or another file has it.
  const bool nameless = kind == fs::file_type::regular && !fs::equivalent(path_, target_, error);
  if (nameless || (kind != fs::file_type::not_found && kind != fs::file_type::regular)) {
    stream_ = std::fopen(path_.c_str(), "wb");
    if (stream_ == nullptr) fail_errno("cannot be written");
    return;
  }
  check_output(path_, {}, existing_);
  open_temporary(temporary);
}

void AtomicFile::open_temporary(Temporary temporary) {
  int descriptor = -1;
  if (temporary == Temporary::partial) {
    temporary_ = target_ + ".partial";
    kept_ = true;
    descriptor = open_partial(temporary_);
  } else {
    descriptor = open_hidden(target_, temporary_);
  }
  if (descriptor < 0) {
    const std::string name = std::exchange(temporary_, {});
    const int code = errno;
    if (code == ENOENT) require_folder(target_);
    if (kept_) fail(Exit::io, "{}: cannot be written: {}", name, std::strerror(code));
    errno = code;
    fail_errno("cannot be written");
  }
  keep_mode(descriptor, target_);
  stream_ = fdopen(descriptor, "wb");
  if (stream_ == nullptr) {
    const int code = errno;
    unlink(temporary_.c_str());
    close(descriptor);
    errno = code;
    fail_errno("cannot be written");
  }
  list();
}

AtomicFile::~AtomicFile() {
  // In this order, because a partial file is locked until it is closed.
  if (!temporary_.empty()) {
    if (owns_name()) unlink(temporary_.c_str());
    static_cast<void>(leave());
  }
  if (stream_ != nullptr && stream_ != stdout) std::fclose(stream_);
}

bool AtomicFile::owns_name() const {
  struct stat opened {
  }, named{};
  return stream_ != nullptr && fstat(fileno(stream_), &opened) == 0 &&
         lstat(temporary_.c_str(), &named) == 0 && same_file(opened, named);
}

void AtomicFile::write(std::span<const std::byte> bytes) {
  if (!bytes.empty() && std::fwrite(bytes.data(), 1, bytes.size(), stream_) != bytes.size()) {
    fail_errno("cannot be written");
  }
}

void AtomicFile::sync() {
  if (std::fflush(stream_) != 0) fail_errno("cannot be written");
  if (!temporary_.empty() && fsync(fileno(stream_)) != 0) fail_errno("cannot be written");
}

void AtomicFile::commit() {
  sync();
  if (stream_ == stdout) return;
  if (!temporary_.empty()) {
    if (!owns_name()) {
      fail(Exit::io, "{}: another program has taken its place; nothing is replaced", leave());
    }
    if (rename_to(temporary_, target_, existing_) != 0) {
      if (errno == EEXIST && kept_) {
        fail(Exit::io, "{}: has appeared meanwhile{}; the result is {}", path_,
             existing_ == Existing::container ? " and is no .gic container" : "", leave());
      }
      if (errno == EEXIST) fail_existing(path_, existing_);
      fail_errno("cannot be renamed to");
    }
    static_cast<void>(leave());
    sync_directory(fs::path(target_).parent_path());
  }
  std::FILE* stream = std::exchange(stream_, nullptr);
  if (std::fclose(stream) != 0) fail_errno("cannot be written");
}

void AtomicFile::fail_errno(const char* what) const {
  const int code = errno;
  fail(Exit::io, "{}: {}: {}", path_ == "-" ? "standard output" : path_, what, std::strerror(code));
}

void write_file(const std::string& path, std::span<const std::byte> bytes, Existing existing) {
  AtomicFile file(path, existing);
  file.write(bytes);
  file.commit();
}

}  // namespace gicodec::tools
