#include "ddgi_volume.h"

namespace gicodec::ddgi {

std::vector<std::uint32_t> classify_probes(const RayScene& scene, const VolumeShape& shape,
                                           float backfaces, ThreadPool& pool) {
  constexpr std::uint32_t rays = 256;
  const auto directions = fibonacci_directions(rays);
  std::vector<std::uint8_t> inside(shape.probes());
  pool.run(shape.probes(), [&](std::size_t probe) {
    const Vec3 position = shape.position(static_cast<std::uint32_t>(probe));
    std::uint32_t backs = 0;
    for (const Vec3 d : directions) backs += scene.behind_static_surface(position, d) ? 1 : 0;
    inside[probe] = static_cast<float>(backs) > backfaces * rays;
  });
  std::vector<std::uint32_t> active;
  for (std::uint32_t probe = 0; probe < shape.probes(); ++probe) {
    if (!inside[probe]) active.push_back(probe);
  }
  return active;
}

}  // namespace gicodec::ddgi
