// Sources and sinks over memory and stdio.
#include <gicodec/io.h>

#include <stdio_ext.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>

namespace gicodec {

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
  // A pipe cannot seek; a file read from its middle or of no known size is treated like one.
  if (fseeko(file, 0, SEEK_CUR) != 0 || ftello(file) != 0) return;
  if (fseeko(file, 0, SEEK_END) != 0) return;
  const off_t end = ftello(file);
  if (fseeko(file, 0, SEEK_SET) == 0 && end > 0 && end < std::numeric_limits<off_t>::max()) {
    size_ = static_cast<std::uint64_t>(end);
  }
}

Result<std::size_t> FileSource::read(std::span<std::byte> into) {
  const std::size_t size = std::fread(into.data(), 1, into.size(), file_);
  if (size < into.size() && std::ferror(file_) != 0) return Status::io_failed;
  return size;
}

std::optional<std::uint64_t> FileSource::size() const {
  struct stat now {};
  const int file = fileno(file_);
  if (!size_ || file < 0 || fstat(file, &now) != 0 || !S_ISREG(now.st_mode)) return size_;
  return static_cast<std::uint64_t>(now.st_size);
}

Status FileSource::seek(std::uint64_t offset) {
  if (const auto now = size(); !now || offset > *now) return Status::io_failed;
  // Drops what stdio read ahead: a growing file may have other bytes there.
  (void)std::fflush(file_);
  return fseeko(file_, static_cast<off_t>(offset), SEEK_SET) == 0 ? Status::ok : Status::io_failed;
}

Status FileSink::write(std::span<const std::byte> bytes) {
  if (broken_ || std::fflush(file_) != 0) return Status::io_failed;
  const off_t start = ftello(file_);
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) == bytes.size() &&
      std::fflush(file_) == 0) {
    return Status::ok;
  }
  const int cause = errno;
  __fpurge(file_);
  std::clearerr(file_);
  broken_ =
      start < 0 || ftruncate(fileno(file_), start) != 0 || fseeko(file_, start, SEEK_SET) != 0;
  errno = cause;
  return Status::io_failed;
}

}  // namespace gicodec
