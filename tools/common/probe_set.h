// Sets of probes as ranges, so that a short text for millions of probes takes few bytes.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gicodec::tools {

class ProbeSet {
 public:
  struct Range {
    std::uint32_t first = 0, last = 0;
  };

  ProbeSet() = default;
  /// Parses "3,7-12" with blanks, lines and # comments. Throws Error of Exit::bad_input, also for a
  /// probe that occurs twice.
  ProbeSet(std::string_view text, const std::string& where);

  /// "3,7-12": ascending, in the shortest form.
  [[nodiscard]] std::string text() const;
  [[nodiscard]] bool empty() const noexcept { return ranges_.empty(); }
  [[nodiscard]] std::uint64_t size() const noexcept;
  [[nodiscard]] bool contains(std::uint32_t probe) const noexcept;
  /// Precondition: not empty().
  [[nodiscard]] std::uint32_t last() const noexcept { return ranges_.back().last; }
  /// Ascending and not adjacent.
  [[nodiscard]] std::span<const Range> ranges() const noexcept { return ranges_; }

 private:
  std::vector<Range> ranges_;
};

/// Reads a text file of indices and ranges a-b.
[[nodiscard]] ProbeSet read_probe_set(const std::string& path);

}  // namespace gicodec::tools
