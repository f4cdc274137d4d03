// The published numbers of tables.txt (docs/native.md, "Tables").
#pragma once

#include "native/model.h"

#include <cstddef>
#include <cstdint>

namespace gicodec::native {

inline constexpr std::size_t kMemberNumbers = 2 + kListed;
inline constexpr std::size_t kRoleNumbers = kMembers * kMemberNumbers + kContexts;
inline constexpr std::size_t kHitNumbers = 2 * kMembers + kHitContexts;
inline constexpr std::size_t kTableCount = kRoles * kSets * kRoleNumbers + 2 * kSets * kHitNumbers;
extern const std::uint16_t kTableNumbers[kTableCount];

}  // namespace gicodec::native
