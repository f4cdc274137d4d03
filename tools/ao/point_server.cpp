#include "point_server.h"

#include "ddgi/noise.h"
#include "dump/error.h"
#include "kinds/tracing.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace gicodec::ao {
namespace {

using ddgi::Affine;
using ddgi::Vec3;

constexpr std::uint16_t kNotTraced = 256, kUnseen = 257;  // beside AO in 1/255

Affine transform_of(const ddgi::RayScene& scene, const PointInstance& instance) {
  const ddgi::Object& object = scene.scene().objects[instance.object];
  return object.dynamic ? scene.state().transforms[instance.object] : object.transform;
}

std::uint32_t packed(const GridPlace& place, Vec3 normal, std::uint8_t visible) {
  return pack_ao_point({place.within, {normal.x, normal.y, normal.z}, visible});
}

bool is_prime(std::uint32_t n) {
  for (std::uint32_t d = 2; std::uint64_t{d} * d <= n; ++d) {
    if (n % d == 0) return false;
  }
  return n > 1;
}

/// Of the primes from the grid's number of buckets on, the first with the fewest cells that find
/// their bucket full. Equation 1 puts whole rows of cells into the same buckets where what it
/// multiplies by and the number of buckets do not suit each other.
void choose_buckets(AoGrid& grid, std::span<const SurfacePoint> points) {
  constexpr int kTries = 16;
  std::vector<std::uint64_t> cells;
  for (const SurfacePoint& point : points) {
    if (const auto place = place_in(grid, point.position)) {
      cells.push_back(pack_ao_entry({place->cell, 0}));
    }
  }
  std::ranges::sort(cells);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  AoGrid tried = grid;
  std::size_t fewest = cells.size() + 1;
  for (int i = 0; i < kTries && fewest > 0; ++i, ++tried.buckets) {
    while (!is_prime(tried.buckets)) ++tried.buckets;
    std::vector<std::uint32_t> held(tried.buckets);
    std::size_t lost = 0;
    for (const std::uint64_t cell : cells) {
      lost += ++held[ao_bucket(tried, unpack_ao_entry(cell)->cell)] > kAoBucketEntries;
    }
    if (lost < fewest) fewest = lost, grid.buckets = tried.buckets;
  }
}

bool inside(const ddgi::Box& box, Vec3 p) {
  return p.x >= box.lo.x && p.y >= box.lo.y && p.z >= box.lo.z && p.x <= box.hi.x &&
         p.y <= box.hi.y && p.z <= box.hi.z;
}

template <typename Block>
std::vector<std::byte> bytes_of(std::span<const Block> blocks) {
  const auto bytes = std::as_bytes(blocks);
  return {bytes.begin(), bytes.end()};
}

}  // namespace

ExtendedView::ExtendedView(const ddgi::Camera& camera, float aspect, float margin)
    : eye_(camera.eye), forward_(ddgi::direction_between(camera.eye, camera.target)) {
  const float half = std::tan(ddgi::radians(camera.fov_y) / 2);
  angle_ = std::atan(half * std::sqrt(1 + aspect * aspect)) + ddgi::radians(margin);
  cosine_ = std::cos(angle_);
}

bool ExtendedView::contains(Vec3 place) const {
  return angle_ >= ddgi::kPi || dot(ddgi::direction_between(eye_, place), forward_) >= cosine_;
}

PointServer::PointServer(const ddgi::Scene& scene, const ServerOptions& options,
                         ddgi::ThreadPool& pool)
    : options_(options),
      pool_(pool),
      generated_(generate_points(scene, options.generation, pool)),
      memory_({}, 0),
      hemisphere_(options.rays, options.distance) {
  if (generated_.instances.empty()) {
    tools::fail(tools::Exit::bad_input, "the scene has no surfaces that points could be on");
  }
  for (const PointInstance& instance : generated_.instances) boxes_.push_back(instance.box());
  moved_.resize(generated_.instances.size());
  put_all();
}

