// Basis functions of a map (Crassin et al. §4.2, step 2): texels that see each other and have like
// normals share what is gathered.
#pragma once

#include "gather.h"

#include <gicodec/irradiance_maps.h>

#include <array>

namespace gicodec::maps {

/// Bases of a texel and their weights, 255 in all; unused ones weigh nothing, whatever their basis.
struct Blend {
  std::array<std::uint16_t, kMapBlends> basis{};
  std::array<std::uint8_t, kMapBlends> weight{};
};
static_assert(sizeof(Blend) == 24);  // the record of the format

struct Bases {
  std::vector<MapTexel> centres;  ///< where they gather, along a curve over the surfaces
  std::vector<Blend> blends;      ///< of the texels, in their order
  float spacing = 0;              ///< metres; the radius of influence is twice that
  std::uint64_t rays = 0;         ///< that asked what sees what
};

/// Cosine that the normals of a texel and of its bases have at least.
inline constexpr float kLikeBasis = 0.75F;

/// As many bases as `target`, or a few more or less, at most kMaxMapBases; of bases of objects that
/// move only their own texels have some. The scene is at rest. `spacing`: in metres, or 0 for that
/// which gives the target. Throws tools::Error of Exit::usage where they are more than can be.
[[nodiscard]] Bases make_bases(const Parameterisation& map, const ddgi::RayScene& scene,
                               std::span<const MapTexel> texels, std::uint32_t target,
                               float spacing, ddgi::ThreadPool& pool);

/// Irradiance of texels by that of their bases; by place. Of blends that name other bases, or
/// weigh more or less than 255, whatever comes of it.
void reconstruct(std::span<const MapTexel> texels, std::span<const Blend> blends,
                 std::span<const Vec3> bases, std::span<Vec3> out);

}  // namespace gicodec::maps
