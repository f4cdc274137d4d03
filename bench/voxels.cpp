// Voxels beside zstd and OpenVDB: first transfers, updates, how sizes grow, and pictures as levels
// arrive. What Crassin et al. §4.1 and Table 2 tell of bandwidth inside of a server.
#include "kind_bench.h"
#include "openvdb_peer.h"

#include "ddgi/scenes.h"
#include "stream/views.h"
#include "voxels/cut.h"
#include "voxels/voxels.h"

#include <gicodec/volume_decoder.h>
#include <gicodec/volume_encoder.h>

#include <fmt/core.h>

#include <array>
#include <cstdio>

namespace gicodec::bench {
namespace {

using voxels::VoxelServer;

struct Options {
  std::vector<std::string> scenes{"tomb", "villa", "street"};
  float size = 0.5F;
  /// Scenes and metres that are compared by how many voxels they make.
  std::vector<std::string> sizes{"tomb:2",     "tomb:1",      "tomb:0.5",    "tomb:0.25",
                                 "tomb:0.125", "street:0.25", "street:0.125"};
  std::uint32_t rays = 16, updates = 3;
  std::vector<std::string> tables{"first", "updates", "sizes", "pictures"};
  std::string pictures;
  double start = 2;

  [[nodiscard]] bool has(std::string_view table) const {
    return std::ranges::find(tables, table) != tables.end();
  }
};

/// What changes from update to update.
enum class Motion : std::uint8_t { scene, lamp };

/// The scene as it is; or at rest but for one of its lights, which moves by 1 m/s.
ddgi::Scene scene_of(const std::string& name, Motion motion, double start) {
  ddgi::Scene scene = *ddgi::make_scene(name);
  if (motion == Motion::scene) return scene;
  scene.animate = [before = scene.animate, start](double time, ddgi::FrameState& state) {
    if (before) before(start, state);
    if (!state.lights.empty()) state.lights.front().position.x += static_cast<float>(time - start);
  };
  return scene;
}

struct Case {
  ddgi::Scene scene;
  VoxelServer server;
  VolumeDesc volume;

  Case(const Options& o, const std::string& name, Motion motion, voxels::VoxelOptions options)
      : scene(scene_of(name, motion, o.start)),
        server(scene, completed(options, scene, o), 0, {}),
        volume(
            tools::take(voxel_volume(server.pool().slots(),
                                     static_cast<std::uint8_t>(options.shape.side), options.form),
                        "volume")) {}

  static voxels::VoxelOptions completed(voxels::VoxelOptions options, const ddgi::Scene& scene,
                                        const Options& o) {
    options.box =
        voxels::options_of(kinds::Settings("voxels", voxels::kTracedVoxels.settings, {}), scene, 1)
            .box;
    options.gather.rays = o.rays;
    return options;
  }
  [[nodiscard]] const TextureDesc& desc(std::size_t texture) const {
    return volume.groups.front().textures[texture].desc;
  }
  [[nodiscard]] std::size_t voxel_bytes() const {
    return kVoxelDirections * std::size_t{desc(1).record.bytes};
  }
};

/// Records of the voxels that exist, and where they stand in the texture.
struct Compact {
  std::vector<std::size_t> at;
  Bytes records;
};
Compact compact(const Case& c) {
  const voxels::BrickShape& shape = c.server.pool().shape();
  const std::size_t place = shape.place_bytes(), size = c.voxel_bytes();
  const auto bricks = c.server.pool().bricks(), light = c.server.pool().light();
  Compact out;
  for (std::size_t slot = 0; slot < c.server.pool().slots(); ++slot) {
    const auto mask = bricks.subspan(slot * place + kBrickPlaceBytes, shape.mask_bytes());
    for (unsigned v = 0; v < shape.voxels(); ++v) {
      if ((std::to_integer<unsigned>(mask[v / 8]) >> v % 8 & 1) == 0) continue;
      const std::size_t at = (slot * shape.voxels() + v) * size;
      out.at.push_back(at);
      out.records.insert(out.records.end(), light.begin() + static_cast<std::ptrdiff_t>(at),
                         light.begin() + static_cast<std::ptrdiff_t>(at + size));
    }
  }
  return out;
}

std::size_t zstd_planes(const Bytes& records, std::size_t size) {
  return zstd_size(planes(records, size));
}

/// By component, to what the texture held before at their places.
Bytes differences(const Case& c, const Compact& now, const Bytes& before) {
  Bytes then;
  then.reserve(now.records.size());
  for (const std::size_t at : now.at) {
    const auto one = std::span(before).subspan(at, c.voxel_bytes());
    then.insert(then.end(), one.begin(), one.end());
  }
  return bench::differences(now.records, then, c.desc(1).record);
}

std::size_t openvdb(const Case& c) {
  const voxels::VoxelCode code(c.server.options().form);
  std::vector<std::vector<OpenVdbVoxel>> levels;
  for (const voxels::OctreeLevel& level : c.server.octree()) {
    auto& out = levels.emplace_back();
    for (std::size_t i = 0; i < level.keys.size(); ++i) {
      const voxels::Cell cell = morton_cell(level.keys[i]);
      const voxels::Voxel voxel = code.load(&level.records[i * code.bytes()]);
      OpenVdbVoxel& one = out.emplace_back();
      for (std::size_t a = 0; a < 3; ++a) one.at[a] = static_cast<std::int32_t>(cell[a]);
      for (std::size_t d = 0; d < kVoxelDirections; ++d) {
        one.light[d] = {voxel.color[d].x, voxel.color[d].y, voxel.color[d].z};
      }
    }
  }
  return openvdb_zip(levels);
}

std::size_t bytes_of(const std::vector<Packet>& packets) {
  std::size_t bytes = 0;
  for (const Packet& packet : packets) bytes += packet.size();
  return bytes;
}

/// The volume as packets of all that changed, or of some; checked by decoding.
class Stream {
 public:
  explicit Stream(const Case& c)
      : encoder_(tools::take(VolumeEncoder::create(c.volume, {.gop = 0}), "encoder")),
        decoder_(tools::take(VolumeDecoder::create(c.volume, {.limits = kNoLimits}), "decoder")) {}

