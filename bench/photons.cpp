// Photons (docs/photons.md): bytes of a photon beside other codecs, and what Crassin et al. report
// in Table 2 for scenes of the tracer.
#include "kind_bench.h"

#include "ddgi/noise.h"
#include "ddgi/scenes.h"
#include "dump/error.h"
#include "photons/held_photons.h"
#include "photons/photons.h"
#include "photons/reference.h"
#include "photons/splatting.h"

#include <fmt/core.h>
#ifdef GICODEC_HAS_MESHOPTIMIZER
#include <meshoptimizer.h>
#endif

#include <gicodec/volume_encoder.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <map>

namespace gicodec::bench {
namespace {

using Clock = std::chrono::steady_clock;

struct Options {
  std::vector<std::string> settings;
  std::string pictures;
};

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Place along a Hilbert curve (Skilling 2004).
std::uint64_t hilbert(std::array<std::uint32_t, 3> x) {
  for (std::uint32_t q = 1U << 15; q > 1; q >>= 1) {
    for (std::uint32_t& v : x) {
      if ((v & q) != 0) {
        x[0] ^= q - 1;
      } else {
        const std::uint32_t t = (x[0] ^ v) & (q - 1);
        x[0] ^= t;
        v ^= t;
      }
    }
  }
  x[1] ^= x[0];
  x[2] ^= x[1];
  std::uint32_t t = 0;
  for (std::uint32_t q = 1U << 15; q > 1; q >>= 1) t ^= (x[2] & q) != 0 ? q - 1 : 0;
  std::uint64_t place = 0;
  for (std::uint32_t& v : x) v ^= t;
  for (int bit = 15; bit >= 0; --bit) {
    for (const std::uint32_t v : x) place = place << 1 | (v >> bit & 1U);
  }
  return place;
}

/// In an order that says nothing, as photons are traced.
Bytes shuffled(std::span<const std::byte> records) {
  Bytes out(records.begin(), records.end());
  for (std::size_t i = out.size() / kPhotonBytes; i > 1; --i) {
    const std::size_t j = ddgi::hash(static_cast<std::uint32_t>(i)) % i;
    std::swap_ranges(&out[(i - 1) * kPhotonBytes], &out[(i - 1) * kPhotonBytes] + kPhotonBytes,
                     &out[j * kPhotonBytes]);
  }
  return out;
}

Bytes in_hilbert_order(std::span<const std::byte> records) {
  std::vector<std::pair<std::uint64_t, std::size_t>> order;
  for (std::size_t at = 0; at < records.size(); at += kPhotonBytes) {
    std::array<std::uint16_t, 3> p{};
    std::memcpy(p.data(), &records[at], sizeof p);
    order.emplace_back(hilbert({p[0], p[1], p[2]}), at);
  }
  std::sort(order.begin(), order.end());
  Bytes out;
  for (const auto& [place, at] : order) {
    const auto record = records.subspan(at, kPhotonBytes);
    out.insert(out.end(), record.begin(), record.end());
  }
  return out;
}

/// Differences to the record before, by component, small ones of both signs near 0. Components of
/// `places` only, or all of them.
Bytes deltas(const Record& format, std::span<const std::byte> records, bool all) {
  Bytes out(records.begin(), records.end());
  for (std::size_t at = records.size() - kPhotonBytes; at > 0; at -= kPhotonBytes) {
    for (const Component& c : format.used()) {
      if (c.bits % 8 != 0 || (!all && c.offset >= 48)) continue;
      const std::size_t bytes = c.bits / 8U, first = c.offset / 8U;
      std::uint32_t now = 0, before = 0;
      std::memcpy(&now, &records[at + first], bytes);
      std::memcpy(&before, &records[at - kPhotonBytes + first], bytes);
      const unsigned spare = 32U - c.bits;
      const auto d = static_cast<std::int32_t>((now - before) << spare) >> spare;
      const std::uint32_t folded =
          static_cast<std::uint32_t>(d) << 1 ^ static_cast<std::uint32_t>(d >> 31);
      std::memcpy(&out[at + first], &folded, bytes);
    }
  }
  return out;
}

struct Sizes {
  std::size_t batches = 0, photons = 0;
  std::size_t native = 0, any_order = 0, on_planes = 0, on_deltas = 0, mesh = 0;
};

std::size_t mesh_size([[maybe_unused]] std::span<const std::byte> records) {
#ifdef GICODEC_HAS_MESHOPTIMIZER
  const std::size_t count = records.size() / kPhotonBytes;
  Bytes out(meshopt_encodeVertexBufferBound(count, kPhotonBytes));
  out.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(out.data()), out.size(),
                                        records.data(), count, kPhotonBytes));
  return zstd_size(out);
#else
  return 0;
#endif
}

