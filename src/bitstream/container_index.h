// The index of a container: its index parts, each read when it is needed, and the packets behind
// them.
#pragma once

#include "bitstream/entry_reader.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gicodec {

/// A failed call may be repeated. Spans are valid until the next call of a function that is not
/// const.
class ContainerIndex {
 public:
  /// Finds the index parts of a source that can seek. After an error there is no index.
  Status load(EntryReader& reader, std::uint64_t first_entry);
  /// Reads the entries behind end() and lists their packets.
  Status extend(EntryReader& reader);
  /// Lists an entry that was read in order, if it is the one at end().
  void list(const FileEntry& entry, const DecodeLimits& limits);

  /// What a part lists, by offset; frames do not decrease.
  using Packets = std::span<const SeekEntry>;
  /// The packets of a part from `offset` on: of the first part that has any. Empty: there is none.
  [[nodiscard]] Result<Packets> packets_from(EntryReader& reader, std::uint64_t offset);
  /// The same without reading: empty as well where the part was not read.
  [[nodiscard]] Packets held_from(std::uint64_t offset) const noexcept;
  /// Of a part that was not read: the frame of its first packet, for those from `offset` on.
  [[nodiscard]] std::optional<std::uint64_t> least_frame(std::uint64_t offset) const noexcept;
  /// True if an index part stands there.
  [[nodiscard]] bool is_part(std::uint64_t offset) const noexcept;
  /// The lists, in order, with all packets of `frame`, the last keyframes before them and all that
  /// follows these. packets_from() then passes over the parts between, until everything().
  [[nodiscard]] Result<std::vector<Packets>> packets_for(EntryReader& reader, std::uint64_t frame);
  void everything() noexcept { needed_.clear(); }
  /// Calls visit(packet, bytes of its entry) for all packets, in order.
  template <typename Visit>
  Status for_each(EntryReader& reader, const Visit& visit);

  /// Offset of the first entry that is not listed.
  [[nodiscard]] std::uint64_t end() const noexcept { return end_; }
  /// True if load() found the container's end mark.
  [[nodiscard]] bool finished() const noexcept { return finished_; }
  /// Where the entry behind the packet at `packet`, one of packets_from(), begins at the latest.
  [[nodiscard]] std::uint64_t end_of(const SeekEntry& packet) const noexcept;

 private:
  struct Part {
    PartPlace place;
    std::uint64_t begin = 0;         ///< its packets lie between here and its place
    std::vector<SeekEntry> packets;  ///< once they are read
    bool read = false;
  };
  Status find_last_part(EntryReader& reader, std::uint64_t total, std::uint64_t& last);
  Status read_directory(EntryReader& reader, std::uint64_t last, std::uint64_t above);
  Status add_part(PartPlace place, const DecodeLimits& limits);
  Status read(EntryReader& reader, std::span<const std::size_t> numbers);
  Status read(EntryReader& reader, std::size_t number);
  Status read_some(EntryReader& reader, std::size_t first, bool all);
  void make_room(const DecodeLimits& limits) noexcept;
  [[nodiscard]] bool passes_over(std::size_t number) const noexcept;
  [[nodiscard]] Packets part_from(std::size_t number, std::uint64_t offset) const noexcept;
  [[nodiscard]] std::size_t part_of(std::uint64_t offset) const noexcept;
  [[nodiscard]] std::uint64_t last_frame() const noexcept;
  [[nodiscard]] std::vector<std::size_t> parts_for(std::uint64_t frame) const;

  std::vector<Part> parts_;          ///< the last one: the packets behind the index parts
  std::vector<std::size_t> needed_;  ///< numbers of parts, ascending; empty: all
  std::uint64_t first_entry_ = 0;
  std::uint64_t end_ = 0;
  std::size_t held_ = 0;  ///< packets of all parts that were read
  bool finished_ = false;
};

template <typename Visit>
Status ContainerIndex::for_each(EntryReader& reader, const Visit& visit) {
  for (std::size_t number = 0; number < parts_.size(); ++number) {
    if (const Status status = read_some(reader, number, true); status != Status::ok) return status;
    const auto& packets = parts_[number].packets;
    const std::uint64_t end = std::min(parts_[number].place.offset, end_);
    for (std::size_t i = 0; i < packets.size(); ++i) {
      visit(packets[i], (i + 1 < packets.size() ? packets[i + 1].offset : end) - packets[i].offset);
    }
  }
  return Status::ok;
}

}  // namespace gicodec
