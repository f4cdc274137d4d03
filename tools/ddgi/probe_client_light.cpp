#include "probe_client_light.h"

#include <algorithm>

namespace gicodec::ddgi {

Vec3 ProbeClientLight::irradiance(const SeenSurface& seen) const {
  const Surface& hit = seen.surface;
  // From the finer volume where that has active probes around the point.
  if (fine_ != nullptr && fine_->holds(hit.position)) {
    const Cage cage = fine_->cage(hit.position, hit.normal, seen.to_viewer);
    const auto lit = [](float weight) { return weight > 0; };
    if (std::any_of(cage.weight.begin(), cage.weight.end(), lit))
      return fine_->irradiance(cage, fine_->fetch(hit.normal));
  }
  return field_.irradiance(hit.position, hit.normal, seen.to_viewer);
}

}  // namespace gicodec::ddgi
