// Which bricks a viewer needs: a cut through the octree, coarse where a pixel covers much.
#pragma once

#include "brick_pool.h"

#include <gicodec/volume.h>

namespace gicodec::voxels {

struct CutView {
  Vec3 eye;
  float pixel = 0.002F;  ///< width of a pixel's cone per metre of distance
  float detail = 4;      ///< pixels that a voxel covers at least, as VoxelLight has it
};

/// Slots of the bricks that light at the points is looked up in, with a voxel's margin: from the
/// coarsest levels, all of which are in as far as they are a sixteenth of all bricks, down to the
/// level that each point wants. The parent of a brick that is in is in, if the texture "bricks" has
/// it.
[[nodiscard]] BlockMask cut(std::span<const std::byte> bricks, BrickShape shape,
                            const VolumeGeometry& geometry, const CutView& view,
                            std::span<const Vec3> points);

/// Slots whose brick was another one before: a client that holds that one has to hear of it,
/// wherever it looks, else it would look light up where nothing is.
class ChangedSlots {
 public:
  /// The texture "bricks" of the next frame.
  void add(std::span<const std::byte> bricks, BrickShape shape);
  [[nodiscard]] const BlockMask& slots() const { return slots_; }

 private:
  std::vector<std::optional<BrickPlace>> before_;
  BlockMask slots_;
};

}  // namespace gicodec::voxels
