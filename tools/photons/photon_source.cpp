#include "photons.h"

#include "dump/error.h"

#include <chrono>
#include <cstring>

namespace gicodec::photons {
namespace {

constexpr std::uint32_t kMostEmitted = 1U << 20;
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

class Tracer {
 public:
  explicit Tracer(kinds::TraceRequest request)
      : request_(std::move(request)),
        options_(pool_options(request_.settings, request_.seed)),
        threads_(request_.threads, request_.cancelled),
        scene_(request_.scene),
        batches_(scene_, options_) {
    volume_.name = "photons";
    volume_.desc = tools::take(
        photon_volume(options_.batches, options_.shots.capacity, options_.shots.form), "photons");
    volume_.geometry.grid = {options_.batches, 1, 1};
    for (const NamedTexture& texture : volume_.textures()) {
      textures_.emplace_back(static_cast<std::size_t>(texture_bytes(texture.desc)));
    }
  }

  [[nodiscard]] const kinds::SourceVolume& volume() const { return volume_; }

  kinds::SourceFrame next(double time) {
    const auto begin = std::chrono::steady_clock::now();
    scene_.set_state(request_.scene.state_at(time));
    const BatchPool::Update update = batches_.update(threads_);
    for (const std::uint32_t slot : update.changed) write(slot);
    kinds::SourceFrame frame;
    frame.time = time;
    frame.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    frame.volumes.push_back({{}, {}, textures_});
    if (update.wanted > options_.batches && !told_) {
      told_ = true;
      frame.remarks.push_back(fmt::format(
          "photons: the lights are worth {} batches, there is room for {}; the brightest have "
          "fewer: --set max-batches={} holds them all, a lower per-watt asks for fewer",
          update.wanted, options_.batches, update.wanted));
    }
    return frame;
  }

 private:
  void write(std::uint32_t slot) {
    const Shot& shot = batches_.slots()[slot].shot;
    const auto count = static_cast<std::uint16_t>(shot.records.size() / kPhotonBytes);
    std::memcpy(&textures_[0][slot * sizeof count], &count, sizeof count);
    pack_photon_batch(shot.batch, std::span<std::byte, kPhotonBatchBytes>(
                                      &textures_[1][slot * kPhotonBatchBytes], kPhotonBatchBytes));
    const std::size_t size = std::size_t{options_.shots.capacity} * kPhotonBytes;
    const auto block = std::span(textures_[2]).subspan(slot * size, size);
    const auto rest = std::copy(shot.records.begin(), shot.records.end(), block.begin());
    std::fill(rest, block.end(), std::byte{0});
  }

  kinds::TraceRequest request_;
  PoolOptions options_;
  ddgi::ThreadPool threads_;
  ddgi::RayScene scene_;
  BatchPool batches_;
  kinds::SourceVolume volume_;
  std::vector<std::vector<std::byte>> textures_;
  bool told_ = false;
};

}  // namespace

constinit const kinds::TracedKind kTracedPhotons{
    "photons", "indirect light as photons, in batches of each light", kSettings, trace, light};

std::span<const kinds::Setting> photon_settings() { return kSettings; }

PoolOptions pool_options(const kinds::Settings& settings, std::uint32_t seed) {
  PoolOptions options;
  ShotOptions& shots = options.shots;
  shots.emitted = settings.whole("photons", 1, kMostEmitted);
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

kinds::Source trace(kinds::TraceRequest request) {
  const auto tracer = std::make_shared<Tracer>(std::move(request));
  kinds::Source source;
  source.volumes = {tracer->volume()};
  source.next = [tracer](const kinds::SourceRequest& next) { return tracer->next(next.time); };
  source.remarks = {
      "photons: only lights send out photons; emissive materials and the sky light nothing"};
  return source;
}

}  // namespace gicodec::photons
