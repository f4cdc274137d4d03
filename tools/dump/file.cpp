#include "dump/file.h"

#include "dump/error.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

namespace gicodec::tools {
namespace {

namespace fs = std::filesystem;

// mkstemp makes private files; a result gets the mode that open() would have given it.
mode_t default_mode() {
  const mode_t mask = umask(0);
  umask(mask);
  return 0666 & ~mask;
}

}  // namespace

AtomicFile::AtomicFile(std::string path) : path_(std::move(path)) {
  if (path_ == "-") {
    stream_ = stdout;
    return;
  }
  std::error_code error;
  target_ = fs::is_symlink(path_, error) ? fs::weakly_canonical(path_, error).string() : path_;
  const auto kind = fs::status(target_, error).type();
  if (kind == fs::file_type::directory) fail(Exit::io, "{}: is a directory", path_);
  if (kind != fs::file_type::not_found && kind != fs::file_type::regular) {
    stream_ = std::fopen(target_.c_str(), "wb");
    if (stream_ == nullptr) fail_errno("cannot be written");
    return;
  }
  const fs::path target(target_);
  temporary_ =
      (target.parent_path() / fmt::format(".{}.XXXXXX", target.filename().string())).string();
  const int descriptor = mkstemp(temporary_.data());
  if (descriptor < 0) {
    temporary_.clear();
    fail_errno("cannot be written");
  }
  stream_ = fdopen(descriptor, "wb");
  if (stream_ == nullptr) {
    close(descriptor);
    unlink(temporary_.c_str());
    fail_errno("cannot be written");
  }
}

AtomicFile::~AtomicFile() {
  if (stream_ != nullptr && stream_ != stdout) std::fclose(stream_);
  if (!temporary_.empty()) unlink(temporary_.c_str());
}

void AtomicFile::write(std::span<const std::byte> bytes) {
  if (!bytes.empty() && std::fwrite(bytes.data(), 1, bytes.size(), stream_) != bytes.size()) {
    fail_errno("cannot be written");
  }
}

void AtomicFile::commit() {
  if (std::fflush(stream_) != 0) fail_errno("cannot be written");
  if (stream_ == stdout) return;
  if (!temporary_.empty() &&
      (fchmod(fileno(stream_), default_mode()) != 0 || fsync(fileno(stream_)) != 0)) {
    fail_errno("cannot be written");
  }
  std::FILE* stream = std::exchange(stream_, nullptr);
  if (std::fclose(stream) != 0) fail_errno("cannot be written");
  if (temporary_.empty()) return;
  if (std::rename(temporary_.c_str(), target_.c_str()) != 0) fail_errno("cannot be renamed to");
  temporary_.clear();
}

void AtomicFile::fail_errno(const char* what) const {
  const int code = errno;
  fail(Exit::io, "{}: {}: {}", path_ == "-" ? "standard output" : path_, what, std::strerror(code));
}

void write_file(const std::string& path, std::span<const std::byte> bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

void make_directory(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (!fs::is_directory(path)) {
    fail(Exit::io, "{}: cannot make this directory: {}", path,
         error ? error.message() : "a file of this name exists");
  }
}

OutputDirectory::OutputDirectory(std::string path) : path_(std::move(path)) {
  std::error_code error;
  made_ = !fs::exists(path_, error);
  make_directory(path_);
}

OutputDirectory::~OutputDirectory() {
  std::error_code not_empty;
  if (made_) fs::remove(path_, not_empty);
}

}  // namespace gicodec::tools
