// The last change of records of the same direction (docs/native/records.md): points of one
// surface change in the same way.
#pragma once

#include <gicodec/record.h>

#include <algorithm>
#include <array>
#include <cstdint>

namespace gicodec::native {

/// The last known record of a chunk whose components of kind snorm equal those of another.
struct SimilarRecord {
  bool seen = false, changed = false;
  std::array<std::int16_t, kMaxComponents> previous{}, residual{};
  std::array<std::int16_t, kMaxComponents> before{};  ///< residuals of its own similar record
};

class SimilarRecords {
 public:
  using Values = std::array<std::uint32_t, kMaxComponents>;

  void reset(const Record& record) {
    record_ = record;
    similar_.fill({});
  }
  [[nodiscard]] const SimilarRecord& of(const Values& previous) const {
    return similar_[key(previous)];
  }
  void put(const Values& previous, bool changed,
           const std::array<std::int32_t, kMaxComponents>& residual) {
    constexpr std::int32_t kMax = 255;
    SimilarRecord& similar = similar_[key(previous)];
    similar.seen = true;
    similar.changed = changed;
    similar.before = similar.residual;
    for (unsigned c = 0; c < record_.count; ++c) {
      similar.previous[c] = static_cast<std::int16_t>(previous[c] & kMax);
      similar.residual[c] = static_cast<std::int16_t>(std::clamp(residual[c], -kMax, kMax));
    }
  }

 private:
  [[nodiscard]] std::size_t key(const Values& previous) const {
    std::uint32_t key = 0;
    for (unsigned c = 0; c < record_.count; ++c) {
      if (record_.components[c].type == ComponentType::snorm) key = key << 4 | (previous[c] & 15);
    }
    return key % kKeys;
  }

  static constexpr std::size_t kKeys = 256;
  Record record_;
  std::array<SimilarRecord, kKeys> similar_;
};

}  // namespace gicodec::native
