// Packets of hevc, and of whatever they become, through a decoder with the hevc backend. The first
// byte chooses texture, packing, layout and third-party decoder. Whatever came before, a good
// keyframe and a good update are decoded, the same on any two instruction sets.
#include "hevc_setup.h"
#include "packets.h"

#include "backend/hevc/picture.h"

namespace {

using namespace gicodec;
using namespace gicodec::fuzz;

constexpr unsigned kAsItStands = 1, kOnlyChecksum = 2;
constexpr std::size_t kHead = 1;

/// Of the third-party decoders nothing is promised but the largest size of a picture. They hold up
/// to 16 for reference and the one being decoded (H.265, A.4.2), with what they note of each block;
/// all that does not grow with pictures are contexts, tables and pools.
Allowance coder_of(const TextureDesc& desc) {
  constexpr std::size_t kFixed = std::size_t{4} << 20, kPictures = 17;
  std::size_t largest = 0;
  for (const auto packing : {HevcPacking::paper, HevcPacking::planes}) {
    for (const auto layout : {HevcLayout::atlas, HevcLayout::packed}) {
      const std::uint8_t size_class =
          layout == HevcLayout::packed ? hevc::size_class_of(desc, block_count(desc)) : 0;
      const auto shape = hevc::frame_shape(desc, packing, layout, size_class);
      check(shape.ok(), "small textures have a picture");
      const auto& picture = shape->picture;
      largest = std::max(largest, 3 * std::size_t{picture.width} * picture.height * 2);
    }
  }
  return {kFixed + kPictures * 2 * largest, 2 * (kFixed + kPictures * 2 * largest)};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  const HevcSetup& setup = setup_of(input.byte());
  const auto& desc = setup.desc;
  const HevcBackend backend(setup.settings);
  const auto open = [&](Isa isa) {
    auto decoder = Decoder::create(desc, {.backends = {&backend}, .isa = isa});
    check(decoder.ok(), "a decoder is made");
    return WatchedDecoder(*std::move(decoder), coder_of(desc));
  };
  auto decoder = open(best_isa()), twin = open(Isa::scalar);
  bool broken = true;  // No keyframe yet, or an error of the backend since.
  const auto decode = [&](std::span<const std::byte> packet) {
    const bool worked = work_of(decoder.decoder(), packet) != 0;
    const Status status = decoder.decode(packet);
    check(twin.decode(packet) == status && twin.records() == decoder.records(),
          "one verdict and one result on any two instruction sets");
    const auto info = peek(packet);
    if (!worked || info->backend != kBackendHevc) return status;
    check(!broken || is_keyframe(info->type) || status != Status::ok,
          "after an error nothing but a keyframe is decoded");
    // Damaged guard bands are seen before the backend sees anything.
    if (status == Status::ok || info->guard_band_size == 0) broken = status != Status::ok;
    return status;
  };
  for (int i = 0; i < 6 && !input.empty(); ++i) {
    const auto part = input.part();
    Bytes bytes(part.bytes.begin(), part.bytes.end());
    if (part.flags == kOnlyChecksum) {
      reseal(bytes);
    } else if (part.flags != kAsItStands) {
      put_right(bytes, desc, state_of(decoder.decoder()));
    }
    static_cast<void>(decode(Exact(bytes).span()));
  }
  for (unsigned k = 0; k < 2; ++k) {
    Bytes packet = packet_of(setup, k);
    put_right(packet, desc, state_of(decoder.decoder()));
    check(decode(packet) == Status::ok, "a good packet is decoded, whatever came before");
  }
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  return mutate_parts(data, size, max_size, seed, kHead, mutate_part_packet);
}
