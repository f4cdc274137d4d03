// Bytes, tables and entropy decoding of the reference decoder (docs/native.md, sections 5 and 8).
#pragma once

#include "native/tables.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

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
  std::uint64_t varint() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 35; shift += 7) {
      const unsigned b = u8();
      value |= std::uint64_t{b & 127} << shift;
      if (b < 128) {
        if (b == 0 && shift > 0) failed_ = true;
        return value;
      }
    }
    failed_ = true;
    return 0;
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

class Tables {
 public:
  Tables() = default;
  Tables(unsigned set, bool update) : set_(set), update_(update ? 1 : 0) {}

  bool read_overrides(Bytes& in, bool pairs) {
    const unsigned members = in.u8();
    if (members > 16) return false;
    for (unsigned m = 0; m < members; ++m) {
      const unsigned n = in.u8();
      if (n < 1 || n > 40) return false;
      std::array<std::uint16_t, 40> f;
      std::uint64_t others = 0;
      for (unsigned t = 1; t < 40; ++t) {
        const std::uint64_t less_one = t < n ? in.varint() : 0;
        if (less_one > 4096) return false;
        f[t] = static_cast<std::uint16_t>(less_one + 1);
        others += f[t];
      }
      if (others >= 4096) return false;
      f[0] = static_cast<std::uint16_t>(4096 - others);
      members_.push_back(f);
    }
    const auto tokens = in.varint();
    if (tokens > 10368) return false;
    std::uint64_t next = 0;
    for (std::uint64_t i = 0; i < tokens; ++i) {
      const std::uint64_t context = next + in.varint();
      const unsigned member = in.u8();
      if (in.failed() || context >= 10368 || member >= 64 + members) return false;
      token_overrides_[static_cast<unsigned>(context)] = member;
      next = context + 1;
    }
    if (!pairs) return true;
    const auto hits = in.varint();
    if (hits > 64) return false;
    int last = -1;
    for (std::uint64_t i = 0; i < hits; ++i) {
      const auto context = static_cast<int>(in.u8());
      const unsigned end0 = in.u16(), end1 = in.u16();
      if (in.failed() || context <= last || context >= 64) return false;
      if (end0 < 1 || end0 >= end1 || end1 > 4095) return false;
      hit_overrides_[static_cast<unsigned>(context)] = {end0, end1};
      last = context;
    }
    return true;
  }
  [[nodiscard]] const std::uint16_t* frequencies(unsigned context) const {
    unsigned member = 0;
    if (const auto o = token_overrides_.find(context); o != token_overrides_.end()) {
      member = o->second;
    } else if (context % 128 < 120) {
      constexpr std::string_view kDigits =
          "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
      const char digit = native::kTableData.map[set_][context / 128][context % 128];
      member = static_cast<unsigned>(kDigits.find(digit));
    }
    return member < 64 ? native::kTableData.frequency[member] : members_[member - 64].data();
  }
  [[nodiscard]] std::pair<unsigned, unsigned> hit_ends(unsigned context) const {
    if (const auto o = hit_overrides_.find(context); o != hit_overrides_.end()) return o->second;
    const auto& ends = native::kTableData.hits[set_][update_];
    return {ends[0][context], ends[1][context]};
  }

 private:
  unsigned set_ = 0, update_ = 0;
  std::vector<std::array<std::uint16_t, 40>> members_;
  std::map<unsigned, unsigned> token_overrides_;
  std::map<unsigned, std::pair<unsigned, unsigned>> hit_overrides_;
};

/// The lanes' states. A step is told the context of every active lane; others have none.
class Lanes {
 public:
  static constexpr int kInactive = -1;

  Lanes(Bytes& in, unsigned lanes) : in_(in), state_(lanes) {
    for (auto& x : state_) x = in.u32();
    if (in.left() % 2 != 0) broken_ = true;
    for (const auto x : state_) broken_ = broken_ || x < 32768 || x >= 1U << 31;
  }
  [[nodiscard]] bool valid() const { return !broken_ && !in_.failed(); }
  [[nodiscard]] bool finished() const {
    bool ended = in_.at_end();
    for (const auto x : state_) ended = ended && x == 32768;
    return ended;
  }

  std::vector<unsigned> tokens(const Tables& tables, const std::vector<int>& context) {
    std::vector<unsigned> token(context.size()), value(context.size());
    for (std::size_t l = 0; l < context.size(); ++l) {
      if (context[l] == kInactive) continue;
      const auto* f = tables.frequencies(static_cast<unsigned>(context[l]));
      const unsigned slot = state_[l] % 4096;
      unsigned start = 0, s = 0;
      while (start + f[s] <= slot) start += f[s++];
      state_[l] = f[s] * (state_[l] >> 12) + slot - start;
      token[l] = value[l] = s;
    }
    refill(context);
    std::vector<int> raw(context.size(), kInactive);
    for (std::size_t l = 0; l < context.size(); ++l) {
      if (context[l] == kInactive || token[l] < 16) continue;
      raw[l] = 0;
      const unsigned r = 3 + (token[l] - 16) / 2;
      value[l] = (2 + (token[l] - 16) % 2) << r | (state_[l] & ((1U << r) - 1));
      state_[l] >>= r;
    }
    refill(raw);
    return value;
  }
  std::vector<unsigned> hits(const Tables& tables, const std::vector<int>& context) {
    std::vector<unsigned> symbol(context.size());
    for (std::size_t l = 0; l < context.size(); ++l) {
      const auto [end0, end1] = tables.hit_ends(static_cast<unsigned>(context[l]));
      const unsigned slot = state_[l] % 4096;
      symbol[l] = slot < end0 ? 0 : slot < end1 ? 1 : 2;
      const unsigned start = symbol[l] == 0 ? 0 : symbol[l] == 1 ? end0 : end1;
      const unsigned end = symbol[l] == 0 ? end0 : symbol[l] == 1 ? end1 : 4096;
      state_[l] = (end - start) * (state_[l] >> 12) + slot - start;
    }
    refill(context);
    return symbol;
  }

 private:
  void refill(const std::vector<int>& context) {
    for (std::size_t l = 0; l < context.size(); ++l) {
      if (context[l] != kInactive && state_[l] < 32768) state_[l] = state_[l] << 16 | in_.u16();
    }
  }
  Bytes& in_;
  std::vector<std::uint32_t> state_;
  bool broken_ = false;
};

}  // namespace gicodec::reference
