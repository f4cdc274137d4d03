// Sizes and speeds of all backends and presets side by side, on probe dumps:
//
//   sizes_and_speeds [--quick] [--isa scalar|sse4|avx2|avx512] DUMPS...
//
// Per sequence and texture: bits per record of a keyframe and of updates of the changed probes
// (whole packets), the ratio to the full atlas over the sequence, and, for updates of every probe,
// bytes of records per second of processor time of one thread, encode and decode. Then bytes per
// probe of updates of a few probes.
#include "dump/dump.h"
#include "dump/error.h"
#include "dump/sequence.h"

#include <gicodec/gicodec.h>
#ifdef GICODEC_HAS_HEVC
#include <gicodec/hevc.h>
#endif

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <functional>
#include <numeric>
#include <stdexcept>

namespace gicodec::bench {
namespace {

/// Of the whole process, so that hidden threads count.
double processor_time() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Case {
  std::string label, backend, preset;
  int level = 0;
  const Backend* object = nullptr;  ///< where not built in
  bool slow = false;                ///< left out by --quick
  Isa isa = best_isa();
};

std::vector<Case> cases(Isa isa) {
  std::vector<Case> all = {{"raw", "raw", ""},
                           {"lz4 -1", "lz4", "", 1},
                           {"zstd -3", "zstd", "", 3},
                           {"zstd -19", "zstd", "", 19, nullptr, true},
                           {"native fast", "native", "fast"},
                           {"native strong", "native", "strong"}};
#ifdef GICODEC_HAS_HEVC
  const auto hevc = [](HevcPacking packing, const char* decoder) -> const Backend* {
    HevcSettings s;
    s.packing = packing;
    s.decoder = decoder;
    return new HevcBackend(s);  // lives as long as the program
  };
  all.push_back(
      {"x265 ultrafast, libde265", "hevc", "ultrafast", 0, hevc(HevcPacking::paper, "libde265")});
  all.push_back(
      {"x265 ultrafast, FFmpeg", "hevc", "ultrafast", 0, hevc(HevcPacking::paper, "ffmpeg")});
  all.push_back(
      {"x265 slow, paper's planes", "hevc", "slow", 0, hevc(HevcPacking::paper, "ffmpeg"), true});
  all.push_back(
      {"x265 slow, better planes", "hevc", "slow", 0, hevc(HevcPacking::planes, "ffmpeg"), true});
#endif
  for (Case& c : all) c.isa = isa;
  return all;
}

struct Texture {
  TextureDesc desc;
  std::vector<std::vector<std::byte>> frames;
};

Encoder make_encoder(const TextureDesc& desc, const Case& c) {
  EncoderOptions options;
  options.backend = c.backend;
  options.settings.preset = c.preset;
  options.settings.level = c.level;
  options.settings.isa = c.isa;
  options.gop = 0;
  if (c.object != nullptr) options.backends = {c.object};
  return *Encoder::create(desc, options);
}
Decoder make_decoder(const TextureDesc& desc, const Case& c) {
  DecoderOptions options;
  options.isa = c.isa;
  if (c.object != nullptr) options.backends = {c.object};
  return *Decoder::create(desc, options);
}

struct Speeds {
  double encode = 1e30, decode = 1e30;  ///< best seconds of one update
};

/// Frames 1 and 2 in turn on top of frame 0, all probes.
Speeds measure_speed(const Texture& t, const Case& c, int rounds) {
  auto encoder = make_encoder(t.desc, c);
  auto decoder = make_decoder(t.desc, c);
  Speeds s;
  Packet packet;
  std::vector<std::byte> out(texture_bytes(t.desc));
  for (int i = 0; i <= rounds; ++i) {
    const auto& frame =
        t.frames[static_cast<std::size_t>(i) % std::min<std::size_t>(t.frames.size(), 3)];
    double start = processor_time();
    if (encoder.encode_to(ConstTextureView(frame), Selection::all(), packet) != Status::ok)
      return {};
    if (i > 0) s.encode = std::min(s.encode, processor_time() - start);
    start = processor_time();
    if (decoder.decode(packet, TextureView{out}) != Status::ok) return {};
    if (i > 0) s.decode = std::min(s.decode, processor_time() - start);
    if (out != frame) return {};
  }
  return s;
}

void report(const Texture& t, const Case& c, int rounds) {
  auto encoder = make_encoder(t.desc, c);
  auto decoder = make_decoder(t.desc, c);
  std::size_t key = 0, updates = 0, changed = 0;
  for (std::size_t f = 0; f < t.frames.size(); ++f) {
    auto packet = encoder.encode(ConstTextureView(t.frames[f]),
                                 f == 0 ? Selection::all() : Selection::changed());
    if (!packet || decoder.decode(*packet) != Status::ok) {
      fmt::print("{:<26} failed\n", c.label);
      return;
    }
    (f == 0 ? key : updates) += packet->size();
    if (f > 0) changed += peek(*packet)->blocks;
  }
  const double texels = record_count(t.desc.block);
  const double full =
      static_cast<double>(texture_bytes(t.desc)) * static_cast<double>(t.frames.size());
  const double records = static_cast<double>(block_bytes(t.desc)) * block_count(t.desc);
  const Speeds s = measure_speed(t, c, rounds);
  fmt::print("{:<26} {:8.3f} {:8.3f} {:9.2f} {:9.0f} {:9.0f}\n", c.label,
             static_cast<double>(key) * 8 / (texels * block_count(t.desc)),
             changed == 0
                 ? 0.0
                 : static_cast<double>(updates) * 8 / (texels * static_cast<double>(changed)),
             full / static_cast<double>(key + updates), records / s.encode / 1e6,
             records / s.decode / 1e6);
  std::fflush(stdout);
}

/// Bytes per probe of packets of a few probes that changed, one next to the other.
void report_small_updates(const Texture& t, Isa isa) {
  if (t.frames.size() < 2) return;
  constexpr std::size_t kCounts[] = {1, 8, 32, 100};
  fmt::print("{:<26}", "bytes per probe of updates");
  for (const auto n : kCounts) fmt::print(" {:>8}", n);
  fmt::print(" {:>8}\n", "changed");
  for (const auto& c : cases(isa)) {
    if (c.object != nullptr || c.slow || c.backend == "raw") continue;
    fmt::print("{:<26}", c.label);
    auto encoder = make_encoder(t.desc, c);
    auto decoder = make_decoder(t.desc, c);
    const auto key = encoder.encode(ConstTextureView(t.frames[0]), Selection::all());
    auto all = encoder.encode(ConstTextureView(t.frames[1]), Selection::changed());
    if (!key || !all || decoder.decode(*key) != Status::ok || decoder.decode(*all) != Status::ok)
      return;
    const std::vector<std::uint32_t> changed(decoder.updated().begin(), decoder.updated().end());
    for (const auto n : kCounts) {
      if (changed.size() < n) continue;
      const auto first = changed.begin() + static_cast<std::ptrdiff_t>((changed.size() - n) / 2);
      const std::vector<std::uint32_t> some(first, first + static_cast<std::ptrdiff_t>(n));
      auto fresh = make_encoder(t.desc, c);
      (void)fresh.encode(ConstTextureView(t.frames[0]), Selection::all());
      const auto packet = fresh.encode(ConstTextureView(t.frames[1]), Selection(some));
      fmt::print(" {:8.1f}",
                 packet ? static_cast<double>(packet->size()) / static_cast<double>(n) : 0.0);
    }
    fmt::print(" {:8.1f}\n", static_cast<double>(all->size()) /
                                 static_cast<double>(std::max<std::size_t>(1, changed.size())));
  }
}

int run(int argc, char** argv) {
  bool quick = false;
  Isa isa = best_isa();
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]) == "--quick") {
      quick = true;
      continue;
    }
    if (std::string_view(argv[i]) == "--isa" && i + 1 < argc) {
      const auto named = isa_from_string(argv[++i]);
      if (!named || !is_supported(*named)) {
        throw std::runtime_error(fmt::format("this machine has no {}", argv[i]));
      }
      isa = *named;
      continue;
    }
    for (const auto& sequence : tools::group_sequences({argv[i]})) {
      Texture t;
      for (const auto& file : sequence.frames) {
        auto dump = tools::read_dump(file.path);
        t.desc = dump.info.desc;
        t.frames.push_back(std::move(dump.texels));
      }
      fmt::print("\n{} {}: {} frames\n{:<26} {:>8} {:>8} {:>9} {:>9} {:>9}\n", argv[i],
                 sequence.name, t.frames.size(), "", "key b/t", "upd b/t", "ratio", "enc MB/s",
                 "dec MB/s");
      for (const auto& c : cases(isa)) {
        if (!quick || !c.slow) report(t, c, c.slow || c.backend == "hevc" ? 2 : 25);
      }
      report_small_updates(t, isa);
    }
  }
  return 0;
}

}  // namespace
}  // namespace gicodec::bench

int main(int argc, char** argv) {
  try {
    return gicodec::bench::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "sizes_and_speeds: {}\n", error.what());
    return 1;
  }
}
