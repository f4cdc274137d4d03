// The times of a container's frames, from its metadata.
#pragma once

#include <gicodec/container.h>

#include <cstdint>
#include <optional>

namespace gicodec::tools {

/// The time of frame 0, in seconds of the scene, and frames per second. Stored as metadata.
struct FrameTimes {
  double start = 0, fps = 10;

  [[nodiscard]] double at(std::uint64_t frame) const {
    return start + static_cast<double>(frame) / fps;
  }
};
void add_times(Metadata& metadata, const FrameTimes& times);
/// The times of a container, if its metadata has them.
[[nodiscard]] std::optional<FrameTimes> times_of(const ContainerDescription& description);

}  // namespace gicodec::tools
