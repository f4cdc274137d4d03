// Packets with one fault each.
#include "golden/make_golden.h"

#include "bitstream/packet.h"
#include "native/frame/payload.h"

#include <numeric>

namespace gicodec::golden {
namespace {

using test::Bytes;
using test::reseal;

void bad_packets() {
  const auto all = index_packet("all");
  const auto bitmap = index_packet("bitmap");
  const auto gaps = index_packet("gaps", "zstd");
  const auto head = peek(all)->header_size - kPacketChecksum;
  save("bad_signature.packet", changed(all, 0, 0xD1));
  save("bad_version.packet", changed(all, 0, 0xC2));
  save("bad_flag.packet", changed(all, 1, 0x80));
  save("bad_type.packet", changed(all, 1, 0x06));
  save("bad_backend.packet", changed(all, 2, 0x7F));
  save("bad_sequence.packet", changed(all, 4, 0));
  save("bad_description.packet", changed(all, 5, std::to_integer<int>(all[5]) ^ 1));
  save("bad_checksum.packet",
       changed(all, all.size() - 1, std::to_integer<int>(all.back()) ^ 1, false));
  save("bad_payload_head.packet", changed(all, head, 0x04));
  save("bad_difference.packet", changed(all, head, 0x03));
  auto cut = all;
  cut.resize(cut.size() - 10);
  save("bad_cut.packet", cut);
  reseal(cut);
  save("bad_payload_size.packet", cut);
  save("bad_block_count.packet", changed(bitmap, 9, std::to_integer<int>(bitmap[9]) + 1));
  save("bad_index_padding.packet", changed(gaps, 11 + peek(gaps)->index_size - 1, 0xFF));
  auto extra = gaps;
  extra.insert(extra.end() - 4, std::byte{0});
  reseal(extra);
  save("bad_trailing_byte.packet", extra);
}

void bad_native_packets() {
  const test::Texture zero(index_desc());
  auto encoder = *Encoder::create(index_desc(), {.backend = "native"});
  const auto raw = *encoder.encode(zero.view(), Selection::all());
  const auto payload = peek(raw)->header_size - kPacketChecksum;
  const Bytes records(texture_bytes(index_desc()));
  std::vector<std::uint32_t> all(kIndexBlocks);
  std::iota(all.begin(), all.end(), 0U);
  // The same with other settings, so that there is what can be wrong.
  const auto with = [&](const native::PayloadSettings& settings) {
    Packet packet(raw.begin(), raw.begin() + static_cast<std::ptrdiff_t>(payload));
    native::PayloadMemory memory;
    native::encode_payload({index_desc(), all, {records.data(), 2}, {}, true}, settings,
                           Isa::scalar, memory, packet);
    seal_packet(packet);
    return packet;
  };
  native::PayloadSettings cut, few;
  cut.box = {8, 4, 1};
  few.chunk.lanes = 8;
  const auto chunks = with(cut), modelled = with(few);
  const auto chunk = payload + 1;         // version, parts
  const auto states = chunk + 6;          // first byte, sets, coded planes, a constant
  const auto ends = payload + 1 + 8 + 4;  // box, count
  save("bad_native_version.packet", changed(modelled, payload, 1));
  save("bad_native_box.packet", changed(chunks, payload + 1, 9));
  save("bad_native_size.packet",
       changed(chunks, ends + 4, std::to_integer<int>(chunks[ends + 4]) - 1));
  save("bad_native_kind.packet", changed(modelled, chunk, 2));
  save("bad_native_lanes.packet", changed(modelled, chunk, 1 | 6 << 2));
  save("bad_native_planes.packet", changed(modelled, chunk + 3, 2));
  save("bad_native_state.packet", changed(changed(modelled, states + 2, 0), states + 3, 0));
  auto longer = modelled;
  longer.insert(longer.end() - kPacketChecksum, 2, std::byte{0});
  reseal(longer);
  save("bad_native_end.packet", longer);
}

}  // namespace

Packet changed(Packet packet, std::size_t at, int value, bool sealed) {
  packet[at] = static_cast<std::byte>(value);
  if (sealed) reseal(packet);
  return packet;
}

void save_damaged_packets() {
  bad_packets();
  bad_native_packets();
}

}  // namespace gicodec::golden
