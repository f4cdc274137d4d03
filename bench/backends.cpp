// Encoder and Decoder sessions with each backend; bytes per second count records. The second
// of two alternating frames is coded over and over, so every block changes in every update.
#include "volume.h"

#include <gicodec/gicodec.h>
#ifdef GICODEC_HAS_HEVC
#include <gicodec/hevc.h>
#endif

#include <benchmark/benchmark.h>

#include <string>

namespace gicodec::bench {
namespace {

struct Case {
  const char* name;
  const char* backend;
  int level;
  bool difference;
  const char* preset;
};
constexpr Case kCases[] = {
    {"raw", "raw", 0, false, ""},
    {"raw_difference", "raw", 0, true, ""},
    {"lz4_1", "lz4", 1, true, ""},
    {"lz4_1_no_difference", "lz4", 1, false, ""},
    {"zstd_1", "zstd", 1, true, ""},
    {"zstd_3", "zstd", 3, true, ""},
    {"zstd_3_no_difference", "zstd", 3, false, ""},
    {"zstd_19", "zstd", 19, true, ""},
    {"native_fast", "native", 0, true, "fast"},
    {"native_strong", "native", 0, true, "strong"},
#ifdef GICODEC_HAS_HEVC
    {"hevc_ultrafast", "hevc", 0, true, "ultrafast"},
#endif
};

std::vector<const Backend*> extra_backends() {
#ifdef GICODEC_HAS_HEVC
  static const HevcBackend hevc;
  return {&hevc};
#else
  return {};
#endif
}

Encoder make_encoder(const TextureDesc& desc, const Case& c) {
  EncoderOptions options;
  options.backend = c.backend;
  options.settings.level = c.level;
  options.settings.difference = c.difference;
  options.settings.preset = c.preset;
  options.gop = 0;
  options.backends = extra_backends();
  return *Encoder::create(desc, options);
}

void encode(benchmark::State& state, const Case& c, const TextureDesc& desc) {
  const std::vector<std::byte> frames[] = {make_texture(desc, 1), make_texture(desc, 1.01F)};
  auto encoder = make_encoder(desc, c);
  Packet packet;
  std::size_t frame = 0;
  auto status = encoder.encode_to(ConstTextureView(frames[1]), Selection::changed(), packet);
  for (auto _ : state) {
    status = encoder.encode_to(ConstTextureView(frames[frame++ % 2]), Selection::changed(), packet);
    if (status != Status::ok) state.SkipWithError(std::string(to_string(status)).c_str());
  }
  const double records =
      static_cast<double>(block_count(desc)) * static_cast<double>(block_bytes(desc));
  state.SetBytesProcessed(static_cast<std::int64_t>(records) *
                          static_cast<std::int64_t>(state.iterations()));
  state.counters["ratio_to_records"] = records / static_cast<double>(packet.size());
}

void decode(benchmark::State& state, const Case& c, const TextureDesc& desc) {
  const std::vector<std::byte> frames[] = {make_texture(desc, 1), make_texture(desc, 1.01F)};
  // A keyframe and four updates, decoded in turn; the keyframe's time is not counted.
  auto encoder = make_encoder(desc, c);
  std::vector<Packet> packets;
  for (std::size_t i = 0; i < 5; ++i) {
    packets.push_back(*encoder.encode(ConstTextureView(frames[i % 2]), Selection::all()));
  }
  auto decoder = Decoder::create(desc, {.limits = {}, .backends = extra_backends()});
  std::vector<std::byte> texture(texture_bytes(desc));
  std::size_t next = 0;
  for (auto _ : state) {
    if (next % packets.size() == 0) {
      state.PauseTiming();
      const Status status = decoder->decode(packets[0], {texture});
      if (status != Status::ok) state.SkipWithError("the keyframe did not decode");
      next = 1;
      state.ResumeTiming();
    }
    const Status status = decoder->decode(packets[next++], {texture});
    if (status != Status::ok) state.SkipWithError(std::string(to_string(status)).c_str());
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(block_count(desc) * block_bytes(desc)) *
                          static_cast<std::int64_t>(state.iterations()));
}

const int kRegistered = [] {
  for (const auto& c : kCases) {
    for (const bool colour : {true, false}) {
      const auto desc = colour ? ddgi_irradiance(kGrid) : ddgi_visibility(kGrid);
      const std::string tail = std::string("/") + c.name + (colour ? "/colour" : "/visibility");
      benchmark::RegisterBenchmark(("BM_encode" + tail).c_str(), encode, c, desc);
      benchmark::RegisterBenchmark(("BM_decode" + tail).c_str(), decode, c, desc);
    }
  }
  return 0;
}();

}  // namespace
}  // namespace gicodec::bench
