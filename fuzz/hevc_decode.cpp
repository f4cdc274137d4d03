// Decoding of HEVC payloads: the first byte chooses texture, packing, layout and decoder, then come
// parts of a byte (bit 0: keyframe), blocks and payload. Whatever was decoded before, a second
// session gives the same, and a good keyframe and a good update are exact.
#include "hevc_setup.h"
#include "mutate.h"

namespace {

using namespace gicodec;
using namespace gicodec::fuzz;

constexpr std::size_t kHead = 1;

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  const HevcSetup& setup = setup_of(input.byte());
  const auto& desc = setup.desc;
  const auto open = [&] {
    auto decoder = HevcBackend(setup.settings).make_decoder(desc);
    check(decoder.ok(), "a decoder opens");
    return *std::move(decoder);
  };
  const auto decoder = open(), twin = open();
  bool broken = true;  // No keyframe yet, or an error since.
  for (int i = 0; i < 4 && !input.empty(); ++i) {
    Input part(input.part().bytes);
    const bool keyframe = (part.byte() & 1) != 0;
    const auto blocks = part.blocks(desc);
    Exact payload(part.rest());
    Exact texels(blocks.size() * block_bytes(desc), 0), again(texels.span().size(), 1);
    const Status status =
        decoder->decode({desc, blocks, payload.span(), {}, texels.span(), keyframe});
    check(twin->decode({desc, blocks, payload.span(), {}, again.span(), keyframe}) == status,
          "the same verdict again");
    check(status != Status::ok || same(texels.span(), again.span()),
          "every texel is written, the same again");
    check(!broken || keyframe || status == Status::reference_missing,
          "after an error nothing but a keyframe is decoded");
    broken = status != Status::ok;
  }
  for (const auto& good : setup.updates) {
    Exact texels(good.records.size());
    check(decoder->decode(
              {desc, good.blocks, good.payload, {}, texels.span(), &good == setup.updates}) ==
              Status::ok,
          "a good packet is decoded, whatever came before");
    check(same(texels.span(), good.records), "exactly");
  }
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  return mutate_parts(data, size, max_size, seed, kHead, mutate_blindly);
}