void PointServer::put_all() {
  // Slots follow the buckets, so that entries that follow each other have slots that do; which
  // points of a cell that is too full stay is a matter of chance.
  struct Placed {
    std::uint64_t bucket, entry;
    std::uint32_t number, bits, instance;
    auto operator<=>(const Placed&) const = default;
  };
  std::vector<AoGrid> grids(generated_.instances.size());
  pool_.run(grids.size(), [&](std::size_t i) {
    grids[i] = generated_.instances[i].grid;
    choose_buckets(grids[i], generated_.instances[i].points);
  });
  std::uint64_t buckets = 0;
  for (const AoGrid& grid : grids) buckets += grid.buckets;
  if (buckets > kMaxBlocks) {
    tools::fail(tools::Exit::bad_input, "{} buckets are too many; take fewer points", buckets);
  }
  PointMemory empty(grids, 0);
  std::vector<Placed> order;
  for (std::uint32_t i = 0; i < grids.size(); ++i) {
    const auto& points = generated_.instances[i].points;
    for (std::uint32_t number = 0; number < points.size(); ++number) {
      const auto place = place_in(grids[i], points[number].position);
      if (!place) continue;
      order.push_back({ao_bucket(empty.grids()[i], place->cell), pack_ao_entry({place->cell, 0}),
                       number, packed(*place, points[number].normal, 255), i});
    }
  }
  std::ranges::sort(order);
  std::size_t cells = 0;
  for (auto cell = order.begin(); cell != order.end(); ++cells) {
    const auto same = [&](const Placed& other) {
      return other.bucket == cell->bucket && other.entry == cell->entry;
    };
    const auto end = std::find_if_not(cell, order.end(), same);
    // Those that have room, by where they are in the cell.
    const auto room = std::min(end - cell, static_cast<std::ptrdiff_t>(kAoCellPoints));
    std::sort(cell, cell + room, [](const Placed& a, const Placed& b) {
      return std::tie(a.bits, a.number) < std::tie(b.bits, b.number);
    });
    cell = end;
  }
  const auto capacity = static_cast<double>(cells) * (1 + options_.spare_cells);
  memory_ = PointMemory(std::move(grids),
                        static_cast<std::uint32_t>(std::clamp<double>(capacity, 1, kMaxBlocks)));
  for (const Placed& placed : order) {
    Point& point = points_.emplace_back();
    point.instance = placed.instance, point.number = placed.number;
    point.cell = unpack_ao_entry(placed.entry)->cell;
    point.place = memory_.insert(placed.instance, point.cell, placed.bits).value_or(kNowhere);
  }
}

std::span<SurfacePoint> PointServer::move(std::size_t instance) {
  moved_[instance] = 1;
  return generated_.instances[instance].points;
}

void PointServer::mark_stale(const ddgi::RayScene& scene) {
  const std::size_t instances = generated_.instances.size();
  std::vector<Affine> transforms;
  for (const PointInstance& instance : generated_.instances) {
    transforms.push_back(transform_of(scene, instance));
  }
  const bool first = updates_ == 0;
  std::vector<std::uint8_t> all(instances, options_.rays_anew || first);
  std::vector<ddgi::Box> near;
  for (std::size_t i = 0; i < instances && !first; ++i) {
    if (moved_[i] == 0 && transforms[i] == transforms_[i]) continue;
    all[i] = 1;
    near.push_back(kinds::moved(boxes_[i], transforms_[i], options_.distance));
    if (moved_[i] != 0) boxes_[i] = generated_.instances[i].box();
    near.push_back(kinds::moved(boxes_[i], transforms[i], options_.distance));
  }
  transforms_ = std::move(transforms);
  kinds::for_all(points_.size(), pool_, [&](std::size_t i) {
    Point& point = points_[i];
    const auto hit = [&](const ddgi::Box& box) {
      return inside(box, transforms_[point.instance].point(at(point).position));
    };
    point.moved = point.moved || moved_[point.instance] != 0;
    point.stale = point.stale || all[point.instance] != 0 || std::ranges::any_of(near, hit);
  });
  std::ranges::fill(moved_, std::uint8_t{0});
}

