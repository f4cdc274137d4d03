// Speed of native by the instruction sets of this machine, or by one of them:
//
//   native_speeds [SET [SECONDS]]
//
// Sessions of one thread on 4,096 made-up probes, all of which change in every update. Prints MB of
// records per second, the best of the updates of so many seconds, a line per set, preset and
// texture: set, preset, texture, encode, decode. Needs no files, so that other machines can be
// measured by the same program.
#include "volume.h"

#include <gicodec/gicodec.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>

namespace gicodec::bench {
namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// False if something is wrong.
bool measure(Isa isa, const char* preset, const char* name, const TextureDesc& desc,
             double seconds) {
  EncoderOptions options;
  options.settings.preset = preset;
  options.settings.isa = isa;
  options.gop = 0;
  DecoderOptions decoding;
  decoding.isa = isa;
  auto encoder = Encoder::create(desc, options);
  auto decoder = Decoder::create(desc, decoding);
  if (!encoder || !decoder) return false;
  const std::vector<std::byte> frames[] = {make_texture(desc, 1), make_texture(desc, 1.01F)};
  std::vector<std::byte> out(frames[0].size());
  Packet packet;
  double encode = 1e30, decode = 1e30;
  const double begin = now();
  for (std::size_t i = 0; i < 6 || now() - begin < seconds; ++i) {
    const auto& frame = frames[i % 2];
    const double start = now();
    if (encoder->encode_to(ConstTextureView(frame), Selection::all(), packet) != Status::ok) {
      return false;
    }
    const double encoded = now();
    if (decoder->decode(packet, TextureView{out}) != Status::ok) return false;
    const double decoded = now();
    if (out != frame) return false;
    if (i == 0) continue;  // The keyframe.
    encode = std::min(encode, encoded - start);
    decode = std::min(decode, decoded - encoded);
  }
  const double records = static_cast<double>(block_count(desc) * block_bytes(desc)) / 1e6;
  std::printf("%s %s %s %.1f %.1f\n", std::string(to_string(isa)).c_str(), preset, name,
              records / encode, records / decode);
  std::fflush(stdout);
  return true;
}

int run(int argc, char** argv) {
  const double seconds = argc > 2 ? std::atof(argv[2]) : 1;
  bool sound = true;
  for (const Isa isa : supported_isas()) {
    if (argc > 1 && to_string(isa) != argv[1]) continue;
    for (const char* preset : {"turbo", "fast", "strong"}) {
      sound &= measure(isa, preset, "colour", ddgi_irradiance(kGrid), seconds);
      sound &= measure(isa, preset, "visibility", ddgi_visibility(kGrid), seconds);
    }
  }
  return sound ? 0 : 1;
}

}  // namespace
}  // namespace gicodec::bench

int main(int argc, char** argv) { return gicodec::bench::run(argc, argv); }