  /// Bytes of both packets: of all that changed, or what changed of a client's slots, those in the
  /// mask.
  std::size_t update(const Case& c, const BlockMask& mask = {}) {
    std::vector<std::uint32_t> some;
    for (std::uint32_t slot = 0; slot < mask.size(); ++slot) {
      if (mask[slot] != 0 && differs(c, slot)) some.push_back(slot);
    }
    if (!mask.empty() && some.empty()) return 0;
    const auto selection = mask.empty() ? Selection::changed() : Selection(some);
    const auto packets = tools::take(encoder_.encode(views(c), selection), "voxels");
    tools::check(decoder_.decode(packets), "voxels");
    for (std::uint32_t slot = 0; slot < c.server.pool().slots(); ++slot) {
      if ((mask.empty() || mask[slot] != 0) && differs(c, slot)) {
        tools::fail(tools::Exit::internal, "voxels are not lossless");
      }
    }
    return bytes_of(packets);
  }
  static std::array<ConstTextureView, 2> views(const Case& c) {
    return {c.server.pool().bricks(), c.server.pool().light()};
  }

 private:
  static constexpr DecodeLimits kNoLimits{.max_texture_bytes = UINT64_MAX,
                                          .max_packet_bytes = SIZE_MAX,
                                          .max_total_bytes = UINT64_MAX,
                                          .max_work_bytes = UINT64_MAX};
  [[nodiscard]] bool differs(const Case& c, std::uint32_t slot) const {
    const auto same = [&](std::uint8_t texture, std::span<const std::byte> now) {
      const std::size_t size = block_bytes(c.desc(texture)), at = slot * size;
      return std::ranges::equal(decoder_.decoder(texture)->records().subspan(at, size),
                                now.subspan(at, size));
    };
    return !same(0, c.server.pool().bricks()) || !same(1, c.server.pool().light());
  }
  VolumeEncoder encoder_;
  VolumeDecoder decoder_;
};

std::size_t bricks_of(const Case& c) {
  const auto counts = brick_counts(c.server.octree(), c.server.pool().shape());
  std::size_t sum = 0;
  for (const std::uint64_t count : counts) sum += static_cast<std::size_t>(count);
  return sum;
}

void print_first(const Options& o, const std::string& scene) {
  for (const unsigned side : {4U, 8U}) {
    for (const VoxelForm form : {VoxelForm::shared_exponent, VoxelForm::halves}) {
      voxels::VoxelOptions options;
      options.size = o.size;
      options.shape.side = side;
      options.form = form;
      options.gather.warmup = 1;
      Case c(o, scene, Motion::scene, options);
      c.server.update(o.start);
      Stream stream(c);
      const std::size_t native = stream.update(c);
      const Compact all = compact(c);
      const std::size_t zstd = zstd_planes(all.records, c.voxel_bytes()), vdb = openvdb(c);
      fmt::print("| {} | {}³ | {} | {} | {} | {} | {:.2f} | {} | {:.3f} | {} | {} |\n", scene, side,
                 form == VoxelForm::halves ? "halves" : "shared exponent", all.at.size(),
                 bricks_of(c), native, ratio(native, all.at.size()), zstd, ratio(native, zstd),
                 vdb == 0 ? "—" : fmt::format("{}", vdb),
                 vdb == 0 ? "—" : fmt::format("{:.3f}", ratio(native, vdb)));
      std::fflush(stdout);
    }
  }
}

/// A client of gi-server's with the scene's camera, at rest.
class Viewer {
 public:
  Viewer(const Case& c, double start) : views_(c.scene, kSamples, 0), stream_(c) {
    const ddgi::Camera camera = c.scene.camera_at(start);
    const auto position = [](ddgi::Vec3 v) { return Position{v.x, v.y, v.z}; };
    view_ = {position(camera.eye), position(camera.target), position(camera.up), camera.fov_y};
    view_.aspect = 16.0F / 9;
    volume_.brick_side = static_cast<std::uint8_t>(c.server.options().shape.side);
  }
  std::size_t update(const Case& c, double time) {
    const auto bricks = c.server.pool().bricks();
    volume_.geometry = c.server.geometry();
    volume_.bricks = std::make_shared<const Bytes>(bricks.begin(), bricks.end());
    volume_.changed.add(bricks, c.server.options().shape);
    return stream_.update(c, views_.look({time, {volume_}, {{1, view_}}}).seen[0].volumes[0]);
  }

