// Which probes clients need for what they look at (Stengel et al. §3.4, client view probe culling):
// those that shade what rays through the view meet, and some around them.
#pragma once

#include "ddgi/ray_scene.h"

#include <gicodec/host.h>

#include <utility>
#include <vector>

namespace gicodec::streaming {

struct ViewRequest {
  double time = 0;  ///< of the scene
  std::vector<VolumeGeometry> volumes;
  std::vector<std::pair<PeerId, Viewpoint>> viewers;
};

struct ViewResult {
  struct Seen {
    PeerId peer = 0;
    std::vector<BlockMask> volumes;
  };
  std::vector<Seen> seen;
  double seconds = 0;
};

/// One thread at a time.
class Views {
 public:
  /// About `samples` rays are spent on each viewpoint; probes up to `margin` cells beyond those
  /// that shade what they meet are needed as well.
  Views(ddgi::Scene scene, std::uint32_t samples, std::uint32_t margin);
  [[nodiscard]] ViewResult look(const ViewRequest& request);

 private:
  [[nodiscard]] std::vector<Position> hits(const Viewpoint& view) const;

  ddgi::Scene scene_;
  ddgi::RayScene rays_;
  std::uint32_t samples_;
  int margin_;
};

}  // namespace gicodec::streaming
