// What trace.json says of the dumps beside it: DDS files have no metadata, so that a reader of
// these finds there what others say themselves.
#pragma once

#include "dump/dump.h"

#include <cstdint>
#include <optional>
#include <string>

namespace gicodec::ddgi {

struct TracedFolder {
  Grid grid;           ///< of the probes
  std::string layout;  ///< of engines; empty for the tracer's own textures
  double start = 0, fps = 10;
  tools::Attributes attributes;  ///< of every colour texture and frame: scene, place, encoding

  /// What reads a texture, if it is one of probes.
  [[nodiscard]] tools::Hints hints(const std::string& texture) const;
  /// With the frame's time.
  [[nodiscard]] tools::Attributes attributes_at(std::uint64_t frame) const;
};

/// nullopt if no trace wrote the folder. Throws tools::Error of Exit::bad_input for a trace.json
/// that is damaged.
[[nodiscard]] std::optional<TracedFolder> read_traced_folder(const std::string& folder);

}  // namespace gicodec::ddgi
