// What the index parts of a container will say of the packets that were written.
#pragma once

#include "bitstream/container_format.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace gicodec {

/// What can fail comes first: make_room(), next_part(), then the caller writes, then add() and
/// close().
class IndexWriter {
 public:
  explicit IndexWriter(const ContainerDescription& description);

  /// For add() of this packet.
  void make_room(const SeekEntry& packet);
  /// Lists a packet.
  void add(const SeekEntry& packet) noexcept;

  /// True if a part is due once `more` packets are added.
  [[nodiscard]] bool is_due(std::size_t more) const noexcept;
  /// True if packets were added since the last part, and are worth one.
  [[nodiscard]] bool is_worth_a_part() const noexcept;
  /// True if no part is needed at the end: the last one lists all.
  [[nodiscard]] bool is_complete() const noexcept {
    return unlisted_.empty() && directory_ == parts_.size();
  }
  /// The part of the packets since the one before and `last`. `all`: it lists all parts.
  [[nodiscard]] IndexPart next_part(const SeekEntry* last, bool all);
  /// Says where the entry of that part stands, after add() of its last packet.
  void close(std::uint64_t offset, std::uint64_t size) noexcept;
  /// Offset of the last part; 0: there is none.
  [[nodiscard]] std::uint64_t last_part() const noexcept {
    return parts_.empty() ? 0 : parts_.back().offset;
  }

 private:
  /// The parts in which the packets lie on which a region of a texture builds.
  struct Span {
    std::uint64_t first = kNone, last = 0;
  };
  /// Spans that begin and end at a part.
  struct Ends {
    std::uint64_t begin = 0, end = 0;
  };
  static constexpr std::uint64_t kNone = UINT64_MAX;
  void begin_part();
  [[nodiscard]] std::vector<PartRun> runs() const;

  std::vector<std::optional<std::uint8_t>> presence_;  ///< by texture
  std::vector<SeekEntry> unlisted_;                    ///< packets since the last part
  std::vector<PartRun> needs_;                         ///< of the part of these
  std::vector<PartPlace> parts_;
  std::size_t directory_ = 0;  ///< the last part that lists all: 1 + its number; 0: none
  bool next_is_directory_ = false;
  std::uint64_t listed_ = 0;             ///< packets in all parts
  std::map<std::uint64_t, Span> spans_;  ///< by region_key()
  std::map<std::uint64_t, Ends> ends_;   ///< by part
};

}  // namespace gicodec
