#include "probe_light.h"

#include "probe_rays.h"

namespace gicodec::ddgi {

ProbeLight measure_light(std::span<const Vec3> directions, std::span<const ProbeRay> rays,
                         float sun) {
  ProbeLight light;
  light.sh = project_sh(directions, rays);
  light.sun = sun;
  std::array<float, 6> weight{};
  float count = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (rays[i].end == RayEnd::back) continue;
    ++count;
    const Vec3 d = directions[i];
    const std::array<float, 6> cosine{-d.x, d.x, -d.y, d.y, -d.z, d.z};
    for (std::size_t face = 0; face < cosine.size(); ++face) {
      if (cosine[face] <= 0) continue;
      light.cube[face] += rays[i].radiance * cosine[face];
      weight[face] += cosine[face];
    }
    if (rays[i].end != RayEnd::sky) continue;
    const std::array<float, 4> basis{1, d.x, d.y, d.z};
    for (std::size_t k = 0; k < basis.size(); ++k)
      light.sky[k] += basis[k] * (k == 0 ? 1.0F : 2.0F);
  }
  for (std::size_t face = 0; face < weight.size(); ++face)
    light.cube[face] = weight[face] > 0 ? light.cube[face] / weight[face] : Vec3{};
  for (float& factor : light.sky) factor = count > 0 ? factor / count : 0;
  return light;
}

ProbeLight mix(const ProbeLight& light, const ProbeLight& old, float hysteresis) {
  ProbeLight mixed;
  for (std::size_t k = 0; k < mixed.sh.size(); ++k)
    mixed.sh[k] = lerp(light.sh[k], old.sh[k], hysteresis);
  for (std::size_t face = 0; face < mixed.cube.size(); ++face)
    mixed.cube[face] = lerp(light.cube[face], old.cube[face], hysteresis);
  for (std::size_t k = 0; k < mixed.sky.size(); ++k)
    mixed.sky[k] = ddgi::mix(light.sky[k], old.sky[k], hysteresis);
  mixed.sun = ddgi::mix(light.sun, old.sun, hysteresis);
  return mixed;
}

}  // namespace gicodec::ddgi
