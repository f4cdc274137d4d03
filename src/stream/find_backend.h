// Backends by name or id among the built-in ones and those the caller brought.
#pragma once

#include <gicodec/backend.h>

#include <span>
#include <vector>

namespace gicodec {

/// Visits the caller's backends first, so that they can replace built-in ones.
template <typename Predicate>
[[nodiscard]] const Backend* find_backend(std::span<const Backend* const> callers,
                                          Predicate&& wanted) {
  for (const auto list : {callers, built_in_backends()}) {
    for (const Backend* backend : list) {
      if (backend != nullptr && wanted(*backend)) return backend;
    }
  }
  return nullptr;
}

}  // namespace gicodec
