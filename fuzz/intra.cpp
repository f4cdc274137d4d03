// Fresh packets, one after another, mixed with others, for a decoder that holds something: one
// verdict and one result on any two instruction sets, blocks that are not listed stay, and what the
// listed ones held before makes no difference.
#include "packets.h"

namespace {

using namespace gicodec;
using namespace gicodec::fuzz;

constexpr unsigned kAsItStands = 1, kOnlyChecksum = 2, kAsItIs = 3;
constexpr std::size_t kHead = 7;

/// A keyframe of these blocks of these texels.
Packet keyframe_of(const TextureDesc& desc, std::span<const std::byte> texels,
                   const Selection& blocks = Selection::all()) {
  auto encoder = Encoder::create(desc, {.backend = "raw"});
  check(encoder.ok(), "an encoder is made");
  auto packet = encoder->encode(ConstTextureView{texels}, blocks);
  check(packet.ok(), "anything is encoded");
  return *std::move(packet);
}

WatchedDecoder decoder_that_holds(const TextureDesc& desc, const Packet& keyframe,
                                  const DecoderOptions& options) {
  auto decoder = Decoder::create(desc, options);
  check(decoder.ok(), "a valid description makes a decoder");
  check(decoder->decode(keyframe) == Status::ok, "its keyframe is decoded");
  return WatchedDecoder(*std::move(decoder));
}

/// After `packet`, which was intra: the same blocks come out where the listed ones were others.
void check_independence(const Decoder& decoder, const Bytes& before, const Bytes& after,
                        std::span<const std::byte> packet) {
  const auto& desc = decoder.desc();
  std::vector<std::uint32_t> kept, received;  // now: the packet's blocks too
  for (std::uint32_t block = 0; block < block_count(desc); ++block) {
    if (!std::ranges::binary_search(decoder.changed(), block)) kept.push_back(block);
    if (decoder.received()[block] != 0) received.push_back(block);
  }
  Exact other(before.size(), 1);
  Bytes replaced = before;
  check(decoder.read(TextureView{other.span()}, kept) == Status::ok &&
            decoder.read(TextureView{replaced}, decoder.changed()) == Status::ok &&
            replaced == after,
        "blocks that are not listed stay");
  auto stranger = decoder_that_holds(desc, keyframe_of(desc, other.span(), received), {});
  Bytes bytes(packet.begin(), packet.end());
  put_right(bytes, desc, state_of(stranger.decoder()));
  check(stranger.decode(bytes) == Status::ok && stranger.records() == after,
        "an intra packet does not look at what its blocks held");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  const auto desc = input.desc();
  const unsigned choice = input.byte();
  // Guard bands that follow the rule, since all texels are one, or that do not.
  Exact texels(static_cast<std::size_t>(texture_bytes(desc)));
  if ((choice & 1U) != 0) std::ranges::fill(texels.span(), std::byte{0x3C});
  const Packet keyframe = keyframe_of(desc, texels.span());
  const auto isas = supported_isas();
  auto decoder = decoder_that_holds(desc, keyframe, {.isa = isas[choice / 2 % isas.size()]});
  auto twin = decoder_that_holds(desc, keyframe,
                                 {.isa = isas[(choice / 2 + 1 + choice / 8) % isas.size()]});
  for (int i = 0; i < 8 && !input.empty(); ++i) {
    const auto part = input.part();
    Bytes bytes(part.bytes.begin(), part.bytes.end());
    const StreamState state = state_of(decoder.decoder());
    if (part.flags == kOnlyChecksum) {
      reseal(bytes);
    } else if (part.flags != kAsItStands) {
      put_right(bytes, desc, state, part.flags == kAsItIs ? As::it_is : As::intra);
    }
    Exact packet(bytes);
    const Bytes before = decoder.records();
    const Status status = decoder.decode(packet.span());
    check(twin.decode(packet.span()) == status, "one verdict on any two instruction sets");
    check(twin.records() == decoder.records() &&
              twin.decoder().state_hash() == decoder.decoder().state_hash() &&
              std::ranges::equal(twin.decoder().changed(), decoder.decoder().changed()),
          "one result on any two instruction sets");
    if (status != Status::ok || !is_intra(peek(packet.span())->type)) continue;
    check_independence(decoder.decoder(), before, decoder.records(), packet.span());
  }
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  return mutate_parts(data, size, max_size, seed, kHead, mutate_part_packet);
}
