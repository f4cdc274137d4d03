// Whatever the records, they come back, within the bound, from the same bytes on every instruction
// set, with memory that stay from update to update as in a session or fresh ones.
#include "mutate.h"
#include "native_settings.h"

#include "quantise/set_order.h"
#include "texture/presence.h"

namespace {

using namespace gicodec;
using namespace gicodec::fuzz;

constexpr std::size_t kHead = 6 + 4;

/// What the input holds, over and over, as new records or as changes of the old ones.
void paint(std::span<const std::byte> pattern, bool change, std::span<std::byte> records) {
  if (pattern.empty()) return;
  for (std::size_t i = 0; i < records.size(); ++i) {
    records[i] = (change ? records[i] : std::byte{0}) ^ pattern[i % pattern.size()];
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  const auto desc = input.any_desc();
  const auto presence = input.presence(desc);
  const std::size_t block = block_bytes(desc), said = presence_bytes(desc);
  const auto flags = input.byte();
  native::PayloadSettings settings = native_settings(flags);
  // A few boxes of any shape, or those of the encoder's choice.
  Grid box{1 + input.byte() % desc.grid.x, 1 + input.byte() % desc.grid.y,
           1 + input.byte() % desc.grid.z};
  while (native::chunk_grid(desc.grid, box).count() > 6) {
    for (auto [side, most] : {std::pair(&box.x, desc.grid.x), std::pair(&box.y, desc.grid.y),
                              std::pair(&box.z, desc.grid.z)}) {
      *side = std::min(*side + 1, most);
    }
  }
  if ((flags & 4) != 0) settings.box = box;

  const auto isas = supported_isas();
  native::PayloadMemory encoders[4], decoders[4];
  Exact mirror(block_count(desc) * block);
  std::vector<std::uint8_t> received(block_count(desc), 1);
  for (int i = 0; i < 4 && !input.empty(); ++i) {
    Input part(input.part().bytes);
    const auto kind = part.byte();
    const bool keyframe = (kind & 1) != 0, intra = (kind & 5) == 5;
    const auto blocks = part.blocks(desc);
    Exact records(blocks.size() * block_bytes(desc));
    gather(desc, blocks, mirror.span(), records.span());
    paint(part.rest(), (kind & 2) != 0, records.span());
    std::vector<std::byte> exists;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      const auto one = std::span(presence).subspan(blocks[b] * said, said);
      exists.insert(exists.end(), one.begin(), one.end());
      const auto of_block = records.span().subspan(b * block, block);
      clear_absent(desc, one, of_block);
      if (desc.model == Model::unordered && (flags & 8) != 0) sort_set(desc.record, of_block);
    }

    const BlockTable existed{presence.data(), said};
    const MirrorView held{{mirror.span().data(), block}, received.data(), existed};
    Exact changed(mirror.span());
    scatter(desc, blocks, Exact(records.span().size(), 1).span(), changed.span());
    const MirrorView others{{changed.span().data(), block}, received.data(), existed};
    const MirrorView known = intra ? others : keyframe ? MirrorView{} : held;
    const BlockTable table{records.span().data(), block};
    native::PayloadMemory unused;
    std::vector<std::byte> first;
    const auto encode_job = [&](const MirrorView& mirror_view) {
      return EncodeJob{.desc = desc,
                       .blocks = blocks,
                       .records = table,
                       .mirror = mirror_view,
                       .keyframe = keyframe,
                       .intra = intra,
                       .presence = exists};
    };
    const auto decode_job = [&](const MirrorView& mirror_view, Exact& bytes, Exact& out) {
      return DecodeJob{.desc = desc,
                       .blocks = blocks,
                       .payload = bytes.span(),
                       .mirror = mirror_view,
                       .records = out.span(),
                       .keyframe = keyframe,
                       .intra = intra,
                       .presence = exists};
    };
    native::encode_payload(encode_job(known), settings, isas[0], unused, first);
    check(first.size() <= native::payload_bound(desc, blocks.size()), "within the bound");
    Exact payload(first);
    for (std::size_t k = 0; k < isas.size(); ++k) {
      std::vector<std::byte> out;
      native::encode_payload(encode_job(held), settings, isas[k], encoders[k], out);
      check(out == first, "the same bytes on every instruction set, whatever was encoded before");
      Exact back(records.span().size(), static_cast<unsigned>(k));
      check(native::decode_payload(decode_job(held, payload, back), isas[k], decoders[k]) ==
                Status::ok,
            "own payloads decode");
      check(same(back.span(), records.span()), "exactly");
    }
    Exact back(records.span().size(), 1);
    check(native::decode_payload(decode_job(known, payload, back), isas[0], unused) == Status::ok,
          "a new workspace decodes");
    check(same(back.span(), records.span()), "exactly");
    if (keyframe && !intra) {
      std::ranges::fill(mirror.span(), std::byte{0});
      std::ranges::fill(received, std::uint8_t{0});
    }
    scatter(desc, blocks, records.span(), mirror.span());
    for (const auto b : blocks) received[b] = 1;
  }
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  return mutate_parts(data, size, max_size, seed, kHead, mutate_blindly);
}
