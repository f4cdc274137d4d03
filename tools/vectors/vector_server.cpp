#include "vector_server.h"

#include "ddgi/lighting.h"
#include "ddgi/rays.h"
#include "ddgi/volume.h"
#include "kinds/tracing.h"

#include <atomic>

namespace gicodec::vectors {

using namespace ddgi;

namespace {

constexpr std::uint32_t kBuried = 4;  // one in so many rays that end at insides

/// Adds what comes along a unit vector to the three hemispheres that it is in.
void add(Vertex& sum, Vec3 direction, Vec3 radiance) {
  for (const std::size_t h :
       {direction.x >= 0 ? std::size_t{0} : 1, direction.y >= 0 ? std::size_t{2} : 3,
        direction.z >= 0 ? std::size_t{4} : 5}) {
    sum[h].red += direction * radiance.x;
    sum[h].green += direction * radiance.y;
    sum[h].blue += direction * radiance.z;
  }
}

}  // namespace

VolumeGeometry geometry_of(const Box& box, Grid grid) {
  VolumeGeometry geometry = ddgi::geometry_of(ddgi::spread(grid, box));
  for (float& step : geometry.spacing) step = step > 0 ? step : 1;
  return geometry;
}

VectorServer::VectorServer(const Scene& scene, const VectorOptions& options, unsigned threads,
                           std::function<bool()> cancelled)
    : options_(options),
      scene_(scene),
      pool_(threads, std::move(cancelled)),
      directions_(fibonacci_directions(options.gather.rays)),
      field_(geometry_of(options.box, options.grid)) {}

void VectorServer::update(double time) {
  for (; updates_ < options_.gather.warmup; ++updates_) step(time);
  step(time);
  ++updates_;
}

void VectorServer::step(double time) {
  scene_.set_state(scene_.scene().state_at(time));
  VectorField next(field_.geometry);
  const std::uint32_t seed = options_.gather.seed_of(updates_);
  const auto turned = [&](std::uint32_t number) {
    const Affine turn = random_rotation(seed, number);
    std::vector<Vec3> directions = directions_;
    for (Vec3& d : directions) d = turn.vector(d);
    return directions;
  };
  const std::vector<Vec3> of_all = turned(0);
  std::atomic<std::uint64_t> rays{0};
  pool_.run(next.vertices.size(), [&](std::size_t i) {
    const auto vertex = static_cast<std::uint32_t>(i);
    std::uint64_t mine = 0;
    const bool lit = options_.gather.turned ? gather(vertex, turned(vertex), next.vertices[i], mine)
                                            : gather(vertex, of_all, next.vertices[i], mine);
    next.known[i] = lit ? 1 : 0;
    rays += mine;
  });
  rays_ = rays;
  field_ = std::move(next);
}

bool VectorServer::gather(std::uint32_t vertex, std::span<const Vec3> directions, Vertex& out,
                          std::uint64_t& rays) const {
  const Vec3 origin = vec(block_position(field_.geometry, vertex));
  const auto n = static_cast<float>(directions.size());
  const auto light = [&](const Surface& hit) {
    return direct_light(scene_, hit, rays) +
           field_.irradiance(hit.position, hit.normal, Interpolation::trilinear);
  };
  Vertex sum{};
  const std::size_t inside = ddgi::gather(
      scene_, origin, directions, 4 * kPi, rays, light,
      [&](std::size_t i, Vec3 radiance, const Surface*) { add(sum, directions[i], radiance); });
  if (kBuried * inside >= directions.size()) return false;
  const float share = 4 / (n - static_cast<float>(inside));
  for (std::size_t h = 0; h < kHemispheres; ++h) {
    out[h] = {sum[h].red * share, sum[h].green * share, sum[h].blue * share};
  }
  return true;
}

std::vector<std::byte> VectorServer::texels() const {
  const VectorCode code(options_.floats);
  std::vector<std::byte> out(field_.vertices.size() * kHemispheres * code.bytes());
  std::byte* record = out.data();
  for (std::size_t i = 0; i < field_.vertices.size(); ++i) {
    for (std::size_t h = 0; h < kHemispheres; ++h, record += code.bytes()) {
      if (field_.known[i] != 0) code.store(record, compress(field_.vertices[i][h], h));
    }
  }
  return out;
}

}  // namespace gicodec::vectors
