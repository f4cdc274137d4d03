// Sinks and sources of a container's bytes.
#pragma once

#include <gicodec/api.h>
#include <gicodec/status.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <span>

namespace GICODEC_API gicodec {

/// Takes bytes.
class Sink {
 public:
  virtual ~Sink() = default;
  /// Writes all bytes, or none and returns an error; the caller may repeat the call. A sink that
  /// cannot undo a partial write answers errors from then on.
  virtual Status write(std::span<const std::byte> bytes) = 0;
};

/// Bytes of a source.
struct ByteRange {
  std::uint64_t offset = 0, size = 0;
};

/// Gives bytes.
class Source {
 public:
  virtual ~Source() = default;
  /// Fills `into` and returns the number of bytes. Fewer than asked for: the end, of a growing
  /// source its present end.
  [[nodiscard]] virtual Result<std::size_t> read(std::span<std::byte> into) = 0;
  /// Total bytes if the source can seek, else nullopt (a pipe). May grow between calls.
  [[nodiscard]] virtual std::optional<std::uint64_t> size() const { return std::nullopt; }
  /// The next read() begins at `offset`. Precondition: size() has a value, at least `offset`.
  virtual Status seek(std::uint64_t /*offset*/) { return Status::io_failed; }
  /// Says which bytes will be read next, so that a source that is far away brings them together.
  /// May be called with none. False: reading has no delay here, and nobody need call it again.
  virtual bool prefetch(std::span<const ByteRange> /*ranges*/) { return false; }
};

/// Reads from memory, which must outlive it.
class MemorySource final : public Source {
 public:
  explicit MemorySource(std::span<const std::byte> bytes) noexcept : bytes_(bytes) {}
  Result<std::size_t> read(std::span<std::byte> into) override;
  std::optional<std::uint64_t> size() const override { return bytes_.size(); }
  Status seek(std::uint64_t offset) override;

 private:
  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
};

/// Reads from a stdio stream, which must not be null. Does not close it. Can seek only in a file
/// that stands at its beginning when this is created, and is not empty. The file may grow.
class FileSource final : public Source {
 public:
  explicit FileSource(std::FILE* file) noexcept;
  Result<std::size_t> read(std::span<std::byte> into) override;
  std::optional<std::uint64_t> size() const override;
  Status seek(std::uint64_t offset) override;

 private:
  std::FILE* file_;
  std::optional<std::uint64_t> size_;  ///< when created
};

/// Writes to a stdio stream, which must not be null. Does not close it. Each call flushes the
/// stream. After an error a file ends where the call began; a pipe refuses all further calls. errno
/// holds the cause.
class FileSink final : public Sink {
 public:
  explicit FileSink(std::FILE* file) noexcept : file_(file) {}
  Status write(std::span<const std::byte> bytes) override;

 private:
  std::FILE* file_;
  bool broken_ = false;
};

}  // namespace gicodec