 private:
  static constexpr std::uint32_t kSamples = 1024;
  streaming::Views views_;
  Viewpoint view_;
  streaming::ViewedVolume volume_;
  Stream stream_;
};

/// Mean bytes an update, of all voxels and of those that a client sees.
void print_updates(const Options& o, const std::string& scene, float size, Motion motion,
                   bool anew) {
  voxels::VoxelOptions options;
  options.size = size;
  options.gather.anew = anew;
  Case c(o, scene, motion, options);
  Stream stream(c);
  c.server.update(o.start);
  const std::size_t first = stream.update(c);
  Viewer viewer(c, o.start);
  const std::size_t seen_first = viewer.update(c, o.start);
  std::size_t native = 0, seen = 0, zstd = 0, data = 0, voxel_count = 0;
  for (std::uint32_t u = 1; u <= o.updates; ++u) {
    const auto light = c.server.pool().light();
    const Bytes before(light.begin(), light.end());
    c.server.update(o.start + 0.1 * u);
    native += stream.update(c);
    seen += viewer.update(c, o.start + 0.1 * u);
    const Compact now = compact(c);
    voxel_count = now.at.size();
    zstd += zstd_planes(differences(c, now, before), c.voxel_bytes());
    data += zstd_planes(now.records, c.voxel_bytes());
  }
  const auto each = [&](std::size_t sum) { return static_cast<double>(sum) / o.updates; };
  const auto mbps = [&](std::size_t sum) { return each(sum) * 10 * 8e-6; };
  fmt::print(
      "| {} | {} | {} | {} | {} | {} | {:.0f} | {:.2f} | {} | {:.3f} | {} | {:.3f} | {} | {:.0f} | "
      "{:.2f} |\n",
      scene, size, motion == Motion::lamp ? "one light" : "all", anew ? "anew" : "fixed",
      voxel_count, first, each(native), mbps(native), zstd / o.updates, ratio(native, zstd),
      data / o.updates, ratio(native, data), seen_first, each(seen), mbps(seen));
  std::fflush(stdout);
}

/// Pictures of a client that has the levels from the coarsest to one, beside that with all.
void print_pictures(const Options& o, const std::string& scene) {
  ddgi::ThreadPool pool;
  voxels::VoxelOptions options;
  options.size = o.size;
  Case c(o, scene, Motion::scene, options);
  c.server.update(o.start);
  ddgi::RayScene rays(c.scene);
  rays.set_state(c.scene.state_at(o.start));
  const auto bricks = c.server.pool().bricks(), light = c.server.pool().light();
  const ddgi::Camera camera = c.scene.camera_at(o.start);
  const auto slots = static_cast<std::uint32_t>(block_count(c.desc(0)));
  const auto draw = [&](std::span<const std::uint8_t> received) {
    voxels::VoxelLight client(c.volume, 0);
    const std::array held{kinds::HeldTexture{"bricks", c.desc(0), bricks, received},
                          kinds::HeldTexture{"light", c.desc(1), light, received}};
    client.update({c.volume, c.server.geometry(), held}, o.start);
    return ddgi::render(rays, &client, camera, picture_options(), pool);
  };
  const ddgi::Picture whole = draw({});
  auto encoder = tools::take(VolumeEncoder::create(c.volume), "encoder");
  std::vector<std::uint8_t> received(slots);
  std::size_t bytes = 0;
  const std::size_t place = c.server.pool().shape().place_bytes();
  for (std::size_t level = c.server.octree().size(); level-- > 0;) {
    std::vector<std::uint32_t> some;
    for (std::uint32_t slot = 0; slot < slots; ++slot) {
      const auto one = voxels::brick_in(bricks.subspan(slot * place, place));
      if (one && one->level == level) {
        some.push_back(slot);
        received[slot] = 1;
      }
    }
    bytes += bytes_of(tools::take(encoder.encode(Stream::views(c), some), "voxels"));
    const ddgi::Picture picture = draw(received);
    fmt::print("| {} | {} | {} | {} | {:.1f} |\n", scene, level,
               o.size * static_cast<float>(1U << level), bytes,
               ddgi::compare(picture, whole, camera.exposure).psnr);
    std::fflush(stdout);
    keep_picture(o.pictures, fmt::format("voxels-{}-{}", scene, level), picture, camera.exposure);
  }
}

void print_first_transfers(const Options& o) {
  fmt::print(
      "First transfers of all levels, {} rays a direction, voxels of {} m, as packets of both "
      "textures. zstd -19 on byte planes of the records that exist, in the order of slots, without "
      "places and masks; OpenVDB: six grids a level of three halves, zip.\n\n"
      "| scene | bricks of | form | voxels | bricks | bytes | bytes a voxel | zstd -19 | ratio | "
      "OpenVDB zip | ratio |\n|---|---|---|---|---|---|---|---|---|---|---|\n",
      o.rays, o.size);
  for (const std::string& scene : o.scenes) print_first(o, scene);
}

constexpr std::string_view kUpdates =
    "| scene | m | moves | rays | voxels | first transfer | bytes an update | Mbps at 10/s | "
    "zstd -19 on differences | ratio | zstd -19 on data | ratio | first, in view | an update, in "
    "view | Mbps, in view |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";

void print_all_updates(const Options& o) {
  fmt::print(
      "\nUpdates 0.1 s apart, bricks of 4³, shared exponents; planes of all voxels' differences by "
      "component to the client's state, and of the data. In view: what a client with the scene's "
      "camera at rest is sent, whose picture has 720 rows.\n\n{}",
      kUpdates);
  for (const std::string& scene : o.scenes) {
    for (const bool anew : {false, true}) print_updates(o, scene, o.size, Motion::scene, anew);
    print_updates(o, scene, o.size, Motion::lamp, false);
  }
}

void print_sizes(const Options& o) {
  fmt::print("\nBy the size of voxels, {} rays a direction.\n\n{}", o.rays, kUpdates);
  for (const std::string& text : o.sizes) {
    const std::string scene = text.substr(0, text.find(':'));
    const float size = std::stof(text.substr(text.find(':') + 1));
    if (size >= o.size) print_updates(o, scene, size, Motion::scene, false);
    print_updates(o, scene, size, Motion::lamp, false);
  }
}

void print_all_pictures(const Options& o) {
  fmt::print(
      "\nPictures of a client that has so many levels, in dB beside that of all.\n\n"
      "| scene | finest level | m | bytes | dB |\n|---|---|---|---|---|\n");
  for (const std::string& scene : o.scenes) print_pictures(o, scene);
}

tools::Exit run(const Options& o) {
  if (o.has("first")) print_first_transfers(o);
  if (o.has("updates")) print_all_updates(o);
  if (o.has("sizes")) print_sizes(o);
  if (o.has("pictures")) print_all_pictures(o);
  return tools::Exit::ok;
}

}  // namespace

void add_voxels(tools::Command& command, Measurement& chosen) {
  const auto options = std::make_shared<Options>();
  command.add_option("scenes", options->scenes, "Built-in scenes");
  command.add_option("--size", options->size, "Of voxels, in metres")->show_default();
  command.add_option("--sizes", options->sizes,
                     "Scenes and metres that are compared, as tomb:0.25");
  command.add_option("--rays", options->rays, "Per direction")->show_default();
  command.add_option("--updates", options->updates, "Updates to measure")->show_default();
  command.add_option("--tables", options->tables, "Of first, updates, sizes, pictures");
  command.add_option("--pictures", options->pictures, "Folder for pictures as levels arrive");
  choose(command, chosen, options, run);
}

}  // namespace gicodec::bench
