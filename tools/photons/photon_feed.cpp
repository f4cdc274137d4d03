#include "photons.h"

#include "dump/error.h"

#include <cstring>
#include <utility>

namespace gicodec::photons {
namespace {

constexpr std::uint32_t kMaxEmitted = 1U << 20;
constexpr std::array<std::string_view, 2> kForms{"Q", "R"};
constexpr std::array<kinds::Setting, 8> kSettings{{
    {"photons", "16384", "photons that each batch sends out, 1 to 1048576"},
    {"per-watt", "20", "photons that a light sends out per watt, 0.001 to 1000000"},
    {"max-batches", "32", "batches of all lights at most, 1 to 1024"},
    {"per-update", "4", "batches shot in each update, 1 to 1024, or 0 for all that are stale"},
    {"form", "Q", "20 bytes: Q, halves and short directions; R, a shared exponent and long ones"},
    {"neighbours", "10", "photons of its batch that a photon's radius reaches, 1 to 1000"},
    {"radius-bits", "3", "bits of a radius behind the leading one, 0 to 10"},
    {"capacity", "0", "photons stored of a batch at most, up to 32768; 0: twice those sent out"},
}};

/// Up to a number of records that a block can have.
std::uint32_t whole_block(std::uint32_t photons) {
  const std::uint32_t step = photons <= 64 ? 1 : photons <= 4096 ? 64 : 4096;
  return std::min((photons + step - 1) / step * step, kMaxPhotons);
}

PoolOptions options_of(const kinds::Settings& settings, std::uint32_t seed) {
  PoolOptions options;
  ShotOptions& shots = options.shots;
  shots.emitted = settings.whole("photons", 1, kMaxEmitted);
  shots.neighbours = settings.whole("neighbours", 1, 1000);
  shots.radius_bits = settings.whole("radius-bits", 0, 10);
  const std::uint32_t capacity = settings.whole("capacity", 0, kMaxPhotons);
  shots.capacity = whole_block(capacity != 0 ? capacity : 2 * shots.emitted);
  shots.form = static_cast<PhotonForm>(settings.choice("form", kForms));
  shots.seed = seed;
  options.per_watt = static_cast<float>(settings.number("per-watt", 0.001, 1e6));
  options.batches = settings.whole("max-batches", 1, 1024);
  options.per_update = settings.whole("per-update", 0, 1024);
  return options;
}

/// What one feed keeps from frame to frame.
struct Tracer {
  ddgi::Scene scene;
  PoolOptions options;
  ddgi::ThreadPool threads;
  ddgi::RayScene rays{scene};
  BatchPool batches{rays, options};
  VolumeDesc volume = tools::take(
      photon_volume(options.batches, options.shots.capacity, options.shots.form), "photons");
  std::vector<std::vector<std::byte>> textures;
  bool reported = false;  ///< a remark said that there is no room

  explicit Tracer(kinds::TraceRequest request)
      : scene(std::move(request.scene)),
        options(options_of(request.settings, request.seed)),
        threads(request.threads, std::move(request.cancelled)) {
    for (const NamedTexture& texture : volume.groups.front().textures) {
      textures.emplace_back(static_cast<std::size_t>(texture_bytes(texture.desc)));
    }
  }

  void next(double time, kinds::FeedFrame& frame) {
    rays.set_state(scene.state_at(time));
    const BatchPool::Update update = batches.update(threads);
    for (const std::uint32_t slot : update.changed) write(slot);
    frame.volumes[0].textures = textures;
    if (update.wanted > options.batches && !std::exchange(reported, true)) {
      frame.remarks.push_back(fmt::format(
          "photons: the lights are worth {} batches, there is room for {}; the brightest have "
          "fewer: --set max-batches={} holds them all, a lower per-watt asks for fewer",
          update.wanted, options.batches, update.wanted));
    }
  }

  void write(std::uint32_t slot) {
    const Shot& shot = batches.slots()[slot].shot;
    const auto count = static_cast<std::uint16_t>(shot.records.size() / kPhotonBytes);
    std::memcpy(&textures[0][slot * sizeof count], &count, sizeof count);
    pack_photon_batch(
        shot.batch,
        std::span(textures[1]).subspan(slot * kPhotonBatchBytes).first<kPhotonBatchBytes>());
    const std::size_t size = std::size_t{options.shots.capacity} * kPhotonBytes;
    const auto block = std::span(textures[2]).subspan(slot * size, size);
    const auto rest = std::copy(shot.records.begin(), shot.records.end(), block.begin());
    std::fill(rest, block.end(), std::byte{0});
  }
};

}  // namespace

constinit const kinds::TracedKind kTracedPhotons{
    "photons",
    "indirect light as photons, in batches of each light",
    kSettings,
    {},
    trace,
    [](const ddgi::RayScene& scene, const VolumeDesc& desc, const kinds::Settings&) {
      return light(scene, desc);
    },
    // Of a photon 40 bytes unpacked and 16 in the picture.
    [](const VolumeDesc&, std::uint64_t textures) { return 4 * textures; }};

kinds::Feed trace(kinds::TraceRequest request) {
  const auto tracer = std::make_shared<Tracer>(std::move(request));
  kinds::Feed feed =
      kinds::live_feed("photons", tracer->volume,
                       [tracer](const kinds::FeedRequest& wanted, kinds::FeedFrame& frame) {
                         tracer->next(wanted.time, frame);
                       });
  feed.remarks = {
      "photons: only lights send out photons; emissive materials and the sky light nothing"};
  return feed;
}

}  // namespace gicodec::photons
