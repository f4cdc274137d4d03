// The published numbers of tables.txt (docs/native.md, "Tables").
#pragma once

#include "native/planes/model.h"

#include <cstddef>
#include <cstdint>

namespace gicodec::native {

inline constexpr std::size_t kDistributionNumbers = 2 + kListed;
inline constexpr std::size_t kRoleNumbers = kDistributions * kDistributionNumbers + kContexts;
inline constexpr std::size_t kRepeatNumbers = 2 * kDistributions + kRepeatContexts;
inline constexpr std::size_t kTableCount =
    kRoles * kSets * kRoleNumbers + 2 * kSets * kRepeatNumbers;
extern const std::uint16_t kTableNumbers[kTableCount];

}  // namespace gicodec::native
