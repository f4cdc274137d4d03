#include "traced_kind.h"

#include <algorithm>
#include <array>

namespace gicodec::kinds {
namespace {

constexpr std::array<TracedKind, 0> kTracedKinds{};

}  // namespace

std::span<const TracedKind> traced_kinds() { return kTracedKinds; }

const TracedKind* find_traced_kind(std::string_view name) {
  const auto kinds = traced_kinds();
  const auto found = std::ranges::find(kinds, name, &TracedKind::name);
  return found == kinds.end() ? nullptr : &*found;
}

}  // namespace gicodec::kinds
