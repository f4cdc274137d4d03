// What became of records that look the same way (docs/native.md, "Records"): points of one surface
// open and close alike.
#pragma once

#include <gicodec/record.h>

#include <algorithm>
#include <array>
#include <cstdint>

namespace gicodec::native {

/// The last known record of a chunk whose components of kind snorm were as those of another.
struct Kin {
  bool seen = false, changed = false;
  std::array<std::int16_t, kMaxComponents> past{}, residual{};
  std::array<std::int16_t, kMaxComponents> before{};  ///< residuals of its own kin
};

class KinTable {
 public:
  using Values = std::array<std::uint32_t, kMaxComponents>;

  void reset(const Record& record) {
    record_ = record;
    kin_.fill({});
  }
  [[nodiscard]] const Kin& of(const Values& past) const { return kin_[key(past)]; }
  void put(const Values& past, bool changed,
           const std::array<std::int32_t, kMaxComponents>& residual) {
    constexpr std::int32_t kMost = 255;
    Kin& kin = kin_[key(past)];
    kin.seen = true;
    kin.changed = changed;
    kin.before = kin.residual;
    for (unsigned c = 0; c < record_.count; ++c) {
      kin.past[c] = static_cast<std::int16_t>(past[c] & kMost);
      kin.residual[c] = static_cast<std::int16_t>(std::clamp(residual[c], -kMost, kMost));
    }
  }

 private:
  [[nodiscard]] std::size_t key(const Values& past) const {
    std::uint32_t key = 0;
    for (unsigned c = 0; c < record_.count; ++c) {
      if (record_.components[c].kind == ComponentKind::snorm) key = key << 4 | (past[c] & 15);
    }
    return key % kKeys;
  }

  static constexpr std::size_t kKeys = 256;
  Record record_;
  std::array<Kin, kKeys> kin_;
};

}  // namespace gicodec::native
