#include "voxel_server.h"

#include "ddgi/lighting.h"
#include "dump/error.h"
#include "kinds/tracing.h"

#include <gicodec/packet.h>

#include <atomic>
#include <cmath>
#include <numeric>

namespace gicodec::voxels {

using namespace ddgi;

namespace {

/// Throws tools::Error of Exit::usage where no decoder would take so many.
std::uint32_t slots_for(const VoxelOptions& options, const Octree& octree) {
  std::uint64_t slots = options.slots;
  if (slots == 0) {
    const auto counts = brick_counts(octree, options.shape);
    const std::uint64_t bricks = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
    slots = std::min<std::uint64_t>(bricks + bricks / 4 + 64, kMaxBlocks);
  }
  const std::uint64_t bytes = slots * options.shape.voxels() * VoxelCode(options.form).bytes();
  const std::uint64_t most = DecodeLimits{}.max_texture_bytes;
  if (bytes > most) {
    tools::fail(tools::Exit::usage,
                "voxels: {} slots for bricks take {} MiB, and decoders let a texture have {}; a "
                "larger --set size, or fewer --set bricks, take less",
                slots, bytes >> 20, most >> 20);
  }
  return static_cast<std::uint32_t>(slots);
}

std::vector<VoxelKey> keys_of(std::span<const SurfaceVoxel> voxels) {
  std::vector<VoxelKey> keys(voxels.size());
  std::ranges::transform(voxels, keys.begin(), &SurfaceVoxel::key);
  return keys;
}

float fraction(float x) { return x - std::floor(x); }

}  // namespace

VoxelServer::VoxelServer(const Scene& scene, const VoxelOptions& options, unsigned threads,
                         std::function<bool()> cancelled)
    : options_(options),
      scene_(scene),
      threads_(threads, std::move(cancelled)),
      grid_(options.box, options.size),
      voxeliser_(scene, grid_, threads_),
      code_(options.form),
      leaves_(voxeliser_.voxels(scene_.state())),
      octree_(grow(keys_of(leaves_), levels_of(grid_.cells, options.shape.side))),
      pool_(slots_for(options, octree_), options.shape, options.form),
      field_(options.shape, options.form) {}

VolumeGeometry VoxelServer::geometry() const {
  const Vec3 o = grid_.origin;
  return {{pool_.slots(), 1, 1}, {o.x, o.y, o.z}, {grid_.size, grid_.size, grid_.size}, {}};
}

void VoxelServer::update(double time) {
  for (; updates_ < options_.gather.warmup; ++updates_) step(time);
  step(time);
  ++updates_;
}

/// Around +z, by their cosine; others for other seeds.
std::vector<Vec3> VoxelServer::directions_of(std::uint32_t seed) const {
  constexpr float kGolden = 0.61803399F;
  Random random(seed);
  const float shift = random.next(), turn = random.next();
  std::vector<Vec3> directions;
  for (std::uint32_t i = 0; i < options_.gather.rays; ++i) {
    const auto number = static_cast<float>(i);
    directions.push_back(kinds::cosine_direction(
        {0, 0, 1}, (number + shift) / static_cast<float>(options_.gather.rays),
        fraction(number * kGolden + turn)));
  }
  return directions;
}

void VoxelServer::step(double time) {
  scene_.set_state(scene_.scene().state_at(time));
  leaves_ = voxeliser_.voxels(scene_.state());
  octree_ = grow(keys_of(leaves_), static_cast<unsigned>(octree_.size()));
  std::vector<std::byte>& records = octree_[0].records;
  records.resize(leaves_.size() * code_.bytes());
  const std::uint32_t seed = options_.gather.seed_of(updates_);
  const std::vector<Vec3> of_all = directions_of(seed);
  std::atomic<std::uint64_t> rays{0};
  kinds::for_all(leaves_.size(), threads_, [&](std::size_t i) {
    const SurfaceVoxel& voxel = leaves_[i];
    std::uint64_t mine = 0;
    // By its place, so that a voxel keeps its directions while others come and go.
    const std::uint32_t own = hash(hash(seed, static_cast<std::uint32_t>(voxel.key)),
                                   static_cast<std::uint32_t>(voxel.key >> 32));
    code_.store(&records[i * code_.bytes()], options_.gather.turned
                                                 ? gather(voxel, directions_of(own), mine)
                                                 : gather(voxel, of_all, mine));
    rays += mine;
  });
  rays_ = rays;
  pull(octree_, code_);
  left_out_ = pool_.put(octree_);
  field_.assign(geometry(), pool_.bricks(), pool_.light());
}

Voxel VoxelServer::gather(const SurfaceVoxel& voxel, std::span<const Vec3> directions,
                          std::uint64_t& rays) const {
  const Cell cell = morton_cell(voxel.key);
  const Directions wanted = options_.all_directions ? kAllDirections : voxel.faced;
  const auto middle = [&](std::uint32_t c) { return (static_cast<float>(c) + 0.5F) * grid_.size; };
  const Vec3 centre = grid_.origin + Vec3{middle(cell[0]), middle(cell[1]), middle(cell[2])};
  const auto n = static_cast<float>(directions.size());
  const auto light = [&](const Surface& hit) {
    return direct_light(scene_, hit, rays) + field_.irradiance(hit.position, hit.normal, 0);
  };
  std::vector<Vec3> around(directions.size());
  Voxel out;
  out.cover.fill(1);
  for (std::size_t direction = 0; direction < kVoxelDirections; ++direction) {
    if ((wanted >> direction & 1) == 0) continue;
    const Vec3 axis = axis_of(direction), origin = centre + axis * (grid_.size / 2);
    Vec3 u, v, sum;
    basis(axis, u, v);
    std::ranges::transform(directions, around.begin(),
                           [&](Vec3 d) { return u * d.x + v * d.y + axis * d.z; });
    const std::size_t most = directions.size() / 2;
    const std::size_t inside = ddgi::gather(
        scene_, origin, around, 2 * kPi, rays, light,
        [&](std::size_t, Vec3 radiance, const Surface*) { sum += radiance; }, most);
    if (inside > most) continue;  // within a solid
    out.color[direction] = sum / (n - static_cast<float>(inside));
  }
  return out;
}

}  // namespace gicodec::voxels
