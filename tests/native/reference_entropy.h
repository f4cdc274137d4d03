// Entropy decoding of the reference decoder (docs/native.md, section 5).
#pragma once

#include "native/reference_tables.h"

#include <algorithm>
#include <vector>

namespace gicodec::reference {

/// The lanes' states. A step takes the context of every active lane; others have none.
class Lanes {
 public:
  static constexpr int kInactive = -1;

  Lanes(Bytes& in, unsigned lanes) : in_(in), state_(lanes) {
    for (auto& x : state_) x = in.u32();
    if (in.left() % 2 != 0) broken_ = true;
    for (const auto x : state_) broken_ = broken_ || x < kMin;
  }
  [[nodiscard]] bool valid() const { return !broken_ && !in_.failed(); }
  [[nodiscard]] bool finished() const {
    return in_.at_end() && std::ranges::all_of(state_, [](auto x) { return x == kMin; });
  }

  std::vector<unsigned> tokens(const DistributionTables& tables, const std::vector<int>& context) {
    constexpr unsigned kBase[16] = {1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 24, 32, 64, 128, 0, 0};
    constexpr unsigned kRaw[16] = {0, 0, 0, 0, 0, 0, 0, 2, 2, 3, 3, 5, 6, 7, 16, 0};
    std::vector<unsigned> value(context.size()), bits(context.size());
    for (std::size_t l = 0; l < context.size(); ++l) {
      if (context[l] == kInactive) continue;
      const Distribution& m =
          tables.distributions[tables.map[static_cast<std::size_t>(context[l])]];
      const unsigned slot = state_[l] % 4096;
      unsigned s = 0, start = 0, end = m.units[0] << m.k;
      while (end <= slot) {
        start = end;
        end = ++s < 15 ? start + (m.units[s] << m.k) : 4096;
      }
      state_[l] = (end - start) * (state_[l] >> 12) + slot - start;
      value[l] = kBase[s] << m.h;
      bits[l] = std::min(kRaw[s] + m.h, 16U);
    }
    refill(context);
    std::vector<int> raw(context.size(), kInactive);
    for (std::size_t l = 0; l < context.size(); ++l) {
      if (bits[l] == 0) continue;
      raw[l] = 0;
      value[l] += state_[l] & ((1U << bits[l]) - 1);
      state_[l] >>= bits[l];
    }
    refill(raw);
    return value;
  }
  template <typename Repeats>
  std::vector<unsigned> repeats(const Repeats& tables, const std::vector<int>& context) {
    std::vector<unsigned> symbol(context.size());
    for (std::size_t l = 0; l < context.size(); ++l) {
      if (context[l] == kInactive) continue;
      const auto [end0, end1] =
          tables.distributions[tables.map[static_cast<std::size_t>(context[l])]];
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
  static constexpr std::uint32_t kMin = 65536;

  void refill(const std::vector<int>& context) {
    for (std::size_t l = 0; l < context.size(); ++l) {
      if (context[l] != kInactive && state_[l] < kMin) state_[l] = state_[l] << 16 | in_.u16();
    }
  }
  Bytes& in_;
  std::vector<std::uint32_t> state_;
  bool broken_ = false;
};

}  // namespace gicodec::reference
