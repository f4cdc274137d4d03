#include "cases.h"

#ifdef GICODEC_HAS_HEVC
#include <gicodec/hevc.h>
#endif

namespace gicodec::bench {

std::vector<Case> cases(Isa isa) {
  std::vector<Case> all = {{.label = "raw", .backend = "raw", .preset = {}, .difference = false},
                           {"lz4, acceleration 16", "lz4", "", -16},
                           {"lz4, acceleration 4", "lz4", "", -4},
                           {"lz4 -1", "lz4", "", 1},
                           {"zstd --fast=5", "zstd", "", -5},
                           {"zstd --fast=1", "zstd", "", -1},
                           {"zstd -1", "zstd", "", 1},
                           {"zstd -3", "zstd", "", 3},
                           {"zstd -19", "zstd", "", 19, nullptr, true},
                           {"native turbo", "native", "turbo"},
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

Encoder make_encoder(const TextureDesc& desc, const Case& c, unsigned threads) {
  EncoderOptions options;
  options.settings.threads = threads;
  options.backend = c.backend;
  options.settings.preset = c.preset;
  options.settings.level = c.level;
  options.settings.isa = c.isa;
  options.settings.difference = c.difference;
  options.gop = 0;
  if (c.object != nullptr) options.backends = {c.object};
  return *Encoder::create(desc, options);
}
Decoder make_decoder(const TextureDesc& desc, const Case& c, unsigned threads) {
  DecoderOptions options;
  options.threads = threads;
  options.isa = c.isa;
  if (c.object != nullptr) options.backends = {c.object};
  return *Decoder::create(desc, options);
}

std::string refusal(const TextureDesc& desc, const Case& c) {
  EncoderOptions options;
  options.backend = c.backend;
  if (c.object != nullptr) options.backends = {c.object};
  const auto encoder = Encoder::create(desc, options);
  return encoder ? "" : std::string(to_string(encoder.status()));
}

}  // namespace gicodec::bench
