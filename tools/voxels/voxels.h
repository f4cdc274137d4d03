// Voxels as a kind that is traced and drawn (Crassin et al.).
#pragma once

#include "voxel_light.h"
#include "voxel_server.h"

#include "kinds/traced_kind.h"

namespace gicodec::voxels {

extern const kinds::TracedKind kTracedVoxels;

/// In the scene's volume and a metre around it.
[[nodiscard]] VoxelOptions options_of(const kinds::Settings& settings, const ddgi::Scene& scene,
                                      std::uint32_t seed);

}  // namespace gicodec::voxels
