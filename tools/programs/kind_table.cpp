#include "kind_table.h"

#include "ao/ao.h"
#include "maps/maps.h"
#include "photons/photons.h"
#include "probes/probes.h"
#include "vectors/vectors.h"
#include "voxels/voxels.h"

#include "dump/error.h"

#include <algorithm>
#include <array>

namespace gicodec::kinds {

std::span<const TracedKind> traced_kinds() {
  static const std::array kinds{probes::kTracedProbes,   vectors::kTracedVectors,
                                maps::kTracedMaps,       ao::kTracedAoPoints,
                                photons::kTracedPhotons, voxels::kTracedVoxels};
  return kinds;
}

std::unique_ptr<VolumeLight> make_light(const TracedKind& kind, const ddgi::RayScene& scene,
                                        const VolumeDesc& desc, const DrawingFlags& flags) {
  const Settings drawing(kind.name, kind.drawing, flags.set);
  std::uint64_t textures = 0;
  for (const NamedTexture* texture : textures_of(desc)) textures += texture_bytes(texture->desc);
  const std::uint64_t wanted = ((textures + kind.light_memory(desc, textures)) >> 20) + 1;
  if (wanted > flags.memory) {
    tools::fail(tools::Exit::bad_input,
                "drawing {} takes up to {} MiB, and {} are allowed; --max-memory {} allows it",
                kind.name, wanted, flags.memory, wanted);
  }
  return kind.light(scene, desc, drawing);
}

bool is_culled(const FeedVolume& volume) {
  const TracedKind* const traced = find_traced_kind(volume.desc.kind);
  return traced != nullptr && traced->culled;
}

const TracedKind* find_traced_kind(std::string_view name) {
  const auto kinds = traced_kinds();
  const auto found = std::ranges::find(kinds, name, &TracedKind::name);
  return found == kinds.end() ? nullptr : &*found;
}

const TracedKind* find_traced_kind(std::uint8_t kind) {
  const Kind* const known = find_kind(kind);
  return known == nullptr ? nullptr : find_traced_kind(known->name);
}

}  // namespace gicodec::kinds