void PointServer::follow(Point& point) {
  const SurfacePoint& surface = at(point);
  const auto now = place_in(memory_.grids()[point.instance], surface.position);
  if (point.place != kNowhere && now && now->cell == point.cell) {
    memory_.write(point.place, packed(*now, surface.normal, point.visible));
    return;
  }
  if (point.place != kNowhere) memory_.remove(point.instance, point.cell, point.place);
  point.place = kNowhere;
  if (!now) return;
  point.cell = now->cell;
  point.place =
      memory_.insert(point.instance, now->cell, packed(*now, surface.normal, point.visible))
          .value_or(kNowhere);
}

void PointServer::update(const ddgi::RayScene& scene, std::span<const ExtendedView> views) {
  const bool first = updates_ == 0;
  mark_stale(scene);
  std::vector<std::uint16_t> traced(points_.size(), kNotTraced);
  const std::uint32_t round = options_.rays_anew ? updates_ : 0;
  kinds::for_all(points_.size(), pool_, [&](std::size_t i) {
    const Point& point = points_[i];
    if (!point.stale || (point.place == kNowhere && !point.moved)) return;
    const SurfacePoint& surface = at(point);
    const Affine& m = transforms_[point.instance];
    const Vec3 place = m.point(surface.position);
    const auto sees = [&](const ExtendedView& view) { return view.contains(place); };
    if (!first && !views.empty() && std::ranges::none_of(views, sees)) {
      traced[i] = kUnseen;
      return;
    }
    // Rays turn with the instance, so that it looks the same to itself.
    Frame frame = frame_around(surface.normal);
    frame = {normalize(m.vector(frame.tangent)), normalize(m.vector(frame.bitangent)),
             normalize(m.normal(frame.normal))};
    const std::uint32_t seed =
        ddgi::hash(ddgi::hash(options_.generation.seed, round), static_cast<std::uint32_t>(i));
    const float open =
        hemisphere_.visible(scene, place, normalize(m.normal(surface.geometric)), frame, seed);
    // NOLINTNEXTLINE(bugprone-incorrect-roundings): not negative
    traced[i] = static_cast<std::uint16_t>(open * 255 + 0.5F);
  });
  statistics_ = {};
  for (std::size_t i = 0; i < points_.size(); ++i) {
    Point& point = points_[i];
    statistics_.unseen += traced[i] == kUnseen;
    if (traced[i] >= kNotTraced) continue;
    point.stale = false;
    ++statistics_.traced;
    const auto visible = static_cast<std::uint8_t>(traced[i]);
    const int change = std::abs(int{visible} - int{point.visible});
    const bool changed = first || change > static_cast<int>(options_.threshold);
    if (changed) point.visible = visible;
    const std::uint32_t before = point.place == kNowhere ? 0 : memory_.read(point.place);
    if (point.moved) {
      follow(point);
      point.moved = false;
    } else if (changed) {
      memory_.write(point.place, with_visible(before, visible));
    }
    statistics_.changed += point.place != kNowhere && memory_.read(point.place) != before;
  }
  ++updates_;
}

VolumeDesc PointServer::volume() const {
  const auto size = [](auto list) { return static_cast<std::uint32_t>(list.size()); };
  return tools::take(
      ao_point_volume(size(memory_.cells()), size(memory_.buckets()), size(memory_.grids())),
      "AO points");
}

std::vector<std::vector<std::byte>> PointServer::textures() const {
  std::vector<std::byte> grids(memory_.grids().size() * kAoGridBytes);
  std::vector<AoTransform> transforms;
  for (std::size_t i = 0; i < memory_.grids().size(); ++i) {
    pack_ao_grid(memory_.grids()[i],
                 std::span(grids).subspan(i * kAoGridBytes).first<kAoGridBytes>());
    const Affine& m = transforms_[i];
    transforms.push_back(
        {m.x.x, m.y.x, m.z.x, m.t.x, m.x.y, m.y.y, m.z.y, m.t.y, m.x.z, m.y.z, m.z.z, m.t.z});
  }
  return {bytes_of(memory_.cells()), bytes_of(memory_.buckets()), grids,
          bytes_of(std::span<const AoTransform>(transforms))};
}

}  // namespace gicodec::ao
