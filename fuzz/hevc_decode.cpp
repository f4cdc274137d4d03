// Decoding of HEVC payloads. The first byte chooses texture and decoder; then payloads follow, each
// behind a byte with its keyframe flag and number of probes and two bytes with its size.
#include <gicodec/hevc.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <string>
#include <vector>

namespace {

gicodec::TextureDesc describe(unsigned choice) {
  using gicodec::Format;
  constexpr Format kFormats[] = {Format::A2R10G10B10_UNORM_PACK32, Format::R16G16_SFLOAT,
                                 Format::R32G32B32A32_SFLOAT, Format::E5B9G9R9_UFLOAT_PACK32};
  return {kFormats[choice % 4], {3, 1, 2}, 8, 1, gicodec::Tiling::atlas_xy_z};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  auto rest = std::as_bytes(std::span(data, size));
  if (rest.empty()) return 0;
  const auto choice = std::to_integer<unsigned>(rest[0]);
  rest = rest.subspan(1);
  gicodec::HevcSettings settings;
  settings.decoder = (choice & 4U) != 0 ? "ffmpeg" : "libde265";
  const gicodec::TextureDesc desc = describe(choice);
  auto decoder = gicodec::HevcBackend(settings).make_decoder(desc);
  if (!decoder) return 0;
  const std::vector<std::byte> mirror(gicodec::probe_count(desc) * gicodec::core_bytes(desc));
  while (rest.size() >= 3) {
    const auto head = std::to_integer<unsigned>(rest[0]);
    const std::size_t stated =
        std::to_integer<std::size_t>(rest[1]) | std::to_integer<std::size_t>(rest[2]) << 8;
    rest = rest.subspan(3);
    // A copy of its own, so that a read past its end is found.
    const auto part = rest.first(std::min(stated, rest.size()));
    const std::vector<std::byte> payload(part.begin(), part.end());
    rest = rest.subspan(part.size());
    std::vector<std::uint32_t> probes((head >> 1) % (gicodec::probe_count(desc) + 1));
    std::iota(probes.begin(), probes.end(), 0U);
    std::vector<std::byte> texels(probes.size() * gicodec::core_bytes(desc));
    static_cast<void>(
        (*decoder)->decode({desc, probes, payload, mirror, texels, (head & 1U) != 0}));
  }
  return 0;
}
