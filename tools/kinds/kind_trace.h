// gi-trace: frames of any kind into one container.
#pragma once

#include "kind_flags.h"
#include "source_container.h"

#include "dump/error.h"

#include <cstdint>
#include <string>

namespace gicodec::kinds {

struct KindTrace {
  const KindFlags& flags;
  ddgi::Scene scene;
  std::string label;  ///< the scene's name
  std::string output, backend = "native";
  FrameTimes times;
  std::uint32_t frames = 1, seed = 1;
  unsigned threads = 0;
  bool quiet = false;
};

/// Throws tools::Error, and ddgi::Interrupted.
tools::Exit write_trace(KindTrace trace);

}  // namespace gicodec::kinds
