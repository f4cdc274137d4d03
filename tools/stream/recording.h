// Checks a recording before it is played: reads every packet and file, decodes none.
#pragma once

#include "dump/sequence.h"

#include <cstdint>
#include <string>
#include <vector>

namespace gicodec::streaming {

struct Recording {
  std::uint64_t frames = 0;          ///< complete ones before the end or the flaw
  std::string flaw;                  ///< the fault behind them, and its place; empty: none
  std::vector<std::string> remarks;  ///< for the operator, on earlier losses
};

/// Reads a container to its end. Checks that checksums match and that each packet builds on the one
/// before it. Throws tools::Error if it is no container.
[[nodiscard]] Recording look_through(const std::string& container);
/// Reads the headers of all files.
[[nodiscard]] Recording look_through(const std::vector<tools::Sequence>& dumps);

}  // namespace gicodec::streaming
