// Sources and sinks over memory and stdio.
#include <gicodec/io.h>

#if defined(_WIN32)
#include <io.h>
#include <sys/stat.h>
#else
#if __has_include(<stdio_ext.h>)  // glibc and musl
#include <stdio_ext.h>
#define GICODEC_STDIO_EXT
#endif
#include <sys/stat.h>
#include <unistd.h>
#endif

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <limits>

namespace gicodec {
namespace {

// Standard C has these for files below 2 GiB alone, and no way to cut one.
#if defined(_WIN32)

std::int64_t position(std::FILE* file) { return _ftelli64(file); }
bool go_to(std::FILE* file, std::int64_t offset, int from) {
  return _fseeki64(file, offset, from) == 0;
}
bool cut(std::FILE* file, std::int64_t size) { return _chsize_s(_fileno(file), size) == 0; }
/// The runtime library drops by itself what it could not write.
void drop_unwritten(std::FILE*) {}
std::optional<std::uint64_t> size_of_regular(std::FILE* file) {
  struct _stat64 now {};
  const int descriptor = _fileno(file);
  if (descriptor < 0 || _fstat64(descriptor, &now) != 0 || (now.st_mode & _S_IFREG) == 0) {
    return std::nullopt;
  }
  return static_cast<std::uint64_t>(now.st_size);
}

#else

std::int64_t position(std::FILE* file) { return ftello(file); }
bool go_to(std::FILE* file, std::int64_t offset, int from) {
  return fseeko(file, static_cast<off_t>(offset), from) == 0;
}
bool cut(std::FILE* file, std::int64_t size) {
  return ftruncate(fileno(file), static_cast<off_t>(size)) == 0;
}
void drop_unwritten(std::FILE* file) {
#if defined(GICODEC_STDIO_EXT)
  __fpurge(file);
#else
  fpurge(file);
#endif
}
std::optional<std::uint64_t> size_of_regular(std::FILE* file) {
  struct stat now {};
  const int descriptor = fileno(file);
  if (descriptor < 0 || fstat(descriptor, &now) != 0 || !S_ISREG(now.st_mode)) return std::nullopt;
  return static_cast<std::uint64_t>(now.st_size);
}

#endif

}  // namespace

Result<std::size_t> MemorySource::read(std::span<std::byte> into) {
  const std::size_t size = std::min(into.size(), bytes_.size() - position_);
  if (size > 0) std::memcpy(into.data(), bytes_.data() + position_, size);
  position_ += size;
  return size;
}

Status MemorySource::seek(std::uint64_t offset) {
  if (offset > bytes_.size()) return Status::io_failed;
  position_ = static_cast<std::size_t>(offset);
  return Status::ok;
}

FileSource::FileSource(std::FILE* file) noexcept : file_(file) {
#if defined(_WIN32)
  if (!size_of_regular(file)) return;  // seeking in a pipe seems to succeed there
#endif
  // A pipe cannot seek; a file read from its middle or of no known size is treated like one.
  if (!go_to(file, 0, SEEK_CUR) || position(file) != 0) return;
  if (!go_to(file, 0, SEEK_END)) return;
  const std::int64_t end = position(file);
  if (go_to(file, 0, SEEK_SET) && end > 0 && end < std::numeric_limits<std::int64_t>::max()) {
    size_ = static_cast<std::uint64_t>(end);
  }
}

Result<std::size_t> FileSource::read(std::span<std::byte> into) {
  const std::size_t size = std::fread(into.data(), 1, into.size(), file_);
  if (size < into.size() && std::ferror(file_) != 0) return Status::io_failed;
  return size;
}

std::optional<std::uint64_t> FileSource::size() const {
  const auto now = size_ ? size_of_regular(file_) : std::nullopt;
  return now ? now : size_;
}

Status FileSource::seek(std::uint64_t offset) {
  if (const auto now = size(); !now || offset > *now) return Status::io_failed;
  // Drops what stdio read ahead: a growing file may have other bytes there.
  (void)std::fflush(file_);
  const bool there = go_to(file_, static_cast<std::int64_t>(offset), SEEK_SET);
  return there ? Status::ok : Status::io_failed;
}

Status FileSink::write(std::span<const std::byte> bytes) {
  if (broken_ || std::fflush(file_) != 0) return Status::io_failed;
  const std::int64_t start = position(file_);
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) == bytes.size() &&
      std::fflush(file_) == 0) {
    return Status::ok;
  }
  const int cause = errno;
  drop_unwritten(file_);
  std::clearerr(file_);
  broken_ = start < 0 || !cut(file_, start) || !go_to(file_, start, SEEK_SET);
  errno = cause;
  return Status::io_failed;
}

}  // namespace gicodec
