// When the frames of a container are, where its metadata says so.
#pragma once

#include <gicodec/container.h>

#include <cstdint>
#include <optional>

namespace gicodec::tools {

/// When frame 0 is, in seconds of the scene, and how many follow in a second; kept as metadata.
struct FrameTimes {
  double start = 0, fps = 10;

  [[nodiscard]] double at(std::uint64_t frame) const {
    return start + static_cast<double>(frame) / fps;
  }
};
void add_times(Metadata& metadata, const FrameTimes& times);
/// Those of a container, if it says.
[[nodiscard]] std::optional<FrameTimes> times_of(const ContainerDescription& description);

}  // namespace gicodec::tools
