// A decoder session fed several packets. Checksums and description hashes are put right, so that
// mutations reach the sections behind them.
#include "bitstream/packet.h"
#include "input.h"

namespace {

void put_right(std::span<std::byte> packet, const gicodec::TextureDesc& desc) {
  using namespace gicodec;
  if (packet.size() > 1 && (packet[1] & std::byte{1}) != std::byte{0}) {
    std::size_t at = 4;  // Behind the sequence number.
    while (at < packet.size() && packet[at] >= std::byte{0x80}) ++at;
    const auto hash = description_hash(desc);
    if (at + 1 + sizeof hash <= packet.size()) std::memcpy(&packet[at + 1], &hash, sizeof hash);
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
  for (int i = 0; i < 8 && !input.empty(); ++i) {
    const auto length = input.u16();
    fuzz::Exact packet(input.bytes(length & 0x7FFF));
    if ((length & 0x8000) == 0) put_right(packet.span(), desc);
    const auto before = fuzz::contents(*decoder);
    const auto sequence = decoder->sequence();
    const Status status = decoder->decode(packet.span(), TextureView{texture.span()});
    const auto after = fuzz::contents(*decoder);
    if (status == Status::ok) {
      fuzz::check(std::ranges::equal(texture.span(), after), "the view follows the mirror");
      fuzz::check(decoder->sequence() == peek(packet.span())->sequence, "the sequence follows");
    } else {
      fuzz::check(before == after, "an error leaves the mirror as it was");
      fuzz::check(decoder->sequence() == sequence, "an error leaves the sequence as it was");
    }
  }
  return 0;
}
