// A decoder session fed several packets. Checksums and bases are put right, so that mutations reach
// the sections behind them.
#include "bitstream/packet.h"
#include "input.h"

namespace {

/// `last` is the checksum of the last packet that was applied.
void put_right(std::span<std::byte> packet, const gicodec::TextureDesc& desc, std::uint32_t last) {
  using namespace gicodec;
  std::size_t at = 4;
  const auto skip_varint = [&] {
    while (at < packet.size() && packet[at] >= std::byte{0x80}) ++at;
    ++at;
  };
  if (packet.size() > 1) {
    const bool keyframe = (packet[1] & std::byte{1}) != std::byte{0};
    skip_varint();                 // Sequence number,
    if (!keyframe) skip_varint();  // distance.
    const auto base = keyframe ? description_hash(desc) : last;
    if (at + sizeof base <= packet.size()) std::memcpy(&packet[at], &base, sizeof base);
  }
  fuzz::reseal(packet);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gicodec;
  fuzz::Input input(data, size);
  const auto desc = input.desc();
  auto decoder = Decoder::create(desc);
  fuzz::check(decoder.ok(), "a valid description makes a decoder");
  fuzz::Exact texture(texture_bytes(desc));
  std::uint32_t last = 0;
  for (int i = 0; i < 8 && !input.empty(); ++i) {
    const auto length = input.u16();
    fuzz::Exact packet(input.bytes(length & 0x7FFF));
    if ((length & 0x8000) == 0) put_right(packet.span(), desc, last);
    const auto before = fuzz::contents(*decoder);
    const auto sequence = decoder->sequence();
    const Status status = decoder->decode(packet.span(), TextureView{texture.span()});
    const auto after = fuzz::contents(*decoder);
    if (status == Status::ok) {
      last = packet_checksum(packet.span());
      fuzz::check(std::ranges::equal(texture.span(), after), "the view follows the mirror");
      fuzz::check(decoder->sequence() == peek(packet.span())->sequence, "the sequence follows");
    } else {
      fuzz::check(before == after, "an error leaves the mirror as it was");
      fuzz::check(decoder->sequence() == sequence, "an error leaves the sequence as it was");
    }
  }
  return 0;
}
