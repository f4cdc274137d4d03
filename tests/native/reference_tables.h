// Bytes and tables of the reference decoder (docs/native.md, section 8).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace gicodec::reference {

class Bytes {
 public:
  explicit Bytes(std::span<const std::byte> bytes) : rest_(bytes) {}
  unsigned u8() {
    const auto b = take(1);
    return b.empty() ? 0 : static_cast<unsigned>(b[0]);
  }
  unsigned u16() {
    const unsigned low = u8();
    return low | u8() << 8;
  }
  std::uint32_t u32() {
    const std::uint32_t low = u16();
    return low | u16() << 16;
  }
  std::span<const std::byte> take(std::size_t n) {
    if (n > rest_.size()) {
      failed_ = true;
      rest_ = {};
      return {};
    }
    const auto taken = rest_.first(n);
    rest_ = rest_.subspan(n);
    return taken;
  }
  [[nodiscard]] bool failed() const { return failed_; }
  [[nodiscard]] bool at_end() const { return !failed_ && rest_.empty(); }
  [[nodiscard]] std::size_t left() const { return rest_.size(); }

 private:
  std::span<const std::byte> rest_;
  bool failed_ = false;
};

struct Distribution {
  unsigned k = 0, h = 0;
  std::array<unsigned, 15> units{};
};
struct DistributionTables {
  std::array<Distribution, 16> distributions;
  std::array<unsigned, 256> map{};  ///< contexts to distributions
};
struct RepeatDistribution {
  unsigned end0 = 0, end1 = 0;
};
struct RepeatTables {
  std::array<RepeatDistribution, 16> distributions;
  std::array<unsigned, 64> map{};
};

/// Those of a chunk.
struct Tables {
  std::array<DistributionTables, 3> planes;  ///< of planes 0, 1 and all others
  DistributionTables modes;
  RepeatTables repeats;
};
using Sets = std::array<unsigned, 4>;

/// From the published file, which must be as the page says.
[[nodiscard]] Tables tables_of(const Sets& sets, bool pairs, bool update);

[[nodiscard]] bool read_sets(Bytes& in, Sets& sets);
/// Their number, then so many; 0 if they are refused.
[[nodiscard]] unsigned read_repeats(Bytes& in, std::array<RepeatDistribution, 16>& distributions);
[[nodiscard]] bool read_repeat_tables(Bytes& in, RepeatTables& repeats);
[[nodiscard]] bool read_distribution(Bytes& in, Distribution& m);          ///< without its number
[[nodiscard]] bool read_overrides(Bytes& in, DistributionTables& tables);  ///< those of one role

}  // namespace gicodec::reference
