#include "voxels.h"

#include "dump/error.h"

#include <fmt/core.h>

#include <array>
#include <new>
#include <string_view>
#include <utility>

namespace gicodec::voxels {
namespace {

using kinds::Setting;

constexpr std::array kSettings{
    Setting{"size", "0.5", "metres along a side of the finest voxels, 0.01 to 100"},
    Setting{"brick", "4", "voxels along a side of a brick: 4, 8"},
    Setting{"form", "shared-exponent", "of light: shared-exponent, halves (with coverage)"},
    Setting{"bricks", "0",
            "slots for them, up to 16777216; 0: a quarter and 64 more than the first frame takes"},
    Setting{"all-directions", "0", "1: also those of a voxel that no surface in it faces"},
    Setting{"rays", "16", "per voxel and direction, 1 to 4096"},
    kinds::rays_turned("0"),
    kinds::kRaysAnew,
    kinds::kWarmup};
constexpr std::array kDrawing{
    Setting{"detail", "4", "pixels that a voxel covers at least, 0 to 1000; 0: always the finest"}};
constexpr std::array<std::string_view, 2> kBricks{"4", "8"};
constexpr std::array<std::string_view, 2> kForms{"shared-exponent", "halves"};

/// `reported`: how many bricks earlier remarks said to be left out.
void next(VoxelServer& server, std::uint64_t& reported, double time, kinds::FeedFrame& frame) {
  server.update(time);
  const BrickPool& pool = server.pool();
  frame.volumes[0].textures = {{pool.bricks().begin(), pool.bricks().end()},
                               {pool.light().begin(), pool.light().end()}};
  const std::uint64_t lost = server.left_out();
  if (lost > reported) {
    frame.remarks.push_back(
        fmt::format("voxels: there is no room for {} of the finest bricks of this frame; --set "
                    "bricks={} holds them, 0 leaves room for more",
                    lost, std::min<std::uint64_t>(pool.slots() + lost, kMaxBlocks)));
  }
  reported = std::max(reported, lost);
}

/// "91200 of 0.25 m in 2810 bricks" for each level.
std::string levels(const VoxelServer& server) {
  const auto bricks = brick_counts(server.octree(), server.options().shape);
  std::string text;
  for (std::size_t level = 0; level < bricks.size(); ++level) {
    text += fmt::format("{}{} of {:g} m in {} bricks", level == 0 ? "" : ", ",
                        server.octree()[level].keys.size(),
                        std::ldexp(server.options().size, static_cast<int>(level)), bricks[level]);
  }
  return text;
}

template <typename Work>
auto with_memory(const Work& work) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    tools::fail(tools::Exit::internal,
                "voxels: not enough memory for the bricks; fewer --set bricks, or a larger --set "
                "size, take less");
  }
}

kinds::Feed trace(kinds::TraceRequest request) {
  const VoxelOptions options = options_of(request.settings, request.scene, request.seed);
  const auto tracer = with_memory(
      [&] { return std::make_shared<kinds::Tracer<VoxelServer>>(std::move(request), options); });
  const VoxelServer& server = tracer->server;
  kinds::Feed feed = kinds::live_feed(
      "voxels",
      tools::take(voxel_volume(server.pool().slots(), static_cast<std::uint8_t>(options.shape.side),
                               options.form),
                  "voxels"),
      [tracer, reported = std::uint64_t{0}](const kinds::FeedRequest& wanted,
                                            kinds::FeedFrame& frame) mutable {
        with_memory([&] { next(tracer->server, reported, wanted.time, frame); });
      });
  feed.volumes[0].geometry = server.geometry();
  feed.remarks.push_back(
      fmt::format("{} slots; voxels: {}", server.pool().slots(), levels(server)));
  return feed;
}

std::unique_ptr<kinds::VolumeLight> light(const ddgi::RayScene& /*scene*/, const VolumeDesc& desc,
                                          const kinds::Settings& drawing) {
  return std::make_unique<VoxelLight>(desc, static_cast<float>(drawing.number("detail", 0, 1000)));
}

/// A copy, and an index that grows as it is filled.
std::uint64_t light_memory(const VolumeDesc& desc, std::uint64_t textures) {
  return textures +
         3 * sizeof(BrickIndex::Entry) * block_count(desc.groups.front().textures.front().desc);
}

}  // namespace

constinit const kinds::TracedKind kTracedVoxels{
    "voxels",     "light at the voxels of a sparse octree, from six directions",
    kSettings,    kDrawing,
    trace,        light,
    light_memory, true};

VoxelOptions options_of(const kinds::Settings& settings, const ddgi::Scene& scene,
                        std::uint32_t seed) {
  VoxelOptions options;
  options.size = static_cast<float>(settings.number("size", 0.01, 100));
  options.shape.side = settings.choice("brick", kBricks) == 0 ? 4 : 8;
  options.form = static_cast<VoxelForm>(settings.choice("form", kForms));
  options.slots = settings.whole("bricks", 0, kMaxBlocks);
  options.gather = kinds::gather_options(settings, 1, 4096, seed);
  options.all_directions = settings.whole("all-directions", 0, 1) == 1;
  const Vec3 around{1, 1, 1};
  options.box = {scene.volume.lo - around, scene.volume.hi + around};
  return options;
}

}  // namespace gicodec::voxels
