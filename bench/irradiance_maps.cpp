// Irradiance maps of a scene whose light moves: bytes of each way to stream them beside zstd -19 on
// byte planes, and how far the pictures are from those of the unclustered map.
#include "common/program.h"
#include "ddgi/client_renderer.h"
#include "ddgi/picture.h"
#include "ddgi/scenes.h"
#include "h264_peer.h"
#include "maps/maps.h"

#include <gicodec/decoder.h>
#include <gicodec/encoder.h>

#include <fmt/core.h>
#include <zstd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace gicodec;
using Bytes = std::vector<std::byte>;

struct Flags {
  std::string scene = "villa", pictures;
  std::vector<std::string> set;
  double start = 5, fps = 5;
  std::uint32_t frames = 9;
  std::uint32_t texels = 512;  ///< a side of maps that are gathered at every texel; 0: none
  std::uint32_t reference_rays = 256;
};

std::size_t zstd_size(const Bytes& bytes) {
  std::vector<char> out(ZSTD_compressBound(bytes.size()));
  return ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 19);
}

/// The records that exist, one after the other.
Bytes existing(const Bytes& texture, std::size_t record, std::span<const maps::MapTexel> texels) {
  if (texels.empty()) return texture;
  Bytes out(texels.size() * record);
  for (std::size_t i = 0; i < texels.size(); ++i) {
    std::memcpy(&out[i * record], &texture[texels[i].place * record], record);
  }
  return out;
}

Bytes planes(const Bytes& records, std::size_t record) {
  Bytes out(records.size());
  const std::size_t count = records.size() / record;
  for (std::size_t i = 0; i < records.size(); ++i) {
    out[i % record * count + i / record] = records[i];
  }
  return out;
}

Bytes exclusive_or(const Bytes& a, const Bytes& b) {
  Bytes out(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) out[i] = a[i] ^ b[i];
  return out;
}

/// Differences of components, each in its own bits.
Bytes differences(const Bytes& a, const Bytes& b, const Record& record) {
  Bytes out(a.size());
  for (std::size_t at = 0; at < a.size(); at += record.bytes) {
    for (const Component& component : record.used()) {
      const std::size_t first = at + component.offset / 32 * 4;
      const std::size_t bytes = std::min<std::size_t>(4, at + record.bytes - first);
      std::uint32_t x = 0, y = 0, z = 0;
      std::memcpy(&x, &a[first], bytes);
      std::memcpy(&y, &b[first], bytes);
      std::memcpy(&z, &out[first], bytes);
      const std::uint32_t shift = component.offset % 32;
      const std::uint32_t mask = component.bits == 32 ? ~0U : (1U << component.bits) - 1;
      z |= (((x >> shift) - (y >> shift)) & mask) << shift;
      std::memcpy(&out[first], &z, bytes);
    }
  }
  return out;
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
           std::string_view preset) {
  EncoderOptions options;
  options.gop = 0;
  options.settings.preset = preset;
  auto encoder = tools::take(Encoder::create(desc, options), "native");
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
  std::vector<kinds::HeldTexture> held;
  for (const TextureGroup& group : volume.groups) {
    for (const NamedTexture& texture : group.textures) {
      held.push_back({texture.name, texture.desc, textures[held.size()], {}});
    }
  }
  light.update({volume, {}, held}, time);
  ddgi::ThreadPool pool;
  ddgi::RenderOptions options;
  options.width = 480, options.height = 270;
  const ddgi::Camera camera = scene.camera_at(time);
  ddgi::Picture picture = ddgi::render(rays, &light, camera, options, pool);
  if (!flags.pictures.empty()) {
    ddgi::write_picture(fmt::format("{}/{}-{}.png", flags.pictures, scene.name, name), picture,
                        camera.exposure, tools::Existing::replace);
  }
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

/// Bytes of the map as video at a quantiser.
struct VideoSizes {
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

struct Hevc {
  VideoSizes sizes;
  maps::VideoEncoder encoder;
};

struct H264 {
  VideoSizes sizes;
  bench::H264Peer peer;
};

/// Bases: their coefficients, the map that they give, and that as video; the picture.
ddgi::Picture report_bases(const Flags& flags, const ddgi::Scene& scene) {
  const Server server = make_server(flags, scene, {"way=bases"});
  const VolumeDesc volume = tools::take(irradiance_map_volume(server->desc()), "volume");
  IrradianceMapDesc map_desc = server->desc();
  map_desc.way = MapWay::map;
  map_desc.bases = 0;
  const VolumeDesc map_volume = tools::take(irradiance_map_volume(map_desc), "volume");
  const maps::TexelCode code(map_desc.format);
  IrradianceMapDesc video_desc = map_desc;
  video_desc.way = MapWay::video;
  video_desc.format = Format::A2B10G10R10_UNORM_PACK32;
  video_desc.pages = 8192, video_desc.frames = 64;
  std::vector<Hevc> hevc;
  for (const int qp : {12, 20, 28}) hevc.push_back({{qp}, maps::VideoEncoder(video_desc, qp)});
  std::vector<H264> h264;
  for (const int qp : {12, 20, 28, 36}) {
    h264.push_back({{qp}, bench::H264Peer(map_desc.width, map_desc.height, qp)});
  }
  std::vector<Bytes> coefficients, map_frames;
  double seconds = 0;
  for (std::uint32_t frame = 0; frame < flags.frames; ++frame) {
    seconds = update(flags, *server, frame);
    coefficients.push_back(server->textures()[0]);
    map_frames.push_back(texels_of(server->map(), server->texels(), code, server->values()));
    for (Hevc& one : hevc) {
      one.encoder.add(server->texels(), server->values());
      one.sizes.add(frame, one.encoder.last_bytes());
    }
    const auto coded = maps::video_picture(server->texels(), server->values());
    for (H264& one : h264) one.sizes.add(frame, one.peer.add(coded));
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
            picture_of(flags, scene, video_desc,
                       {one.encoder.sizes, one.encoder.pages, one.encoder.frames, coverage,
                        textures.back()},
                       fmt::format("video-{}", one.sizes.qp)),
            "between bases and the video");
  }
  for (const H264& one : h264) {
    one.sizes.print("H.264", flags.frames);
    std::vector<ddgi::Vec3> values(one.peer.decoded().size());
    std::transform(one.peer.decoded().begin(), one.peer.decoded().end(), values.begin(),
                   maps::from_video);
    compare(flags, scene, picture,
            picture_of(flags, scene, map_desc,
                       {coverage, texels_of(server->map(), texels, code, values), textures.back()},
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

int main(int argc, char** argv) {
  tools::Command app{"Measures irradiance maps.", "irradiance_maps"};
  Flags flags;
  app.add_option("--scene", flags.scene, "tomb, villa or street")->show_default();
  app.add_option("--set", flags.set, "Settings of the kind")->type_name("NAME=VALUE")->take_all();
  app.add_option("--start", flags.start, "Seconds")->show_default();
  app.add_option("--fps", flags.fps, "Updates per second")->show_default();
  app.add_option("--frames", flags.frames, "A keyframe and the updates")
      ->allow(tools::in_range(2, 1000))
      ->show_default();
  app.add_option("--texels", flags.texels, "Side of maps gathered at every texel; 0: none")
      ->show_default();
  app.add_option("--reference-rays", flags.reference_rays, "Per texel of the reference")
      ->show_default();
  app.add_option("--pictures", flags.pictures, "Folder for pictures")->type_name("DIR");
  return tools::run_program(app, argc, argv, [&] { return run(flags); });
}
