// peek() and verify_checksum() on any bytes; a head that was read is written as the same bytes.
#include "bitstream/packet.h"
#include "input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gicodec;
  const std::span packet(reinterpret_cast<const std::byte*>(data), size);
  (void)verify_checksum(packet);
  const auto info = peek(packet);
  if (!info) return 0;
  fuzz::check(
      info->header_size + info->index_size + info->guard_band_size + info->payload_size == size,
      "the sizes of a packet's parts add up to its size");
  fuzz::check(info->sequence > info->reference, "a packet builds on an earlier one");
  fuzz::check(is_keyframe(info->type) == (info->reference == 0),
              "only keyframes need no reference");

  const auto parts = parse_packet(packet);
  fuzz::check(parts.ok(), "what peek() accepts can be taken apart");
  std::vector<std::byte> again;
  write_packet_head({parts->info, parts->index_mode, parts->base, parts->stands_for}, parts->index,
                    parts->guard_bands, again);
  again.insert(again.end(), parts->payload.begin(), parts->payload.end());
  fuzz::check(fuzz::same(again, packet.first(size - kPacketChecksum)),
              "writing is the inverse of reading");
  return 0;
}