void add_sizes(Sizes& sizes, Encoder& native, const TextureDesc& desc, std::uint32_t slot,
               std::span<const std::byte> texture, std::span<const std::byte> counts) {
  std::uint16_t count = 0;
  std::memcpy(&count, &counts[slot * sizeof count], sizeof count);
  const auto records = texture.subspan(slot * block_bytes(desc), count * kPhotonBytes);
  native.request_keyframe();
  (void)native.set_presence(counts);
  const auto packet = native.encode(ConstTextureView(texture), std::vector<std::uint32_t>{slot});
  if (!packet) return;
  ++sizes.batches;
  sizes.photons += count;
  sizes.native += packet->size();
  sizes.any_order += zstd_size(planes(shuffled(records), kPhotonBytes));
  sizes.on_planes += zstd_size(planes(records, kPhotonBytes));
  const Bytes sorted = in_hilbert_order(records);
  sizes.on_deltas += std::min(zstd_size(planes(deltas(desc.record, sorted, true), kPhotonBytes)),
                              zstd_size(planes(deltas(desc.record, sorted, false), kPhotonBytes)));
  sizes.mesh += mesh_size(sorted);
}

std::size_t bytes_of(const std::vector<Packet>& packets) {
  std::size_t bytes = 0;
  for (const Packet& packet : packets) bytes += packet.size();
  return bytes;
}

struct Case {
  const char* scene;
  double start, fps;
  std::vector<std::string> more;  ///< settings
};

kinds::Feed feed_of(const Case& c, std::vector<std::string> settings) {
  kinds::TraceRequest request;
  request.scene = *ddgi::make_scene(c.scene);
  settings.insert(settings.end(), c.more.begin(), c.more.end());
  request.settings = kinds::Settings("photons", photons::kTracedPhotons.settings, settings);
  return photons::trace(std::move(request));
}

/// Batches with at least 10,000 stored photons, each coded by itself.
void print_sizes(const Case& c, const char* form, const std::vector<std::string>& settings) {
  auto all = settings;
  all.insert(all.end(), {"per-update=0", fmt::format("form={}", form), "max-batches=6"});
  const kinds::Feed feed = feed_of(c, all);
  const auto textures = feed.next({c.start, {}}).volumes[0].textures;
  const TextureDesc desc = textures_of(feed.volumes[0].desc)[2]->desc;
  EncoderOptions options;
  auto native = Encoder::create(desc, options);
  if (!native) return;
  Sizes sizes;
  for (std::uint32_t slot = 0; slot < block_count(desc); ++slot) {
    std::uint16_t count = 0;
    std::memcpy(&count, &textures[0][slot * sizeof count], sizeof count);
    if (count >= 10000) add_sizes(sizes, *native, desc, slot, textures[2], textures[0]);
  }
  const auto each = [&](std::size_t bytes) {
    return static_cast<double>(bytes) / static_cast<double>(sizes.photons);
  };
  fmt::print("| {} | {} | {} | {} | {:.2f}", c.scene, form, sizes.batches, sizes.photons,
             each(sizes.native));
  for (const std::size_t peer : {sizes.any_order, sizes.on_planes, sizes.on_deltas, sizes.mesh}) {
    if (peer == 0) {
      fmt::print(" | not built");
      continue;
    }
    fmt::print(" | {:.2f} ({:.2f})", each(peer),
               static_cast<double>(sizes.native) / static_cast<double>(peer));
  }
  fmt::print(" |\n");
  std::fflush(stdout);
}

