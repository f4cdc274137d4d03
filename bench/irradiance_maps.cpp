// Irradiance maps of a scene whose light moves: bytes of each way to stream them beside zstd -19 on
// byte planes, and how far the pictures are from those of the unclustered map.
#include "ddgi/client_renderer.h"
#include "ddgi/picture.h"
#include "ddgi/program.h"
#include "ddgi/scenes.h"
#include "maps/maps.h"

#include <gicodec/decoder.h>
#include <gicodec/encoder.h>

#include <fmt/format.h>
#include <zstd.h>

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

/// Mean bytes of the updates after the keyframe.
struct Sizes {
  double key = 0, native = 0, exclusive_or = 0, difference = 0, plain = 0;
};

Sizes measure(const TextureDesc& desc, const Bytes& presence, const std::vector<Bytes>& frames,
              std::span<const maps::MapTexel> texels) {
  Sizes sizes;
  EncoderOptions options;
  options.gop = 0;
  auto encoder = tools::take(Encoder::create(desc, options), "native");
  auto decoder = tools::take(Decoder::create(desc), "native");
  if (!presence.empty()) {
    tools::check(encoder.set_presence(presence), "native");
    tools::check(decoder.set_presence(presence), "native");
  }
  Bytes before, out(frames.front().size());
  const std::size_t record = desc.record.bytes;
  for (const Bytes& frame : frames) {
    const bool key = before.empty();
    const Packet packet = tools::take(
        encoder.encode(ConstTextureView(frame), key ? Selection::all() : Selection::changed()),
        "native");
    tools::check(decoder.decode(packet, TextureView{out}), "native");
    if (out != frame) tools::fail(tools::Exit::different, "native: other texels came back");
    Bytes now = existing(frame, record, texels);
    if (key) {
      sizes.key = static_cast<double>(packet.size());
    } else {
      const double share = 1.0 / static_cast<double>(frames.size() - 1);
      const auto add = [share](double& sum, std::size_t bytes) {
        sum += share * static_cast<double>(bytes);
      };
      add(sizes.native, packet.size());
      add(sizes.exclusive_or, zstd_size(planes(exclusive_or(now, before), record)));
      add(sizes.difference, zstd_size(planes(differences(now, before, desc.record), record)));
      add(sizes.plain, zstd_size(planes(now, record)));
    }
    before = std::move(now);
  }
  return sizes;
}

void print(const char* what, const Sizes& s) {
  const auto mbps = [&](double rate) { return s.native * 8 * rate * 1e-6; };
  fmt::print(
      "{:<30} key {:>8.0f}  native {:>8.0f} | zstd -19: xor {:>8.0f} ({:.3f}) difference {:>8.0f} "
      "({:.3f}) planes {:>8.0f} ({:.3f}) | {:.2f} Mbps at 5/s, {:.2f} at 10/s\n",
      what, s.key, s.native, s.exclusive_or, s.native / s.exclusive_or, s.difference,
      s.native / s.difference, s.plain, s.native / s.plain, mbps(5), mbps(10));
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
                         const maps::MapServer& server, const char* name) {
  const double time = time_of(flags, flags.frames - 1);
  ddgi::RayScene rays(scene);
  rays.set_state(scene.state_at(time));
  const VolumeDesc volume = tools::take(irradiance_map_volume(server.desc()), "volume");
  maps::MapLight light(rays, volume);
  const std::vector<Bytes> textures = server.textures();
  std::vector<kinds::HeldTexture> held;
  for (const BlockSet& set : volume.sets) {
    for (const NamedTexture& texture : set.textures) {
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

using Server = std::unique_ptr<maps::MapServer>;

/// Traces all frames and reports what is sent of them.
Server report(const Flags& flags, const ddgi::Scene& scene, const char* what,
              std::vector<std::string> settings) {
  auto server = std::make_unique<maps::MapServer>(scene, options_of(flags, std::move(settings)), 0,
                                                  std::function<bool()>{});
  const VolumeDesc volume = tools::take(irradiance_map_volume(server->desc()), "volume");
  const bool bases = server->desc().way == MapWay::bases;
  const std::size_t place = bases ? 0 : 1;
  std::vector<Bytes> frames, first;
  double seconds = 0;
  for (std::uint32_t frame = 0; frame < flags.frames; ++frame) {
    const auto begin = std::chrono::steady_clock::now();
    server->update(time_of(flags, frame));
    seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    std::vector<Bytes> textures = server->textures();
    frames.push_back(textures[place]);
    if (frame == 0) first = std::move(textures);
  }
  const auto all = server->texels();
  const auto some = bases ? decltype(all){} : all;
  print(what,
        measure(volume.sets[0].textures[place].desc, bases ? Bytes{} : first[0], frames, some));
  fmt::print("  {} texels, {} rays and {} shadow rays per update, {:.2f} s", all.size(),
             server->count().rays, server->count().shadow_rays, seconds);
  if (bases) {
    const Sizes blend = measure(volume.sets[1].textures[1].desc, first[1], {first[2]}, all);
    const Sizes coverage = measure(volume.sets[1].textures[0].desc, {}, {first[1]}, {});
    fmt::print(
        "; {} bases, {:.2f} m apart; once: blend {:.0f} (zstd -19 on planes {}), coverage {:.0f}",
        server->bases().centres.size(), server->bases().spacing, blend.key,
        zstd_size(planes(existing(first[2], sizeof(maps::Blend), all), sizeof(maps::Blend))),
        coverage.key);
  }
  fmt::print("\n");
  std::fflush(stdout);
  return server;
}

tools::Exit run(const Flags& flags) {
  const auto scene = ddgi::make_scene(flags.scene);
  if (!scene) tools::fail(tools::Exit::usage, "{} is no scene", flags.scene);
  fmt::print("{}, {} updates\n", flags.scene, flags.frames - 1);
  const auto compare = [&](const ddgi::Picture& a, const ddgi::Picture& b, const char* what) {
    const double time = time_of(flags, flags.frames - 1);
    fmt::print("  picture: {:.1f} dB {}\n",
               ddgi::compare(a, b, scene->camera_at(time).exposure).psnr, what);
  };
  Server server = report(flags, *scene, "coefficients", {});
  const ddgi::Picture bases = picture_of(flags, *scene, *server, "bases");
  server = report(flags, *scene, "map of bases", {"way=map"});
  compare(picture_of(flags, *scene, *server, "map"), bases, "between the map and its bases");
  server.reset();
  if (flags.texels == 0) return tools::Exit::ok;
  const std::string size = fmt::format("size={}", flags.texels);
  server = report(flags, *scene, "map, rays fixed", {"way=map", "gather=texels", size, "rays=64"});
  const ddgi::Picture fixed = picture_of(flags, *scene, *server, "texels");
  server = report(flags, *scene, "map, rays anew",
                  {"way=map", "gather=texels", size, "rays=64", "rays-anew=1"});
  Flags last = flags;
  last.start = time_of(flags, flags.frames - 1);
  last.frames = 1;
  maps::MapServer reference(*scene,
                            options_of(last, {"way=map", "gather=texels", size,
                                              fmt::format("rays={}", flags.reference_rays)}),
                            0, {});
  reference.update(last.start);
  const ddgi::Picture best = picture_of(last, *scene, reference, "reference");
  compare(bases, best, "of bases against the unclustered map of many rays");
  compare(fixed, best, "of 64 rays per texel against that");
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
  return ddgi::run_program(app, argc, argv, [&] { return run(flags); });
}
