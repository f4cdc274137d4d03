// Container (.gic): packets of several textures on disk or in a pipe, with a seek index
// (FORMAT.md, "Container").
#pragma once

#include <gicodec/packet.h>
#include <gicodec/status.h>
#include <gicodec/texture.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gicodec {

/// Names and values of free text (UTF-8 of at most 1 MiB each), kept in order. Names are unique by
/// convention only.
using Metadata = std::vector<std::pair<std::string, std::string>>;
/// nullptr if there is no such name.
[[nodiscard]] const std::string* find_metadata(const Metadata& metadata,
                                               std::string_view name) noexcept;

/// What all text of a container has to be: no overlong forms, no surrogates, nothing above
/// U+10FFFF.
[[nodiscard]] bool is_utf8(std::string_view text) noexcept;

/// A texture of the container; its place in the list is the texture_id of its packets.
struct TextureEntry {
  std::string name;  ///< e.g. "color"; UTF-8 of at most 255 bytes
  TextureDesc desc;
  Metadata metadata;
};

struct ContainerDescription {
  std::vector<TextureEntry> textures;  ///< 1..256
  Metadata metadata;
};

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
  /// Fills as much of `into` as there is; fewer bytes than asked for means the end.
  [[nodiscard]] virtual Result<std::size_t> read(std::span<std::byte> into) = 0;
  /// Total size if the source can seek, else nullopt (a pipe).
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

/// Reads from a stdio stream, which it does not close.
class FileSource final : public Source {
 public:
  explicit FileSource(std::FILE* file) noexcept;
  Result<std::size_t> read(std::span<std::byte> into) override;
  std::optional<std::uint64_t> size() const override { return size_; }
  Status seek(std::uint64_t offset) override;

 private:
  std::FILE* file_;
  std::optional<std::uint64_t> size_;
};

/// Writes to a stdio stream, which it does not close. What a call wrote has left the stream's
/// buffer. After an error a file ends where the call began; of a pipe the rest is refused. errno
/// says why.
class FileSink final : public Sink {
 public:
  explicit FileSink(std::FILE* file) noexcept : file_(file) {}
  Status write(std::span<const std::byte> bytes) override;

 private:
  std::FILE* file_;
  bool broken_ = false;
};

/// One packet in the seek index.
struct SeekEntry {
  std::uint64_t frame = 0;
  std::uint64_t offset = 0;  ///< of the packet's record, from the start of the file
  std::uint8_t texture_id = 0;
  bool keyframe = false;
};

/// Writes a container front to back, without seeking. Keeps 24 bytes per packet for the index. A
/// call that fails changes nothing, whether memory or the sink was the cause: it may be repeated,
/// or the container finished without it. After finish() every call answers invalid_argument.
class ContainerWriter {
 public:
  /// Writes file header and description. `sink` must outlive the writer.
  [[nodiscard]] static Result<ContainerWriter> create(Sink& sink,
                                                      const ContainerDescription& description);
  /// Adds the packet of a frame. Frames must not decrease; within a frame a texture has at most
  /// one packet. The packet's texture_id says which texture it belongs to.
  Status add(std::uint64_t frame, std::span<const std::byte> packet);
  /// Writes seek index and trailer. Without it the file is readable, but counts as cut off.
  Status finish();
  [[nodiscard]] std::uint64_t bytes_written() const noexcept { return written_; }

 private:
  explicit ContainerWriter(Sink& sink, std::size_t textures) noexcept
      : sink_(&sink), textures_(textures) {}
  Status write(std::span<const std::byte> records);

  Sink* sink_;
  std::size_t textures_;
  std::uint64_t written_ = 0;
  std::vector<SeekEntry> index_;
  bool ended_ = false;
};

/// A packet as read from a container.
struct ContainerPacket {
  std::uint64_t frame = 0;
  std::uint8_t texture_id = 0;
  bool keyframe = false;
  std::vector<std::byte> bytes;
};

/// Reads a container front to back, or from a keyframe if the source can seek and the index is
/// sound. Safe on hostile bytes; a file whose tail is cut off gives every packet before the cut.
class ContainerReader {
 public:
  /// Reads header and description, and the index if the source can seek. `source` must outlive
  /// the reader. Errors: not_gicodec, unsupported_version, truncated, corrupt, limit_exceeded.
  [[nodiscard]] static Result<ContainerReader> open(Source& source,
                                                    const DecodeLimits& limits = {});
  [[nodiscard]] const ContainerDescription& description() const noexcept { return description_; }

  /// Reads the next packet into `packet`; Status::end after the last, Status::truncated where the
  /// file was cut off: everything before was sound. After an error it stays at the end.
  [[nodiscard]] Status next(ContainerPacket& packet);

  /// True if a seek index was found and is sound.
  [[nodiscard]] bool seekable() const noexcept { return !index_.empty(); }
  /// Continues with the last place from which every texture can be decoded up to `frame`. Textures
  /// have their keyframes at their own times: a decoder answers reference_missing to packets before
  /// its first keyframe from there on, and to none after it.
  /// Precondition: seekable(). invalid_argument if the container has no such frame.
  Status seek(std::uint64_t frame);

 private:
  ContainerReader(Source& source, const DecodeLimits& limits) noexcept
      : source_(&source), limits_(limits) {}
  Status read_head();
  Status read_index();
  Result<std::uint8_t> read_record(std::vector<std::byte>& body);

  Source* source_;
  DecodeLimits limits_;
  ContainerDescription description_;
  std::vector<SeekEntry> index_;
  std::uint64_t position_ = 0;      ///< bytes consumed in order
  std::uint64_t first_packet_ = 0;  ///< offset of the record after the description
  std::uint64_t last_frame_ = 0;
  std::optional<SeekEntry> sought_;  ///< of the record that seek() went to, until it was read
  bool index_passed_ = false;
  bool ended_ = false;
};

}  // namespace gicodec
