#include "maps.h"

#include "dump/error.h"

#include <fmt/core.h>

#include <array>
#include <string_view>
#include <utility>

namespace gicodec::maps {
namespace {

using kinds::Setting;

constexpr std::array kSettings{
    Setting{"size", "1024", "texels along a side of the map, 16 to 4096"},
    Setting{"format", "E5B9G9R9_UFLOAT_PACK32",
            "of texels or coefficients: E5B9G9R9_UFLOAT_PACK32, B10G11R11_UFLOAT_PACK32, "
            "R16G16B16A16_SFLOAT, A2B10G10R10_UNORM_PACK32"},
    Setting{"way", "bases", "what is streamed: map, bases"},
    Setting{"gather", "bases", "where light is gathered: texels, bases"},
    Setting{"bases", "30000", "about how many, 1 to 65536"},
    Setting{"spacing", "0", "metres between bases, 0 to 100; 0: by how many they are"},
    Setting{"rays", "0", "per texel or basis, 0 to 65536; 0: 64 per texel, 256 per basis"},
    kinds::rays_turned("1"),
    kinds::kRaysAnew,
    Setting{"qp", "none", "way=map: LOSES BITS, texels in 10 bits by HEVC, quantiser 0 to 51"},
    kinds::kWarmup};

constexpr std::array<std::string_view, 2> kWays{"map", "bases"};
constexpr std::array<std::string_view, 2> kGathers{"texels", "bases"};
constexpr std::array<std::string_view, 4> kFormats{"E5B9G9R9_UFLOAT_PACK32",
                                                   "B10G11R11_UFLOAT_PACK32", "R16G16B16A16_SFLOAT",
                                                   "A2B10G10R10_UNORM_PACK32"};

kinds::Feed trace(kinds::TraceRequest request) {
  const MapOptions options = options_of(request.settings, request.seed);
  const auto scene = std::make_shared<ddgi::Scene>(std::move(request.scene));
  const auto server =
      std::make_shared<MapServer>(*scene, options, request.threads, std::move(request.cancelled));
  kinds::Feed feed = kinds::live_feed(
      "map", tools::take(irradiance_map_volume(server->desc()), "irradiance map"),
      [scene, server, bases = options.by_bases, lossy = options.qp >= 0, reported = false](
          const kinds::FeedRequest& wanted, kinds::FeedFrame& frame) mutable {
        server->update(wanted.time);
        frame.volumes[0].textures = server->textures();
        if (reported || server->clipped() == 0) return;
        reported = true;
        frame.remarks.push_back(fmt::format(
            "10 bits hold no irradiance above 1, and that of {} {} is: it comes out "
            "darker; {}E5B9G9R9_UFLOAT_PACK32 holds it",
            server->clipped(), bases ? "bases" : "texels", lossy ? "without --set qp " : ""));
      });
  if (options.qp >= 0) feed.volumes[0].quantisers = {-1, options.qp, -1};
  const Parameterisation& map = server->map();
  feed.remarks.push_back(fmt::format(
      "{} charts, {:.2f} texels per metre, {} of {}x{} texels on surfaces", map.rects().size(),
      map.density(), server->texels().size(), map.width(), map.height()));
  if (options.by_bases) {
    const std::size_t bases = server->bases().centres.size();
    std::string remark = fmt::format("{} bases, {:.2f} m apart", bases, server->bases().spacing);
    if (!(options.spacing > 0) && bases > options.bases + options.bases / 10)
      remark +=
          fmt::format(", instead of {}: small and moving surfaces have their own", options.bases);
    feed.remarks.push_back(std::move(remark));
  }
  return feed;
}

std::unique_ptr<kinds::VolumeLight> light(const ddgi::RayScene& scene, const VolumeDesc& desc,
                                          const kinds::Settings& /*drawing*/) {
  return std::make_unique<MapLight>(scene, desc);
}

std::uint64_t light_memory(const VolumeDesc& desc, std::uint64_t textures) {
  constexpr std::uint64_t kTexel = 96;  // parameterised, received and shown
  const auto map = irradiance_map_desc(desc);
  return textures + (map ? kTexel * map->width * map->height : 0);
}

}  // namespace

constinit const kinds::TracedKind kTracedMaps{
    .name = "irradiance_maps",
    .summary = "light maps over a scene's surfaces, or bases of them",
    .settings = kSettings,
    .drawing = {},
    .trace = trace,
    .light = light,
    .light_memory = light_memory,
    .remembers = true};

std::vector<std::vector<std::array<Vec2, 3>>> second_uvs(const ddgi::Scene& scene,
                                                         std::uint32_t size) {
  const Parameterisation map(scene, size, size);
  std::vector<std::vector<std::array<Vec2, 3>>> out;
  for (const Instance& instance : map.scene().instances) {
    out.push_back(map.texture_coordinates(instance));
  }
  return out;
}

MapOptions options_of(const kinds::Settings& settings, std::uint32_t seed) {
  MapOptions options;
  options.desc.width = options.desc.height = settings.whole("size", 16, kMaxTracedSide);
  options.desc.format = find_format(kFormats[settings.choice("format", kFormats)])->record.format;
  options.desc.way = static_cast<MapWay>(settings.choice("way", kWays));
  options.by_bases = settings.choice("gather", kGathers) == 1;
  if (options.desc.way == MapWay::bases && !options.by_bases)
    tools::fail(tools::Exit::usage, "--set way=bases needs --set gather=bases");
  if (settings.text("qp") != "none") {
    if (options.desc.way != MapWay::map)
      tools::fail(tools::Exit::usage, "--set qp needs --set way=map");
    options.qp = static_cast<int>(settings.whole("qp", 0, 51));
    constexpr Format kLossy = Format::A2B10G10R10_UNORM_PACK32;
    if (options.desc.format != kLossy && settings.text("format") != kFormats[0])
      tools::fail(tools::Exit::usage,
                  "--set qp codes A2B10G10R10_UNORM_PACK32; leave out --set "
                  "format");
    options.desc.format = kLossy;
  }
  options.bases = settings.whole("bases", 1, kMaxMapBases);
  options.spacing = static_cast<float>(settings.number("spacing", 0, 100));
  options.gather = kinds::gather_options(settings, 0, 65536, seed);
  if (options.gather.rays == 0) options.gather.rays = options.by_bases ? 256 : 64;
  return options;
}

}  // namespace gicodec::maps
