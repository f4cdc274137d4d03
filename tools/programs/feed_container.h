// A feed's frames as a container.
#pragma once

#include "kinds/feed.h"

#include "common/container_output.h"
#include "common/frame_times.h"
#include "dump/file.h"

#include <gicodec/volume_encoder.h>

#include <cstdint>
#include <string>
#include <vector>

namespace gicodec::kinds {

using tools::FrameTimes;
using tools::times_of;

class FeedContainer {
 public:
  /// `existing`: what finish() may replace. All calls throw tools::Error.
  FeedContainer(const std::string& path, const Feed& feed, const FrameTimes& times,
                const std::string& backend, tools::Existing existing = tools::Existing::container);
  void add(std::uint64_t frame, const FeedFrame& contents);
  void finish();
  /// Instead of finish(): keeps what was written; returns the file's name, empty if there is none.
  [[nodiscard]] std::string leave() noexcept { return output_.leave(); }

  struct Sum {
    std::string texture;
    std::uint64_t bytes = 0;  ///< size of all packets
  };
  /// The sums so far, by texture.
  [[nodiscard]] const std::vector<Sum>& sums() const { return sums_; }

 private:
  std::vector<VolumeEncoder> encoders_;  ///< by volume
  std::vector<Sum> sums_;
  tools::ContainerOutput output_;
};

}  // namespace gicodec::kinds
