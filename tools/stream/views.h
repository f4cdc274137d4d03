// Views: the blocks that a client needs for its viewpoint. Probes that shade the points which rays
// through the view hit, and some around them (Stengel et al. §3.4, client view probe culling); of
// voxels a cut through the octree (Crassin et al. §4.1).
#pragma once

#include "ddgi/ray_scene.h"
#include "voxels/cut.h"

#include <gicodec/server.h>

#include <memory>
#include <utility>
#include <vector>

namespace gicodec::streaming {

struct ViewedVolume {
  VolumeGeometry geometry;
  std::uint8_t brick_side = 0;  ///< of voxels; 0: probes
  /// Of voxels: the texture "bricks", which says where bricks stand.
  std::shared_ptr<const std::vector<std::byte>> bricks = nullptr;
  voxels::ChangedSlots changed{};
};

struct ViewRequest {
  double time = 0;  ///< of the scene
  std::vector<ViewedVolume> volumes;
  std::vector<std::pair<ConnectionId, Viewpoint>> viewers;
};

struct ViewResult {
  struct Seen {
    ConnectionId connection = 0;
    std::vector<BlockMask> volumes;
  };
  std::vector<Seen> seen;
  double seconds = 0;
};

/// One thread at a time.
class Views {
 public:
  /// Uses about `samples` rays per viewpoint. Adds probes up to `margin` cells around those that
  /// shade the points hit.
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