/// Counts the states of each light as batches do, and how many updates later one of a state came.
class Latency {
 public:
  void look(const ddgi::FrameState& state, std::span<const std::byte> batches) {
    std::map<std::size_t, std::uint16_t> newest;
    for (std::size_t at = 0; at < batches.size(); at += kPhotonBatchBytes) {
      const auto b = unpack_photon_batch(
          std::span<const std::byte, kPhotonBatchBytes>(&batches[at], kPhotonBatchBytes));
      if (b.emitted != 0) newest[b.light] = std::max(newest[b.light], b.generation);
    }
    ++update_;
    lights_.resize(state.lights.size());
    for (std::size_t i = 0; i < lights_.size(); ++i) {
      Light& light = lights_[i];
      const auto& now = state.lights[i];
      const bool same = light.generation > 0 && light.state.colour == now.colour &&
                        light.state.position == now.position &&
                        light.state.direction == now.direction;
      if (!same) light.changed.emplace_back(++light.generation, update_);
      light.state = now;
      if (!(photons::mean(now.colour) > 0)) light.changed.clear();  // it has no batches
      auto& waiting = light.changed;
      const auto seen = std::partition(waiting.begin(), waiting.end(), [&](const auto& change) {
        return change.first > newest[i];
      });
      for (auto it = seen; it != waiting.end(); ++it) {
        const std::uint32_t took = update_ - it->second + 1;
        sum_ += took;
        most_ = std::max(most_, took);
        ++count_;
      }
      waiting.erase(seen, waiting.end());
    }
  }
  [[nodiscard]] double mean() const { return count_ > 0 ? static_cast<double>(sum_) / count_ : 0; }
  [[nodiscard]] std::uint32_t most() const { return most_; }

 private:
  struct Light {
    ddgi::Light state;
    std::uint16_t generation = 0;
    std::vector<std::pair<std::uint16_t, std::uint32_t>> changed;  ///< state, update
  };
  std::vector<Light> lights_;
  std::uint32_t update_ = 0, count_ = 0, most_ = 0;
  std::uint64_t sum_ = 0;
};

ddgi::Picture sum(ddgi::Picture a, const ddgi::Picture& b) {
  for (std::size_t i = 0; i < a.pixels.size(); ++i) a.pixels[i] += b.pixels[i];
  return a;
}

/// PSNR of the indirect light alone, and of the whole picture, against what paths gather.
std::string compare_pictures(const Case& c, const ddgi::Scene& scene, const ddgi::RayScene& rays,
                             ddgi::ClientLight& light, double time, const std::string& pictures,
                             ddgi::ThreadPool& pool) {
  ddgi::RenderOptions options = picture_options(320, 180);
  options.mode = ddgi::RenderMode::gi;
  const ddgi::Camera camera = scene.camera_at(time);
  photons::GatheredLight gathered(rays, 64);
  const auto drawn = ddgi::render(rays, &light, camera, options, pool);
  const auto reference = ddgi::render(rays, &gathered, camera, options, pool);
  options.mode = ddgi::RenderMode::direct;
  const auto direct = ddgi::render(rays, nullptr, camera, options, pool);
  const auto whole = sum(drawn, direct), whole_reference = sum(reference, direct);
  for (const auto& [name, picture] :
       {std::pair("indirect", &drawn), {"gathered", &reference}, {"picture", &whole}})
    keep_picture(pictures, fmt::format("{}-{}", c.scene, name), *picture, camera.exposure);
  return fmt::format("{:.1f} / {:.1f}", ddgi::compare(drawn, reference, camera.exposure).psnr,
                     ddgi::compare(whole, whole_reference, camera.exposure).psnr);
}

