// Irradiance maps of a scene whose light moves: bytes of each way to stream them beside zstd -19 on
// byte planes, and how far the pictures are from those of the unclustered map.
#include "h264_peer.h"
#include "kind_bench.h"

#include "common/backend_flags.h"
#include "ddgi/scenes.h"
#include "maps/maps.h"

#include <gicodec/decoder.h>

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gicodec::bench {
namespace {

struct Flags {
  std::string scene = "villa", pictures;
  std::vector<std::string> set;
  double start = 5, fps = 5;
  std::uint32_t frames = 9;
  std::uint32_t texels = 512;  ///< a side of maps that are gathered at every texel; 0: none
  std::uint32_t reference_rays = 256;
};

/// The records that exist, one after the other.
Bytes existing(const Bytes& texture, std::size_t record, std::span<const maps::MapTexel> texels) {
  if (texels.empty()) return texture;
  std::vector<std::uint32_t> places;
  for (const maps::MapTexel& texel : texels) places.push_back(texel.place);
  return gather(texture, record, places);
}

/// Mean bytes of the updates after the keyframe, and those of that.
struct Coded {
  double key = 0, update = 0;
};
struct Sizes {
  Coded fast, strong;
  double exclusive_or = 0, difference = 0, plain = 0;
};

Coded code(const TextureDesc& desc, const Bytes& presence, const std::vector<Bytes>& frames,
           const std::string& preset) {
  auto encoder = make_encoder(desc, preset);
  auto decoder = tools::take(Decoder::create(desc), "native");
  if (!presence.empty()) {
    tools::check(encoder.set_presence(presence), "native");
    tools::check(decoder.set_presence(presence), "native");
  }
  Coded coded;
  Bytes out(frames.front().size());
  for (const Bytes& frame : frames) {
    const bool key = &frame == &frames.front();
    const Packet packet = tools::take(
        encoder.encode(ConstTextureView(frame), key ? Selection::all() : Selection::changed()),
        "native");
    tools::check(decoder.decode(packet, TextureView{out}), "native");
    if (out != frame) tools::fail(tools::Exit::different, "native: other texels came back");
    (key ? coded.key : coded.update) += static_cast<double>(packet.size());
  }
  if (frames.size() > 1) coded.update /= static_cast<double>(frames.size() - 1);
  return coded;
}

Sizes measure(const TextureDesc& desc, const Bytes& presence, const std::vector<Bytes>& frames,
              std::span<const maps::MapTexel> texels) {
  Sizes sizes{code(desc, presence, frames, "fast"), code(desc, presence, frames, "strong")};
  const std::size_t record = desc.record.bytes;
  Bytes before = existing(frames.front(), record, texels);
  for (std::size_t i = 1; i < frames.size(); ++i) {
    Bytes now = existing(frames[i], record, texels);
    const auto add = [&](double& sum, const Bytes& bytes) {
      sum += static_cast<double>(zstd_size(planes(bytes, record))) /
             static_cast<double>(frames.size() - 1);
    };
    add(sizes.exclusive_or, exclusive_or(now, before));
    add(sizes.difference, differences(now, before, desc.record));
    add(sizes.plain, now);
    before = std::move(now);
  }
  return sizes;
}

void print(const char* what, const Sizes& s) {
  fmt::print("{:<24} zstd -19 of xor {:.0f}, of differences {:.0f}, of planes {:.0f}\n", what,
             s.exclusive_or, s.difference, s.plain);
  for (const auto& [preset, coded] : {std::pair("fast", s.fast), std::pair("strong", s.strong)}) {
    fmt::print(
        "  native {:<6} key {:>8.0f} update {:>8.0f}: {:.2f} of xor, {:.2f} of differences, {:.2f} "
        "of planes; {:.2f} Mbps at 5/s, {:.2f} at 10/s\n",
        preset, coded.key, coded.update, coded.update / s.exclusive_or, coded.update / s.difference,
        coded.update / s.plain, coded.update * 40e-6, coded.update * 80e-6);
  }
  std::fflush(stdout);
}

maps::MapOptions options_of(const Flags& flags, std::vector<std::string> more) {
  std::vector<std::string> all = flags.set;
  all.insert(all.end(), more.begin(), more.end());
  const kinds::Settings settings(maps::kTracedMaps.name, maps::kTracedMaps.settings, all);
  return maps::options_of(settings, 1);
}

double time_of(const Flags& flags, std::uint32_t frame) { return flags.start + frame / flags.fps; }

/// The picture of the last frame by what a client receives.
ddgi::Picture picture_of(const Flags& flags, const ddgi::Scene& scene,
                         const IrradianceMapDesc& desc, const std::vector<Bytes>& textures,
                         const std::string& name) {
  const double time = time_of(flags, flags.frames - 1);
  ddgi::RayScene rays(scene);
  rays.set_state(scene.state_at(time));
  const VolumeDesc volume = tools::take(irradiance_map_volume(desc), "volume");
  maps::MapLight light(rays, volume);
  light.update({volume, {}, kinds::held_of(volume, textures)}, time);
  ddgi::ThreadPool pool;
  ddgi::RenderOptions options = picture_options();
  options.samples = 2;
  const ddgi::Camera camera = scene.camera_at(time);
  ddgi::Picture picture = ddgi::render(rays, &light, camera, options, pool);
  keep_picture(flags.pictures, fmt::format("{}-{}", scene.name, name), picture, camera.exposure);
  return picture;
}

void compare(const Flags& flags, const ddgi::Scene& scene, const ddgi::Picture& a,
             const ddgi::Picture& b, const char* what) {
  const double time = time_of(flags, flags.frames - 1);
  fmt::print("  picture: {:.1f} dB {}\n", ddgi::compare(a, b, scene.camera_at(time).exposure).psnr,
             what);
  std::fflush(stdout);
}

using Server = std::unique_ptr<maps::MapServer>;
Server make_server(const Flags& flags, const ddgi::Scene& scene,
                   std::vector<std::string> settings) {
  return std::make_unique<maps::MapServer>(scene, options_of(flags, std::move(settings)), 0,
                                           std::function<bool()>{});
}

/// Updates the server to a frame; the seconds that it took.
double update(const Flags& flags, maps::MapServer& server, std::uint32_t frame) {
  const auto begin = std::chrono::steady_clock::now();
  server.update(time_of(flags, frame));
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void print_work(const maps::MapServer& server, double seconds) {
  fmt::print("  {} texels, {} rays and {} shadow rays per update, {:.2f} s\n",
             server.texels().size(), server.count().rays, server.count().shadow_rays, seconds);
}

/// A map that is gathered at every texel; its picture.
ddgi::Picture report_texels(const Flags& flags, const ddgi::Scene& scene, const char* what,
                            std::vector<std::string> settings) {
  const Server server = make_server(flags, scene, std::move(settings));
  const VolumeDesc volume = tools::take(irradiance_map_volume(server->desc()), "volume");
  std::vector<Bytes> frames;
  double seconds = 0;
  for (std::uint32_t frame = 0; frame < flags.frames; ++frame) {
    seconds = update(flags, *server, frame);
    frames.push_back(server->textures()[1]);
  }
  print(what, measure(volume.groups[0].textures[1].desc, server->textures()[0], frames,
                      server->texels()));
  print_work(*server, seconds);
  return picture_of(flags, scene, server->desc(), server->textures(), "texels");
}

/// Bytes of the map with a loss, at a quantiser.
struct LossySizes {
  int qp;
  double key = 0, updates = 0;

  void add(std::uint32_t frame, std::size_t bytes) {
    (frame == 0 ? key : updates) += static_cast<double>(bytes);
  }
  void print(const char* codec, std::uint32_t frames) const {
    const double mean = updates / (frames - 1);
    fmt::print(
        "map of bases by {:<7} qp {:<4} key {:>8.0f}  update {:>8.0f} | {:.2f} Mbps at 5/s, {:.2f} "
        "at 10/s\n",
        codec, qp, key, mean, mean * 40e-6, mean * 80e-6);
  }
};

/// A map's texels with a loss, as a container has them.
struct Hevc {
  Hevc(int qp, const TextureDesc& desc, const Bytes& coverage) : sizes{qp} {
    const auto backend = tools::lossy_hevc(qp);
    EncoderOptions options;
    options.backend = backend->name();
    options.backends = {backend.get()};
    options.gop = 0;
    encoder.emplace(tools::take(Encoder::create(desc, options), "HEVC"));
    tools::check(encoder->set_presence(coverage), "HEVC");
  }
  void add(std::uint32_t frame, const Bytes& texels) {
    const auto packet =
        tools::take(encoder->encode(ConstTextureView(texels), Selection::all()), "HEVC");
    sizes.add(frame, packet.size());
  }
  [[nodiscard]] Bytes decoded() const {
    Bytes texels(static_cast<std::size_t>(texture_bytes(encoder->desc())));
    tools::check(encoder->read(TextureView{texels}), "HEVC");
    return texels;
  }

  LossySizes sizes;
  std::optional<Encoder> encoder;
};

/// Texels in 10 bits, where nothing is those before.
std::vector<std::uint32_t> filled(const Bytes& texels, std::span<const maps::MapTexel> exist) {
  std::vector<std::uint32_t> picture(texels.size() / sizeof(std::uint32_t));
  std::memcpy(picture.data(), texels.data(), texels.size());
  std::size_t next = 0;
  for (std::size_t place = 0; place < picture.size(); ++place) {
    const bool exists = next < exist.size() && exist[next].place == place;
    if (exists) ++next;
    if (!exists && place > 0) picture[place] = picture[place - 1];
  }
  return picture;
}

struct H264 {
  LossySizes sizes;
  H264Peer peer;
};

/// Bases: their coefficients, the map that they give, and that with a loss; the picture.
ddgi::Picture report_bases(const Flags& flags, const ddgi::Scene& scene) {
  const Server server = make_server(flags, scene, {"way=bases"});
  const VolumeDesc volume = tools::take(irradiance_map_volume(server->desc()), "volume");
  IrradianceMapDesc map_desc = server->desc();
  map_desc.way = MapWay::map;
  map_desc.bases = 0;
  const VolumeDesc map_volume = tools::take(irradiance_map_volume(map_desc), "volume");
  const maps::TexelCode code(map_desc.format);
  IrradianceMapDesc lossy_desc = map_desc;
  lossy_desc.format = Format::A2B10G10R10_UNORM_PACK32;
  const maps::TexelCode lossy_code(lossy_desc.format);
  const VolumeDesc lossy_volume = tools::take(irradiance_map_volume(lossy_desc), "volume");
  std::vector<Hevc> hevc;
  for (const int qp : {12, 20, 28}) {
    hevc.emplace_back(qp, lossy_volume.groups[0].textures[1].desc, server->textures()[1]);
  }
  std::vector<H264> h264;
  for (const int qp : {12, 20, 28, 36}) {
    h264.push_back({{qp}, H264Peer(map_desc.width, map_desc.height, qp)});
  }
  std::vector<Bytes> coefficients, map_frames;
  double seconds = 0;
  for (std::uint32_t frame = 0; frame < flags.frames; ++frame) {
    seconds = update(flags, *server, frame);
    coefficients.push_back(server->textures()[0]);
    map_frames.push_back(texels_of(server->map(), server->texels(), code, server->values()));
    const Bytes lossy = texels_of(server->map(), server->texels(), lossy_code, server->values());
    for (Hevc& one : hevc) one.add(frame, lossy);
    const auto picture = filled(lossy, server->texels());
    for (H264& one : h264) one.sizes.add(frame, one.peer.add(picture));
  }
  const std::vector<Bytes> textures = server->textures();
  const Bytes& coverage = textures[1];
  const auto texels = server->texels();
  print("coefficients", measure(volume.groups[0].textures[0].desc, {}, coefficients, {}));
  print_work(*server, seconds);
  const Sizes blend = measure(volume.groups[1].textures[1].desc, coverage, {textures[2]}, texels);
  const Sizes masks = measure(volume.groups[1].textures[0].desc, {}, {coverage}, {});
  fmt::print(
      "  {} bases, {:.2f} m apart; once: blend {:.0f} (strong {:.0f}, zstd -19 on planes {}), "
      "coverage {:.0f} (strong {:.0f})\n",
      server->bases().centres.size(), server->bases().spacing, blend.fast.key, blend.strong.key,
      zstd_size(planes(existing(textures[2], sizeof(maps::Blend), texels), sizeof(maps::Blend))),
      masks.fast.key, masks.strong.key);
  ddgi::Picture picture = picture_of(flags, scene, server->desc(), textures, "bases");
  print("map of bases",
        measure(map_volume.groups[0].textures[1].desc, coverage, map_frames, texels));
  compare(flags, scene, picture,
          picture_of(flags, scene, map_desc, {coverage, map_frames.back(), textures.back()}, "map"),
          "between bases and their map");
  for (const Hevc& one : hevc) {
    one.sizes.print("HEVC", flags.frames);
    compare(flags, scene, picture,
            picture_of(flags, scene, lossy_desc, {coverage, one.decoded(), textures.back()},
                       fmt::format("hevc-{}", one.sizes.qp)),
            "between bases and HEVC");
  }
  for (const H264& one : h264) {
    one.sizes.print("H.264", flags.frames);
    compare(flags, scene, picture,
            picture_of(flags, scene, lossy_desc, {coverage, one.peer.decoded(), textures.back()},
                       fmt::format("h264-{}", one.sizes.qp)),
            "between bases and H.264");
  }
  return picture;
}

tools::Exit run(const Flags& flags) {
  const auto scene = ddgi::make_scene(flags.scene);
  if (!scene) tools::fail(tools::Exit::usage, "{} is no scene", flags.scene);
  fmt::print("{}, {} updates\n", flags.scene, flags.frames - 1);
  const ddgi::Picture bases = report_bases(flags, *scene);
  if (flags.texels == 0) return tools::Exit::ok;
  const std::string size = fmt::format("size={}", flags.texels);
  const ddgi::Picture fixed = report_texels(flags, *scene, "map, rays fixed",
                                            {"way=map", "gather=texels", size, "rays=64"});
  report_texels(flags, *scene, "map, rays anew",
                {"way=map", "gather=texels", size, "rays=64", "rays-anew=1"});
  const Server reference =
      make_server(flags, *scene,
                  {"way=map", "gather=texels", size, fmt::format("rays={}", flags.reference_rays)});
  update(flags, *reference, flags.frames - 1);
  const ddgi::Picture best =
      picture_of(flags, *scene, reference->desc(), reference->textures(), "reference");
  compare(flags, *scene, bases, best, "of bases against the unclustered map of many rays");
  compare(flags, *scene, fixed, best, "of 64 rays per texel against that");
  return tools::Exit::ok;
}

}  // namespace

void add_irradiance_maps(tools::Command& command, Measurement& chosen) {
  const auto options = std::make_shared<Flags>();
  command.add_option("--scene", options->scene, "tomb, villa or street")->show_default();
  command.add_option("--set", options->set, "Settings of the kind")
      ->type_name("NAME=VALUE")
      ->take_all();
  command.add_option("--start", options->start, "Seconds")->show_default();
  command.add_option("--fps", options->fps, "Updates per second")->show_default();
  command.add_option("--frames", options->frames, "A keyframe and the updates")
      ->allow(tools::in_range(2, 1000))
      ->show_default();
  command.add_option("--texels", options->texels, "Side of maps gathered at every texel; 0: none")
      ->show_default();
  command.add_option("--reference-rays", options->reference_rays, "Per texel of the reference")
      ->show_default();
  command.add_option("--pictures", options->pictures, "Folder for pictures")->type_name("DIR");
  choose(command, chosen, options, run);
}

}  // namespace gicodec::bench
