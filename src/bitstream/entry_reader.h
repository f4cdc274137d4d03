// Reads the entries of a container from a source and checks each.
#pragma once

#include <gicodec/io.h>
#include <gicodec/packet.h>

#include "bitstream/container_format.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace gicodec {

/// An entry of a container.
struct FileEntry {
  std::uint8_t type = 0;
  std::uint64_t offset = 0;
  std::uint64_t size = 0;     ///< of the body
  std::uint64_t body_at = 0;  ///< offset of the body
  SeekEntry packet;           ///< EntryType::packet only
  /// The body; of a packet the packet itself, of an index part nothing. Valid until the next call.
  std::span<const std::byte> bytes;

  [[nodiscard]] bool is(EntryType wanted) const noexcept {
    return type == static_cast<std::uint8_t>(wanted);
  }
  [[nodiscard]] std::uint64_t end() const noexcept { return body_at + size + kEntryChecksum; }
};

/// If the source can seek, a failed call may be repeated.
class EntryReader {
 public:
  EntryReader(Source& source, const DecodeLimits& limits) noexcept
      : source_(&source), limits_(limits) {}
  void set_rules(std::vector<PacketRule> rules) noexcept { rules_ = std::move(rules); }
  [[nodiscard]] std::span<const PacketRule> rules() const noexcept { return rules_; }
  [[nodiscard]] const DecodeLimits& limits() const noexcept { return limits_; }
  /// nullopt if the source cannot seek; entries must then be read in order.
  [[nodiscard]] std::optional<std::uint64_t> size() const { return source_->size(); }

  /// As Source::prefetch().
  [[nodiscard]] bool prefetch(std::span<const ByteRange> ranges) {
    return source_->prefetch(ranges);
  }

  /// Reads magic and version. Errors: not_gicodec, truncated, unsupported_version,
  /// unsupported_feature.
  Status file_head();
  /// Reads the entry at `offset`. Skips the body of an index part, which only ContainerIndex reads.
  Status read(std::uint64_t offset, FileEntry& entry);
  /// Reads type and size only. truncated if the source's size() ends before the entry.
  Status read_head(std::uint64_t offset, FileEntry& entry);
  /// After read_head(): reads the body and verifies the checksum.
  Status read_body(FileEntry& entry);
  /// Bytes at any offset, or truncated. Valid until the next call.
  Result<std::span<const std::byte>> bytes(std::uint64_t offset, std::uint64_t size);

 private:
  Status go_to(std::uint64_t offset);
  Status more(std::uint64_t size);
  Status pass(std::uint64_t bytes);
  Status pass_index_part(FileEntry& entry);
  [[nodiscard]] std::uint64_t limit_of(const FileEntry& entry) const noexcept;
  Status take_packet(FileEntry& entry) const;

  Source* source_;
  DecodeLimits limits_;
  std::vector<PacketRule> rules_;  ///< by texture
  std::vector<std::byte> buffer_;
  std::uint64_t at_ = 0;  ///< the source's position
};

}  // namespace gicodec
