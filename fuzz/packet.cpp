// A decoder session fed several packets. Numbers, bases and checksums are put right, so that
// mutations reach the sections behind them; what follows a snapshot builds on the packet that the
// snapshot stands for.
#include "mutate.h"

#include "bitstream/packet.h"

namespace {

using namespace gicodec;

constexpr unsigned kAsItStands = 1, kOnlyChecksum = 2;
constexpr std::size_t kHead = 6;

/// The same packet as the next one of a decoder; any bytes that are no packet only get a checksum.
void put_right(std::vector<std::byte>& packet, const Decoder& decoder) {
  const auto parts = parse_packet(packet);
  if (!parts) return fuzz::reseal(packet);
  PacketHead head{parts->info, parts->index_mode, parts->base, parts->stands_for};
  head.base = head.info.keyframe ? description_hash(decoder.desc()) : decoder.checksum();
  if (!head.info.keyframe) {
    head.info.reference = decoder.sequence();
    head.info.sequence = decoder.sequence() + 1;
    if (head.info.reference == 0) return;  // Nothing to build on.
  }
  std::vector<std::byte> out;
  write_packet_head(head, parts->index, parts->borders, out);
  out.insert(out.end(), parts->payload.begin(), parts->payload.end());
  seal_packet(out);
  packet = out;
}

/// Changes one section and puts the sizes in the head right; false if it is no packet.
bool mutate_section(fuzz::Bytes& packet, std::size_t room, fuzz::Random& random) {
  const auto parts = parse_packet(packet);
  if (!parts) return false;
  const auto copy = [](auto from) { return fuzz::Bytes(from.begin(), from.end()); };
  fuzz::Bytes sections[] = {copy(parts->index), copy(parts->borders), copy(parts->payload)};
  auto& section = sections[fuzz::pick(random, 3)];
  fuzz::mutate(section, section.size() + room);
  fuzz::Bytes out;
  write_packet_head({parts->info, parts->index_mode, parts->base, parts->stands_for}, sections[0],
                    sections[1], out);
  out.insert(out.end(), sections[2].begin(), sections[2].end());
  seal_packet(out);
  packet = out;
  return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const auto desc = input.desc();
  auto decoder = Decoder::create(desc);
  fuzz::check(decoder.ok(), "a valid description makes a decoder");
  fuzz::Exact texture(static_cast<std::size_t>(texture_bytes(desc)));
  auto before = fuzz::contents(*decoder);
  for (int i = 0; i < 8 && !input.empty(); ++i) {
    const auto part = input.part();
    std::vector<std::byte> bytes(part.bytes.begin(), part.bytes.end());
    if (part.flags == kOnlyChecksum) fuzz::reseal(bytes);
    if (part.flags != kOnlyChecksum && part.flags != kAsItStands) put_right(bytes, *decoder);
    fuzz::Exact packet(bytes);
    const auto sequence = decoder->sequence();
    const auto checksum = decoder->checksum();
    const Status status = decoder->decode(packet.span(), TextureView{texture.span()});
    const auto after = fuzz::contents(*decoder);
    if (status == Status::ok) {
      const auto parts = parse_packet(packet.span());
      fuzz::check(parts.ok() && decoder->sequence() == parts->info.sequence,
                  "the sequence follows");
      fuzz::check(decoder->checksum() == (parts->info.snapshot || parts->info.skip
                                              ? parts->stands_for
                                              : packet_checksum(packet.span())),
                  "the checksum is that of the packet, or of the one it stands for");
      fuzz::check(fuzz::same(texture.span(), after), "the view follows the mirror");
    } else {
      fuzz::check(before == after, "an error leaves the mirror as it was");
      fuzz::check(decoder->sequence() == sequence && decoder->checksum() == checksum,
                  "an error leaves the sequence as it was");
    }
    before = after;
  }
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  const auto change = [](std::span<const std::byte>, fuzz::Bytes& bytes, std::size_t room,
                         fuzz::Random& random) {
    if (fuzz::once_in(random, 4) || !mutate_section(bytes, room, random)) {
      fuzz::mutate(bytes, bytes.size() + room);
    }
  };
  return fuzz::mutate_parts(data, size, max_size, seed, kHead, change);
}
