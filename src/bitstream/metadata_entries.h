// The metadata entries of a container, which stand between its description and its packets.
#pragma once

#include "bitstream/container_metadata.h"
#include "bitstream/entry_reader.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace gicodec {

class MetadataEntries {
 public:
  MetadataEntries() = default;
  /// `first_entry`: offset of the entry behind the description.
  explicit MetadataEntries(std::uint64_t first_entry) noexcept : end_(first_entry) {}

  /// Finds the entries as far as the source has them: by their heads, or in a pipe by reading them
  /// and the one behind them. Errors of an entry's head; read() finds others.
  Status find(EntryReader& reader);
  /// After find(). Empty if the texture has none.
  [[nodiscard]] Result<Metadata> read(EntryReader& reader, std::uint8_t texture_id) const;
  /// Behind the last one found.
  [[nodiscard]] std::uint64_t end() const noexcept { return end_; }

  /// What EntryReader::read() gave for the entry behind them.
  struct Ahead {
    FileEntry entry;
    Status status = Status::ok;
  };
  /// The entry of a pipe that find() has read, once.
  [[nodiscard]] std::optional<Ahead> take_ahead() noexcept { return std::exchange(ahead_, {}); }

 private:
  struct Found {
    std::uint8_t texture_id = 0;
    std::uint64_t offset = 0;
    std::vector<std::byte> body;  ///< of a pipe
    Status status = Status::ok;   ///< of reading it
  };
  Status add(EntryReader& reader, const FileEntry& entry, Status status);

  std::vector<Found> found_;  ///< ascending by texture
  std::uint64_t end_ = 0;
  std::uint64_t bytes_ = 0;  ///< of all, unpacked
  bool complete_ = false;    ///< another entry stands behind them
  std::optional<Ahead> ahead_;
};

}  // namespace gicodec
