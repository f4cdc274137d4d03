// Irradiance vector grids beside zstd, in bundles and whole, and their pictures as they arrive:
// what Pacanowski et al. §4.1 and Figures 2, 4 and 6 tell.
#include "kind_bench.h"

#include "ddgi/scenes.h"
#include "session/server/stratified_order.h"
#include "vectors/vectors.h"

#include <gicodec/decoder.h>
#include <gicodec/irradiance_vectors.h>

#include <fmt/core.h>

#include <cmath>
#include <cstdio>
#include <numeric>

namespace gicodec::bench {
namespace {

using vectors::VectorLight;
using vectors::VectorServer;
using Vertices = std::vector<std::uint32_t>;

struct Options {
  std::vector<std::string> scenes{"tomb", "villa", "street"};
  std::uint32_t vertices = 32, rays = 256, updates = 6;
  std::string pictures;
  double start = 2;
};

struct Case {
  ddgi::Scene scene;
  VectorServer server;
  Case(const Options& o, const std::string& name, std::uint32_t vertices, bool floats, bool anew)
      : scene(*ddgi::make_scene(name)),
        server(scene, options_of(o, vertices, floats, anew), 0, {}) {}

  [[nodiscard]] vectors::VectorOptions options_of(const Options& o, std::uint32_t vertices,
                                                  bool floats, bool anew) const {
    vectors::VectorOptions options;
    options.grid = {vertices, vertices, vertices};
    options.floats = floats;
    options.gather.rays = o.rays;
    options.gather.anew = anew;
    options.box = scene.volume;
    return options;
  }
  [[nodiscard]] TextureDesc desc() const {
    const auto& options = server.options();
    return tools::take(irradiance_vector_volume(options.grid, options.floats), "volume")
        .groups[0]
        .textures[0]
        .desc;
  }
  [[nodiscard]] std::size_t lit() const {
    const auto& known = server.field().known;
    return std::accumulate(known.begin(), known.end(), std::size_t{0});
  }
};

/// zstd -19 on byte planes of some vertices, or of their differences to what was before.
std::size_t zstd_planes(const TextureDesc& desc, const Bytes& texels, const Bytes& before,
                        const Vertices& vertices) {
  const std::size_t block = block_bytes(desc);
  Bytes some = gather(texels, block, vertices);
  if (!before.empty()) some = byte_differences(some, gather(before, block, vertices));
  return zstd_size(planes(some, desc.record.bytes));
}

/// The corners, then so many vertices each; all at once for 0.
std::vector<Vertices> bundles_of(const Grid& grid, std::uint32_t size) {
  const std::vector<std::uint32_t> order = stratified_order(grid);
  Vertices vertices(order.size());
  for (std::uint32_t v = 0; v < order.size(); ++v) vertices[order[v]] = v;
  std::vector<Vertices> bundles;
  constexpr std::uint32_t kCorners = 8;
  std::size_t at = 0;
  while (at < vertices.size()) {
    const std::size_t count = size == 0 ? vertices.size() : at == 0 ? kCorners : size;
    const std::size_t end = std::min(at + count, vertices.size());
    bundles.emplace_back(vertices.begin() + static_cast<std::ptrdiff_t>(at),
                         vertices.begin() + static_cast<std::ptrdiff_t>(end));
    std::sort(bundles.back().begin(), bundles.back().end());
    at = end;
  }
  return bundles;
}

void print_sizes(const Options& o, const std::string& scene, std::uint32_t vertices, bool floats) {
  Case c(o, scene, vertices, floats, false);
  c.server.update(o.start);
  const Bytes texels = c.server.texels();
  const TextureDesc desc = c.desc();
  for (const std::uint32_t per_slice : {0U, 8U, 64U}) {
    Encoder encoder = make_encoder(desc);
    Decoder decoder = tools::take(Decoder::create(desc), "decoder");
    std::size_t native = 0, zstd = 0, packets = 0;
    for (const Vertices& bundle : bundles_of(desc.grid, per_slice * vertices)) {
      const Packet packet = tools::take(
          encoder.encode(ConstTextureView(std::span<const std::byte>(texels)), bundle), "packet");
      if (decoder.decode(packet) != Status::ok)
        tools::fail(tools::Exit::internal, "a bundle cannot be decoded");
      native += packet.size();
      zstd += zstd_planes(desc, texels, {}, bundle);
      ++packets;
    }
    if (!std::ranges::equal(decoder.records(), texels))
      tools::fail(tools::Exit::internal, "bundles are not lossless");
    const auto lit = static_cast<double>(c.lit());
    fmt::print("| {} | {}³ | {} | {:.0f} % | {} | {} | {} | {:.2f} | {} | {:.3f} |\n", scene,
               vertices, floats ? "floats" : "quantised",
               100 * lit / static_cast<double>(block_count(desc)),
               per_slice == 0 ? "whole" : fmt::format("{} a slice", per_slice), packets, native,
               static_cast<double>(native) / (6 * lit), zstd, ratio(native, zstd));
    std::fflush(stdout);
  }
}

void print_updates(const Options& o, const std::string& scene, bool anew) {
  Case c(o, scene, o.vertices, false, anew);
  const TextureDesc desc = c.desc();
  Encoder encoder = make_encoder(desc);
  Bytes before;
  std::size_t native = 0, zstd = 0, changed = 0;
  for (std::uint32_t u = 0; u <= o.updates; ++u) {
    c.server.update(o.start + 0.1 * u);
    Bytes texels = c.server.texels();
    const std::size_t block = block_bytes(desc);
    Vertices vertices;
    for (std::uint32_t v = 0; v < block_count(desc); ++v) {
      if (before.empty() ||
          !std::equal(&texels[v * block], &texels[v * block] + block, &before[v * block])) {
        vertices.push_back(v);
      }
    }
    const Packet packet = tools::take(
        encoder.encode(ConstTextureView(std::span<const std::byte>(texels)), vertices), "packet");
    if (u > 0) {
      native += packet.size();
      zstd += zstd_planes(desc, texels, before, vertices);
      changed += vertices.size();
    }
    before = std::move(texels);
  }
  const double each = static_cast<double>(native) / o.updates;
  fmt::print("| {} | {} | {} | {:.0f} | {:.2f} | {} | {:.3f} |\n", scene, anew ? "anew" : "fixed",
             changed / o.updates, each, each * 10 * 8e-6, zstd / o.updates, ratio(native, zstd));
  std::fflush(stdout);
}

/// CIE L*a*b* under D65 of what a screen shows of linear light.
std::array<double, 3> lab(ddgi::Vec3 pixel, float exposure) {
  const auto shown = [exposure](float x) {
    return static_cast<double>(std::clamp(x * exposure, 0.0F, 1.0F));
  };
  const double r = shown(pixel.x), g = shown(pixel.y), b = shown(pixel.z);
  const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116; };
  const double x = f((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505),
               y = f(0.2126 * r + 0.7152 * g + 0.0722 * b),
               z = f((0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

/// Mean distance in L*a*b*, of 100.
double lab_difference(const ddgi::Picture& a, const ddgi::Picture& b, float exposure) {
  double sum = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    const auto p = lab(a.pixels[i], exposure), q = lab(b.pixels[i], exposure);
    sum += std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
  }
  return sum / static_cast<double>(a.pixels.size());
}

ddgi::Picture draw(Case& c, const Options& o, const Bytes& texels,
                   std::span<const std::uint8_t> received, vectors::VectorLightOptions options,
                   ddgi::ThreadPool& pool) {
  ddgi::RayScene rays(c.scene);
  rays.set_state(c.scene.state_at(o.start));
  const VolumeDesc volume = tools::take(
      irradiance_vector_volume(c.server.options().grid, c.server.options().floats), "volume");
  VectorLight light(volume, options);
  const kinds::HeldTexture held{"vectors", volume.groups[0].textures[0].desc, texels, received};
  light.update({volume, c.server.field().geometry, std::span(&held, 1)}, o.start);
  return ddgi::render(rays, &light, c.scene.camera_at(o.start), picture_options(), pool);
}

void print_pictures(const Options& o, const std::string& scene) {
  ddgi::ThreadPool pool;
  Case c(o, scene, 16, false, false), floats(o, scene, 16, true, false);
  c.server.update(o.start);
  floats.server.update(o.start);
  const Bytes texels = c.server.texels();
  const float exposure = c.scene.camera_at(o.start).exposure;
  const std::vector<std::uint32_t> order = stratified_order(c.server.options().grid);
  const ddgi::Picture whole = draw(c, o, texels, {}, {}, pool);
  std::string row = fmt::format("| {} |", scene);
  for (const std::uint32_t percent : {1U, 5U, 25U, 50U, 100U}) {
    std::vector<std::uint8_t> received(order.size());
    for (std::size_t v = 0; v < order.size(); ++v)
      received[v] = order[v] < order.size() * percent / 100 ? 1 : 0;
    row += ' ';
    for (const auto fill : {vectors::Fill::none, vectors::Fill::push_pull, vectors::Fill::smooth}) {
      const auto picture =
          draw(c, o, texels, received, {vectors::Interpolation::trilinear, fill}, pool);
      const double psnr = ddgi::compare(picture, whole, exposure).psnr;
      row += fmt::format("{}{:.1f}", fill == vectors::Fill::none ? "" : " / ", psnr);
      if (fill == vectors::Fill::smooth)
        keep_picture(o.pictures, fmt::format("{}-{}", scene, percent), picture, exposure);
    }
    row += " |";
  }
  const auto exact = draw(floats, o, floats.server.texels(), {}, {}, pool);
  const auto cubic = draw(c, o, texels, {}, {vectors::Interpolation::tricubic}, pool);
  fmt::print("{} {:.4f} % | {:.1f} dB |\n", row, lab_difference(whole, exact, exposure),
             ddgi::compare(cubic, whole, exposure).psnr);
  std::fflush(stdout);
}

tools::Exit run(const Options& o) {
  fmt::print(
      "Packets with their indices; zstd -19 on planes of the same vertices, without indices. Bytes "
      "a vector are of vertices with light.\n\n"
      "| scene | grid | form | lit | bundles | packets | bytes | bytes a vector | zstd -19 on "
      "planes | ratio |\n|---|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& scene : o.scenes) {
    print_sizes(o, scene, o.vertices, false);
    print_sizes(o, scene, o.vertices / 2, true);
  }
  fmt::print(
      "\nUpdates of all that changed in 0.1 s, {}³ quantised; zstd -19 on planes of "
      "differences.\n\n| scene | rays | vertices | bytes | Mbps at 10/s | zstd -19 | ratio |\n"
      "|---|---|---|---|---|---|---|\n",
      o.vertices);
  for (const std::string& scene : o.scenes) {
    for (const bool anew : {false, true}) print_updates(o, scene, anew);
  }
  fmt::print(
      "\nPictures of 16³ next to that of all vertices, in dB: without filling / push-pull / "
      "push-pull with a filter.\n\n| scene | 1 % | 5 % | 25 % | 50 % | 100 % | quantised beside "
      "floats, L*a*b* | tricubic beside trilinear |\n|---|---|---|---|---|---|---|---|\n");
  for (const std::string& scene : o.scenes) print_pictures(o, scene);
  return tools::Exit::ok;
}

}  // namespace

void add_irradiance_vectors(tools::Command& command, Measurement& chosen) {
  const auto options = std::make_shared<Options>();
  command.add_option("scenes", options->scenes, "Built-in scenes");
  command.add_option("--vertices", options->vertices, "Along each side")->show_default();
  command.add_option("--rays", options->rays, "Per vertex")->show_default();
  command.add_option("--updates", options->updates, "Updates to measure")->show_default();
  command.add_option("--pictures", options->pictures, "Folder for pictures as vertices arrive");
  choose(command, chosen, options, run);
}

}  // namespace gicodec::bench
