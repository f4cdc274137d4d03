#include "dump/file.h"

#include "dump/cure.h"
#include "dump/error.h"
#include "dump/file_system.h"
#include "dump/text.h"

#include <array>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <mutex>
#include <random>
#include <system_error>
#include <utility>

namespace gicodec::tools {
namespace {

namespace fs = std::filesystem;

using enum FileState::Kind;

bool is_container(std::FILE* file) {
  constexpr std::array kMagic{'\x89', 'G', 'I', 'C', '\r', '\n', '\x1a', '\n'};
  std::array<char, kMagic.size()> magic{};
  return read_head(file, magic) == magic.size() && magic == kMagic;
}

/// True unless the output would replace a file that `existing` protects.
bool may_go(const std::string& path, Existing existing) {
  if (existing == Existing::replace) return true;
  const auto file = state_of(path.c_str());
  if (!file) {
    // What a link without a file stands for is not known.
    const auto named = state_of(path.c_str(), Links::show);
    return !named || named->kind != link;
  }
  if (file->kind != regular || file->size == 0) return true;
  return existing == Existing::container && is_container_file(path);
}

/// Renames, after checking `existing` again: a file may have appeared since the start.
bool rename_to(const std::string& from, const std::string& to, Existing existing) {
  if (existing == Existing::replace) return rename_file(from, to, true);
  if (rename_file(from, to, false)) return true;
  if (errno != EEXIST) return false;
  if (may_go(to, existing)) return rename_file(from, to, true);
  errno = EEXIST;
  return false;
}

[[noreturn]] void fail_existing(const std::string& path, Existing existing) {
  if (!is_readable(path)) {
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
  const auto file = state_of(path.c_str());
  if (file && file->kind == regular) files_.insert(file->identity);
}

bool InputFiles::contains(const std::string& path) const {
  const auto file = state_of(path.c_str());
  return file && file->kind == regular && files_.contains(file->identity);
}

void require_folder(const std::string& path) {
  const fs::path folder = native_path(path).parent_path();
  std::error_code error;
  if (!folder.empty() && !fs::exists(folder, error) && !error) {
    fail(Exit::io, "{}: cannot be written: there is no folder {}; make it first", path,
         path_text(folder));
  }
}

void check_output(const std::string& path, const InputFiles& inputs, Existing existing) {
  if (path == "-" ? is_terminal(stdout) : is_terminal(path)) {
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
  const auto file = state_of(path.c_str(), Links::show);
  if (!file || file->kind == regular) return;
  // What a link leads to may be an original.
  fail(Exit::io, "{}: is in the way and {}; move it or name another output", path,
       file->kind == link ? "a link" : "no regular file");
}

bool is_container_file(const std::string& path) {
  const auto state = state_of(path.c_str());
  if (!state || state->kind != regular) return false;
  const OwnedFile file(open_input(path));
  return file && is_container(file.get());
}

void require_exists(const std::string& path) {
  if (state_of(path.c_str())) return;
  fail(Exit::io, "{}: {}", path, errno == ENOENT ? "does not exist" : reason(errno));
}

void finish_standard_output() {
  const int flushed = std::fflush(stdout) == 0 ? 0 : errno;
  if (flushed == 0 && std::ferror(stdout) == 0) return;
  const int error = output_error() != 0 ? output_error() : flushed;
  if (reader_ended(error)) return;
  fail(Exit::io, "standard output: cannot be written: {}", reason(error));
}

void check_report(const std::string& path, bool (*is_report)(std::string_view head)) {
  const auto state = state_of(path.c_str());
  if (!state || state->kind != regular) return;
  std::array<char, 64> head{};
  const OwnedFile file(open_input(path));
  const auto size = file ? read_head(file.get(), head) : std::nullopt;
  if (size && (*size == 0 || is_report({head.data(), *size}))) return;
  fail(Exit::usage, "{}: holds something else and would be overwritten; name another file", path);
}

bool shares_standard_error(const std::string& path) {
  const auto output = path == "-" ? state_of(stdout) : state_of(path.c_str());
  const auto errors = state_of(stderr);
  // A terminal is refused elsewhere, /dev/null keeps nothing.
  return output && errors && output->kind != character && output->same_file(*errors);
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
    if (file->owns_name()) remove_file(file->temporary_.c_str());
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
  const auto own = state_of(path_.c_str(), Links::show);
  target_ = own && own->kind == link ? resolved(path_) : path_;
  const auto file = state_of(path_.c_str());
  if (!file && errno != ENOENT && errno != ENOTDIR) fail_errno("cannot be written");
  if (file && file->kind == directory) fail(Exit::io, "{}: is a directory", path_);
  // An unlinked file that a descriptor's path leads to has no name, or another file has it.
  const auto named = state_of(target_.c_str());
  const bool nameless = file && file->kind == regular && !(named && file->same_file(*named));
  if (nameless || (file && file->kind != regular)) {
    stream_ = open_device(path_);
    if (stream_ == nullptr) fail_errno("cannot be written");
    return;
  }
  check_output(path_, {}, existing_);
  open_temporary(temporary);
}

/// A new file beside the target. Cuts its name, between characters, to what a file may have.
std::FILE* AtomicFile::open_hidden() {
  constexpr std::size_t kKept = 200;
  const fs::path target = native_path(target_);
  std::string kept = path_text(target.filename());
  if (kept.size() > kKept) {
    std::size_t end = kKept;
    while (end > 0 && (kept[end] & 0xC0) == 0x80) --end;
    kept.resize(end);
  }
  std::random_device random;
  for (int attempt = 0; attempt < 100; ++attempt) {
    const std::string hidden = fmt::format(".{}.{:08x}", kept, random());
    temporary_ = path_text(target.parent_path() / native_path(hidden));
    std::FILE* const file = create_file(temporary_, target_);
    if (file != nullptr || errno != EEXIST) return file;
  }
  return nullptr;
}

/// PATH.partial, empty and locked. The lock ends with the program.
std::FILE* AtomicFile::open_partial(bool restart) {
  temporary_ = target_ + ".partial";
  kept_ = true;
  OwnedFile file(open_locked(temporary_, target_));
  if (!file && errno == EWOULDBLOCK) {
    fail(Exit::io, "{}: another program is writing it", temporary_);
  }
  if (!file) return nullptr;
  const auto state = state_of(file.get());
  if (state && state->kind == regular && state->size == 0) return file.release();
  if (state && state->kind == regular && is_container(file.get())) {
    std::error_code error;
    if (restart && fs::hard_link_count(native_path(temporary_), error) != 1) {
      fail(Exit::io, "{}: is in the way, and has other names; remove it", temporary_);
    }
    if (restart) fs::resize_file(native_path(temporary_), 0, error);
    if (restart && !error) {
      std::rewind(file.get());
      return file.release();
    }
    fail(Exit::io,
         "{}: was left over by a program that was killed; \"gicodec decode\" and \"gi-render\" "
         "read what it holds with --allow-incomplete; move or remove it to go on",
         temporary_);
  }
  fail(Exit::io, "{}: is in the way; move it or name another output", temporary_);
}

void AtomicFile::open_temporary(Temporary temporary) {
  stream_ = temporary == Temporary::hidden ? open_hidden()
                                           : open_partial(temporary == Temporary::restart);
  if (stream_ == nullptr) {
    const std::string name = std::exchange(temporary_, {});
    const int code = errno;
    if (code == ENOENT) require_folder(target_);
    if (kept_) fail(Exit::io, "{}: cannot be written: {}", name, reason(code));
    errno = code;
    fail_errno("cannot be written");
  }
  list();
}

AtomicFile::~AtomicFile() {
  // In this order, because a partial file is locked until it is closed.
  if (!temporary_.empty()) {
    if (owns_name()) remove_file(temporary_.c_str());
    static_cast<void>(leave());
  }
  if (stream_ != nullptr && stream_ != stdout) std::fclose(stream_);
}

bool AtomicFile::owns_name() const {
  if (stream_ == nullptr) return false;
  const auto opened = state_of(stream_);
  const auto named = state_of(temporary_.c_str(), Links::show);
  return opened && named && opened->same_file(*named);
}

void AtomicFile::write(std::span<const std::byte> bytes) {
  if (!bytes.empty() && std::fwrite(bytes.data(), 1, bytes.size(), stream_) != bytes.size()) {
    fail_errno("cannot be written");
  }
}

void AtomicFile::sync() {
  const bool written = temporary_.empty() ? std::fflush(stream_) == 0 : sync_file(stream_);
  if (!written) fail_errno("cannot be written");
}

void AtomicFile::commit() {
  sync();
  if (stream_ == stdout) return;
  if (!temporary_.empty()) {
    if (!owns_name()) {
      fail(Exit::io, "{}: another program has taken its place; nothing is replaced", leave());
    }
    if (!rename_to(temporary_, target_, existing_)) {
      if (errno == EEXIST && kept_) {
        fail(Exit::io, "{}: has appeared meanwhile{}; the result is {}", path_,
             existing_ == Existing::container ? " and is no .gic container" : "", leave());
      }
      const int code = errno;
      if (code == EEXIST) fail_existing(path_, existing_);
      if (kept_) {
        fail(Exit::io, "{}: cannot be renamed to: {}; the result is {}", path_, reason(code),
             leave());
      }
      fail_errno("cannot be renamed to");
    }
    static_cast<void>(leave());
  }
  std::FILE* stream = std::exchange(stream_, nullptr);
  if (std::fclose(stream) != 0) fail_errno("cannot be written");
}

void AtomicFile::fail_errno(const char* what) const {
  const int code = errno;
  fail(Exit::io, "{}: {}: {}", path_ == "-" ? "standard output" : path_, what, reason(code));
}

std::string file_contents(const std::string& path) {
  require_exists(path);
  std::error_code failed;
  if (std::filesystem::is_directory(native_path(path), failed))
    fail(Exit::io, "{}: is a folder; name a file", path);
  std::ifstream stream(native_path(path), std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream) fail(Exit::io, "{}: cannot be read", path);
  return text;
}

void write_file(const std::string& path, std::span<const std::byte> bytes, Existing existing) {
  AtomicFile file(path, existing);
  file.write(bytes);
  file.commit();
}

}  // namespace gicodec::tools