void print_table_2(const Case& c, const Options& o) {
  constexpr unsigned kFrames = 30, kMeasured = 20;
  const kinds::Feed feed = feed_of(c, o.settings);
  const kinds::FeedVolume& volume = feed.volumes[0];
  const ddgi::Scene scene = *ddgi::make_scene(c.scene);
  ddgi::RayScene rays(scene);
  const auto light = photons::light(rays, volume.desc);
  auto native = tools::take(VolumeEncoder::create(volume.desc, {.gop = 0}), c.scene);
  auto zstd =
      tools::take(VolumeEncoder::create(volume.desc, {.backend = "zstd", .gop = 0}), c.scene);
  Latency latency;
  double trace = 0, client = 0;
  std::size_t bytes = 0, by_zstd = 0, stored = 0, batches = 0;
  ddgi::ThreadPool pool;
  double time = c.start;
  for (unsigned f = 0; f < kFrames; ++f) {
    time = c.start + f / c.fps;
    const kinds::FeedFrame frame = feed.next({time, {}});
    const auto& textures = frame.volumes[0].textures;
    const std::vector<ConstTextureView> views(textures.begin(), textures.end());
    const std::size_t sent = bytes_of(tools::take(native.encode(views), c.scene));
    const std::size_t sent_zstd = bytes_of(tools::take(zstd.encode(views), c.scene));
    rays.set_state(scene.state_at(time));
    latency.look(rays.state(), textures[1]);
    const auto held = kinds::held_of(volume.desc, textures);
    const auto start = Clock::now();
    light->update({volume.desc, volume.geometry, held}, time);
    light->prepare(rays, {scene.camera_at(time), 1280, 720}, pool);
    if (f < kFrames - kMeasured) continue;
    client += seconds_since(start);
    trace += frame.seconds;
    bytes += sent;
    by_zstd += sent_zstd;
    stored = batches = 0;
    for (std::size_t at = 0; at < textures[0].size(); at += 2) {
      std::uint16_t count = 0;
      std::memcpy(&count, &textures[0][at], sizeof count);
      stored += count;
      std::uint32_t emitted = 0;
      std::memcpy(&emitted, &textures[1][at / 2 * kPhotonBatchBytes + 32], sizeof emitted);
      batches += emitted != 0;
    }
  }
  const std::string psnr = compare_pictures(c, scene, rays, *light, time, o.pictures, pool);
  const double mbps = 8e-6 * c.fps / kMeasured;
  fmt::print(
      "| {} | {} | {} | {:.1f} | {:.1f} | {:.0f} ms | {:.0f} ms | {} dB | {:.1f}, at most {} |\n",
      c.scene, batches, stored, mbps * static_cast<double>(bytes),
      mbps * static_cast<double>(by_zstd), 1000 * trace / kMeasured, 1000 * client / kMeasured,
      psnr, latency.mean(), latency.most());
  std::fflush(stdout);
}

tools::Exit run(const Options& o) {
  fmt::print(
      "Bytes a photon, in brackets native's share of them; batches of 10,000 stored photons and "
      "more, each by itself.\n\n"
      "| scene | form | batches | photons | native | zstd -19 on planes, shuffled | zstd -19 on "
      "planes, in canonical order | zstd -19 on Hilbert deltas | meshoptimizer + zstd -19 |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
  for (const Case& c : {Case{"tomb", 6, 10, {"photons=36864"}}, Case{"villa", 40, 10, {}},
                        Case{"street", 4, 10, {"photons=98304", "per-watt=1"}}}) {
    for (const char* form : {"Q", "R"}) print_sizes(c, form, o.settings);
  }
  fmt::print(
      "\n10 updates a second.\n\n"
      "| scene | batches | stored photons | Mbps, native | Mbps, zstd | server, trace | client, "
      "1280×720 | PSNR, indirect / picture | updates until first photons |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
  for (const Case& c :
       {Case{"tomb", 6, 10, {}}, Case{"villa", 5, 10, {}}, Case{"street", 4, 10, {}}}) {
    print_table_2(c, o);
  }
  return tools::Exit::ok;
}

}  // namespace

void add_photons(tools::Command& command, Measurement& chosen) {
  const auto options = std::make_shared<Options>();
  command.add_option("settings", options->settings, "SETTING=VALUE of the kind");
  command.add_option("--pictures", options->pictures, "Folder for pictures");
  choose(command, chosen, options, run);
}

}  // namespace gicodec::bench
