// Packets for a decoder: put right so that mutations get past references and checksums, changed
// section by section, and decoded under watch.
#pragma once

#include "cost.h"
#include "mutate.h"

#include "bitstream/description.h"
#include "bitstream/index_buffer.h"
#include "bitstream/packet.h"
#include "stream/guard_band_section.h"

namespace gicodec::fuzz {

/// What stands in front of the parts of a packet.
inline PacketHead head_of(const PacketParts& parts) {
  return {.info = parts.info,
          .index_mode = parts.index_mode,
          .base = parts.base,
          .stands_for = parts.stands_for};
}

/// The packet of these parts under another head.
inline Bytes with_head(const PacketParts& parts, const PacketHead& head) {
  Bytes out;
  write_packet_head(head, parts.index, parts.guard_bands, out);
  out.insert(out.end(), parts.payload.begin(), parts.payload.end());
  seal_packet(out);
  return out;
}

/// What the next update of a stream builds on.
struct StreamState {
  std::uint32_t sequence = 0, checksum = 0;
};
inline StreamState state_of(const Decoder& decoder) {
  return {decoder.sequence(), decoder.checksum()};
}

enum class As : std::uint8_t { it_is, intra };

/// The same packet as the next one of a stream; any bytes that are no packet only get a checksum.
inline void put_right(Bytes& packet, const TextureDesc& desc, const StreamState& state,
                      As as = As::it_is) {
  const auto parts = parse_packet(packet);
  if (!parts) return reseal(packet);
  PacketHead head = head_of(*parts);
  if (as == As::intra && head.info.backend != kBackendHevc) {
    const bool stand_in = is_stand_in(head.info.type) && !is_keyframe(head.info.type);
    head.info.type = stand_in ? PacketType::intra_catch_up : PacketType::intra;
  }
  head.base = is_keyframe(head.info.type) ? description_hash(desc) : state.checksum;
  if (!is_keyframe(head.info.type)) {
    if (state.sequence == 0) return;  // Nothing to build on.
    head.info.reference = state.sequence;
    head.info.sequence = state.sequence + 1;
  }
  packet = with_head(*parts, head);
}

/// Changes one section and puts the sizes in the head right, or the bytes if it is no packet.
inline void mutate_packet(Bytes& packet, std::size_t room, Random& random) {
  const auto parts = parse_packet(packet);
  if (!parts || once_in(random, 4)) return mutate(packet, packet.size() + room);
  const auto copy = [](auto from) { return Bytes(from.begin(), from.end()); };
  Bytes sections[] = {copy(parts->index), copy(parts->guard_bands), copy(parts->payload)};
  auto& section = sections[pick(random, 3)];
  mutate(section, section.size() + room);
  PacketParts changed = *parts;
  changed.index = sections[0];
  changed.guard_bands = sections[1];
  changed.payload = sections[2];
  packet = with_head(changed, head_of(*parts));
}
inline void mutate_part_packet(std::span<const std::byte>, Bytes& bytes, std::size_t room,
                               Random& random) {
  mutate_packet(bytes, room, random);
}

/// Bytes of blocks that a packet gives a decoder to work on (docs/guarantees.md, "Work"): none if
/// its head, index, sizes or tables refuse it.
inline std::uint64_t work_of(const Decoder& decoder, std::span<const std::byte> packet) {
  const auto& desc = decoder.desc();
  const auto parts = parse_packet(packet);
  if (!parts || verify_checksum(packet) != Status::ok) return 0;
  const auto& info = parts->info;
  const bool here = info.reference == decoder.sequence() && parts->base == decoder.checksum();
  if (is_keyframe(info.type) ? parts->base != description_hash(desc) : !here) return 0;
  const auto count = info.all_blocks ? block_count(desc) : info.blocks;
  bool good =
      check_index_buffer(parts->index_mode, count, block_count(desc), parts->index) == Status::ok &&
      (parts->guard_bands.empty() ||
       check_guard_band_section(desc, count, parts->guard_bands) == Status::ok);
  for (const Backend* backend : built_in_backends()) {
    if (backend->id() != info.backend) continue;
    const auto made = backend->make_decoder(desc);
    good = good && made.ok() && (*made)->check(desc, count, parts->payload) == Status::ok;
  }
  return good ? packet_work(desc, info) : 0;
}

/// A decoder that applies packets completely or not at all and takes no more than it may, and a
/// view that follows it.
class WatchedDecoder {
 public:
  /// `coder`: what a decoder of another library may take besides.
  /// `presence`: of every block, if the description needs it; must outlive this.
  explicit WatchedDecoder(Decoder decoder, Allowance coder = {},
                          std::span<const std::byte> presence = {})
      : decoder_(std::move(decoder)),
        coder_(coder),
        presence_(presence),
        texture_(static_cast<std::size_t>(texture_bytes(decoder_.desc()))),
        before_(contents(decoder_)) {
    if (decoder_.sequence() != 0) std::ranges::copy(before_, texture_.span().begin());
    check(decoder_.set_presence(presence) == Status::ok, "presence of the right size");
  }

