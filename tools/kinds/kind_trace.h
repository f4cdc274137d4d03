// gi-trace for other kinds than probes: their frames into one container.
#pragma once

#include "kind_flags.h"
#include "source_container.h"

#include "dump/error.h"

#include <cstdint>
#include <string>

namespace gicodec::kinds {

struct KindTrace {
  const TracedKind& kind;
  const KindFlags& flags;
  const ddgi::SceneFlags& scene;
  std::string output, backend = "native";
  FrameTimes times;
  std::uint32_t frames = 1, seed = 1;
  unsigned threads = 0;
  bool quiet = false;
};

/// Throws tools::Error, and ddgi::Interrupted.
tools::Exit write_trace(const KindTrace& trace);

}  // namespace gicodec::kinds
