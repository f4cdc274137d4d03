// The server of voxels: gathers light at every voxel of a sparse octree (Crassin et al. §4.1).
#pragma once

#include "brick_pool.h"
#include "voxel_field.h"

#include "ddgi/gather.h"

namespace gicodec::voxels {

struct VoxelOptions {
  float size = 0.5F;  ///< metres along a side of the finest
  BrickShape shape;
  VoxelForm form = VoxelForm::shared_exponent;
  std::uint32_t slots = 0;  ///< for bricks; 0: what the first frame takes, and a quarter more
  ddgi::GatherOptions gather{.rays = 16};  ///< of each direction of a voxel
  bool all_directions = false;             ///< of each voxel, or those that a surface in it faces
  ddgi::Box box;                           ///< that there are voxels in
};

class VoxelServer {
 public:
  /// Throws tools::Error. The scene must outlive it.
  VoxelServer(const ddgi::Scene& scene, const VoxelOptions& options, unsigned threads,
              std::function<bool()> cancelled);

  /// Gathers one update of the scene at `time`: one bounce more of indirect light.
  void update(double time);
  [[nodiscard]] const VoxelOptions& options() const { return options_; }
  /// Its slots are those of the options, or of the first frame.
  [[nodiscard]] const BrickPool& pool() const { return pool_; }
  [[nodiscard]] VolumeGeometry geometry() const;
  /// Voxels of all levels; with light after the first update.
  [[nodiscard]] const Octree& octree() const { return octree_; }
  /// What the last update gives, as a client has it that received all.
  [[nodiscard]] const VoxelField& field() const { return field_; }
  [[nodiscard]] std::uint64_t rays() const { return rays_; }          ///< of the last update
  [[nodiscard]] std::uint64_t left_out() const { return left_out_; }  ///< bricks without a slot

 private:
  void step(double time);
  [[nodiscard]] std::vector<Vec3> directions_of(std::uint32_t seed) const;
  [[nodiscard]] Voxel gather(const SurfaceVoxel& voxel, std::span<const Vec3> directions,
                             std::uint64_t& rays) const;

  VoxelOptions options_;
  ddgi::RayScene scene_;
  ddgi::ThreadPool threads_;
  VoxelGrid grid_;
  Voxeliser voxeliser_;
  VoxelCode code_;
  std::vector<SurfaceVoxel> leaves_;
  Octree octree_;
  BrickPool pool_;
  VoxelField field_;
  std::uint64_t rays_ = 0, left_out_ = 0;
  std::uint32_t updates_ = 0;
};

}  // namespace gicodec::voxels
