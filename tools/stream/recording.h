// What can be told of a recording before it is played: every packet and file is looked at, none is
// decoded.
#pragma once

#include "dump/sequence.h"

#include <cstdint>
#include <string>
#include <vector>

namespace gicodec::streaming {

struct Recording {
  std::uint64_t frames = 0;          ///< whole ones, from the first to the end or the flaw
  std::string flaw;                  ///< what is wrong behind them, and where; empty for nothing
  std::vector<std::string> remarks;  ///< for the operator: what was lost before
};

/// Reads a container to its end: its records and their checksums, and that each packet builds on
/// the one before it. Throws tools::Error if it is no container.
[[nodiscard]] Recording look_through(const std::string& container);
/// Reads the heads of all files.
[[nodiscard]] Recording look_through(const std::vector<tools::Sequence>& dumps);

}  // namespace gicodec::streaming
