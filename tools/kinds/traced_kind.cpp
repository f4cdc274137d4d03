#include "traced_kind.h"

#include "ao/ao.h"
#include "maps/maps.h"
#include "photons/photons.h"

#include <algorithm>
#include <array>

namespace gicodec::kinds {

std::span<const TracedKind> traced_kinds() {
  static const std::array kinds{maps::kTracedMaps, ao::kTracedAoPoints, photons::kTracedPhotons};
  return kinds;
}

const TracedKind* find_traced_kind(std::string_view name) {
  const auto kinds = traced_kinds();
  const auto found = std::ranges::find(kinds, name, &TracedKind::name);
  return found == kinds.end() ? nullptr : &*found;
}

}  // namespace gicodec::kinds
