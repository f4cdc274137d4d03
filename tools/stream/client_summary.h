// What gi-client says at its end, on standard output.
#pragma once

#include "simulate.h"
#include "viewer.h"

#include <cstdint>
#include <string>
#include <vector>

namespace gicodec::streaming {

struct Recorded {
  std::vector<std::string> files;
  std::uint64_t bytes = 0;
};

/// A line of text, or of JSON.
void summarise(const ViewerResult& result, const Recorded& recorded, bool json);
void summarise(const SimulateResult& result, std::uint32_t clients, bool json);

}  // namespace gicodec::streaming
