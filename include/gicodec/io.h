// Where bytes of containers go and come from.
#pragma once

#include <gicodec/api.h>
#include <gicodec/status.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <span>

namespace GICODEC_API gicodec {

/// Where bytes go.
class Sink {
 public:
  virtual ~Sink() = default;
  /// All of them, or an error and none: the call may come again. A sink that cannot take back what
  /// it wrote of them answers errors from then on.
  virtual Status write(std::span<const std::byte> bytes) = 0;
};

/// Where bytes come from.
class Source {
 public:
  virtual ~Source() = default;
  /// Fills as much of `into` as there is; fewer bytes than asked for means the end, of a source
  /// that grows the end for now.
  [[nodiscard]] virtual Result<std::size_t> read(std::span<std::byte> into) = 0;
  /// Total size if the source can seek, else nullopt (a pipe). Another call may tell a larger one.
  [[nodiscard]] virtual std::optional<std::uint64_t> size() const { return std::nullopt; }
  /// Precondition: size() has a value and offset is at most that.
  virtual Status seek(std::uint64_t /*offset*/) { return Status::io_failed; }
};

/// Reads from memory that outlives it.
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

/// Reads from a stdio stream, which must not be null and which it does not close. A file may grow
/// meanwhile.
class FileSource final : public Source {
 public:
  explicit FileSource(std::FILE* file) noexcept;
  Result<std::size_t> read(std::span<std::byte> into) override;
  std::optional<std::uint64_t> size() const override;
  Status seek(std::uint64_t offset) override;

 private:
  std::FILE* file_;
  std::optional<std::uint64_t> size_;  ///< at first
};

/// Writes to a stdio stream, which must not be null and which it does not close. What a call wrote
/// has left the stream's buffer. After an error a file ends where the call began; of a pipe the
/// rest is refused. errno says why.
class FileSink final : public Sink {
 public:
  explicit FileSink(std::FILE* file) noexcept : file_(file) {}
  Status write(std::span<const std::byte> bytes) override;

 private:
  std::FILE* file_;
  bool broken_ = false;
};

}  // namespace gicodec
