// One frame of probe textures for the client: from a container, through the library's decoder, or
// from the dumps it was made of.
#pragma once

#include "volume.h"

#include "common/backend_flags.h"
#include "dump/dump.h"

#include <cstdint>
#include <optional>
#include <string>

namespace gicodec::ddgi {

struct ProbeFrame {
  std::string source;   ///< file or folder, for messages
  std::string missing;  ///< what an incomplete container lacks; empty if it is whole
  std::string loss;     ///< which texture lost bits to coding; empty if none did
  ProbeTextures textures;
  // What the dumps' attributes say, if they say it.
  std::optional<std::string> scene;
  std::optional<double> time;
  std::optional<Vec3> origin, spacing;
};

/// Takes what the attributes of a dump say about scene, time and place.
void read_attributes(ProbeFrame& frame, const tools::Attributes& attributes);

// Both throw tools::Error: Exit::io for what cannot be opened, Exit::bad_input for damage, for a
// frame that is not there and for textures that are no irradiance volume.
// A container whose end is missing is refused, too, unless `allow_incomplete`.
[[nodiscard]] ProbeFrame load_stream(const std::string& path, std::uint64_t frame,
                                     bool allow_incomplete, const tools::DecoderFlags& decoding);
[[nodiscard]] ProbeFrame load_dumps(const std::string& folder, std::uint64_t frame);

}  // namespace gicodec::ddgi
