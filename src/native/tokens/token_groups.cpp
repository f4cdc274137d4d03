#include "native/tokens/token_groups.h"

#include <algorithm>

namespace gicodec::native {
namespace {

TokenGroup group_of(const PlaneLayout& layout, const std::uint8_t* planes, unsigned count) {
  TokenGroup group;
  group.planes = static_cast<std::uint8_t>(count);
  group.small = 1;
  unsigned widest = 0;
  for (unsigned i = 0; i < count; ++i) {
    group.plane[i] = planes[i];
    group.bits[i] = layout.plane[planes[i]].stored;
    group.small = static_cast<std::uint8_t>(group.small * 3);
    widest = std::max(widest, group.bits[i] + (i > 0 ? 1U : 0U));
  }
  group.widest = static_cast<std::uint8_t>(std::clamp(widest, 2U, 16U));
  group.copies = layout.pairs ? kCopies : 0;
  return group;
}

}  // namespace

TokenGroups token_groups(const PlaneLayout& layout, std::uint32_t coded) noexcept {
  std::array<std::uint8_t, kMaxPlanes> list{};
  unsigned planes = 0;
  for (const std::uint32_t some : {coded & ~layout.low, coded & layout.low}) {
    for (unsigned p = 0; p < layout.planes; ++p) {
      if ((some >> p & 1) != 0) list[planes++] = static_cast<std::uint8_t>(p);
    }
  }
  TokenGroups groups;
  for (unsigned at = 0; at < planes;) {
    const auto is_low = [&](unsigned i) { return (layout.low >> list[i] & 1) != 0; };
    const auto narrow = [&](unsigned i) {
      return i < planes && layout.plane[list[i]].stored <= kNarrowBits;
    };
    const unsigned count = narrow(at) && narrow(at + 1) && narrow(at + 2)    ? 3
                           : at + 1 < planes && is_low(at) == is_low(at + 1) ? 2
                                                                             : 1;
    groups.group[groups.count++] = group_of(layout, list.data() + at, count);
    at += count;
  }
  return groups;
}

}  // namespace gicodec::native
