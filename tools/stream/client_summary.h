// The summary that gi-client prints at its end.
#pragma once

#include "simulate.h"
#include "viewer.h"

#include <cstdint>
#include <string>
#include <vector>

namespace gicodec::streaming {

struct Recorded {
  std::vector<std::string> files, left;  ///< those with their names, and those still FILE.partial
  std::uint64_t bytes = 0;               ///< of both
};

/// A line of text, or of JSON.
void summarise(const ViewerResult& result, const Recorded& recorded, bool json);
void summarise(const SimulateResult& result, std::uint32_t clients, bool json);

}  // namespace gicodec::streaming