  Status decode(std::span<const std::byte> packet) {
    const StreamState state = state_of(decoder_);
    const auto hash = decoder_.state_hash();
    const std::uint64_t work = work_of(decoder_, packet);
    Allowance allowed =
        work == 0 ? refusal(packet.size()) : decoding(decoder_.desc(), packet.size());
    allowed.memory += coder_.memory;
    allowed.work += coder_.work;
    Status status = Status::ok;
    check_cost("a packet costs what it is worth", [&] {
      status = decoder_.decode(packet, TextureView{texture_.span()});
      return allowed;
    });
    const auto after = contents(decoder_);
    if (status == Status::ok) {
      applied(packet, work, after);
    } else {
      check(before_ == after && hash == decoder_.state_hash(),
            "an error leaves the mirror as it was");
      check(decoder_.sequence() == state.sequence && decoder_.checksum() == state.checksum,
            "an error leaves the sequence as it was");
    }
    before_ = after;
    return status;
  }
  [[nodiscard]] const Decoder& decoder() const { return decoder_; }
  [[nodiscard]] const Bytes& records() const { return before_; }

 private:
  void applied(std::span<const std::byte> packet, std::uint64_t work, const Bytes& after) {
    const auto parts = parse_packet(packet);
    check(parts.ok() && decoder_.sequence() == parts->info.sequence, "the sequence follows");
    check(decoder_.checksum() == checksum_after(*parts, packet),
          "the checksum is that of the packet, or of the one it stands for");
    check(follows(after), "the view follows the mirror");
    std::uint64_t touched = 0;
    for (std::size_t i = 0; i < after.size(); ++i) touched += after[i] != before_[i] ? 1 : 0;
    check(touched <= work, "no records are touched but those of the blocks that count as work");
    if (is_keyframe(parts->info.type)) check_limit(packet, work);
  }
  /// Whether the view holds that; what belongs to no record is zero there, and soiled here.
  bool follows(const Bytes& after) {
    Bytes untouched(after.size());
    soil(untouched, 0);
    const auto view = texture_.span();
    for (std::size_t i = 0; i < after.size(); ++i) {
      if (view[i] != after[i] && (after[i] != std::byte{0} || view[i] != untouched[i]))
        return false;
    }
    return true;
  }
  /// A decoder that allows one byte less refuses it before it costs anything.
  void check_limit(std::span<const std::byte> packet, std::uint64_t work) const {
    DecoderOptions strict;
    strict.limits.max_work_bytes = work - 1;
    auto decoder = Decoder::create(decoder_.desc(), strict);
    check(decoder.ok() && decoder->set_presence(presence_) == Status::ok, "a decoder is made");
    check_cost("work beyond the limit costs nothing", [&]() -> Allowance {
      check(decoder->decode(packet) == Status::limit_exceeded, "work is limited");
      return {1024, 1024};
    });
  }

  Decoder decoder_;
  Allowance coder_;
  std::span<const std::byte> presence_;
  Exact texture_;
  Bytes before_;
};

}  // namespace gicodec::fuzz
