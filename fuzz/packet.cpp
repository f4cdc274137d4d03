// A decoder session fed several packets. Numbers, bases and checksums are put right, so that
// mutations reach the sections behind them; what follows a snapshot builds on the packet that the
// snapshot stands for.
#include "packets.h"

namespace {

constexpr unsigned kAsItStands = 1, kOnlyChecksum = 2;
constexpr std::size_t kHead = 6;

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gicodec;
  fuzz::Input input(data, size);
  const auto desc = input.any_desc();
  const auto presence = input.presence(desc);
  auto made = Decoder::create(desc);
  fuzz::check(made.ok(), "a valid description makes a decoder");
  fuzz::WatchedDecoder decoder(*std::move(made), {}, presence);
  for (int i = 0; i < 8 && !input.empty(); ++i) {
    const auto part = input.part();
    fuzz::Bytes bytes(part.bytes.begin(), part.bytes.end());
    if (part.flags == kOnlyChecksum) {
      fuzz::reseal(bytes);
    } else if (part.flags != kAsItStands) {
      fuzz::put_right(bytes, desc, fuzz::state_of(decoder.decoder()));
    }
    static_cast<void>(decoder.decode(fuzz::Exact(bytes).span()));
  }
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  return gicodec::fuzz::mutate_parts(data, size, max_size, seed, kHead,
                                     gicodec::fuzz::mutate_part_packet);
}
