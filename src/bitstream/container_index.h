// The index of a container: the packets of its index parts, and those behind them.
#pragma once

#include "bitstream/entry_reader.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gicodec {

class ContainerIndex {
 public:
  /// Reads the index parts of a source that can seek. After an error there is no index.
  Status load(EntryReader& reader, std::uint64_t first_entry);
  /// Reads the entries behind end() and lists their packets.
  Status extend(EntryReader& reader);
  /// Lists an entry that was read in order, if it is the one at end().
  void list(const FileEntry& entry, const DecodeLimits& limits);

  /// Packets before end(), by offset; frames do not decrease.
  [[nodiscard]] const std::vector<SeekEntry>& packets() const noexcept { return packets_; }
  [[nodiscard]] std::uint64_t end() const noexcept { return end_; }
  /// True if load() found the container's end mark.
  [[nodiscard]] bool finished() const noexcept { return finished_; }

 private:
  Status find_last_part(EntryReader& reader, std::uint64_t total, std::uint64_t& last);
  Status read_parts(EntryReader& reader, std::uint64_t last, std::uint64_t above);

  std::vector<SeekEntry> packets_;
  std::uint64_t first_entry_ = 0;
  std::uint64_t end_ = 0;  ///< offset of the first entry that is not listed
  bool finished_ = false;
};

}  // namespace gicodec
