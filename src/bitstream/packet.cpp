#include "bitstream/packet.h"

#include <gicodec/backend.h>
#include <gicodec/version.h>

#include "base/bytes.h"
#include "base/checksum.h"

#include <limits>

namespace gicodec {
namespace {

constexpr std::uint8_t kSignature = 0xC0;
constexpr std::uint8_t kSignatureMask = 0xF0;

constexpr std::uint8_t kTypeMask = 0x07;
constexpr std::uint8_t kFlagLossy = 0x08;
constexpr std::uint8_t kFlagGuardBand = 0x10;
constexpr unsigned kIndexModeShift = 5;
constexpr std::uint8_t kReservedFlags = 0x80;

constexpr std::uint32_t kMaxSequence = std::numeric_limits<std::uint32_t>::max();

}  // namespace

PacketHead PacketChain::next(std::uint32_t description, PacketType type) const {
  PacketHead head;
  head.info.type = type;
  head.info.backend = backend;
  head.info.texture_id = texture_id;
  head.info.sequence = sequence + 1;
  head.info.reference = is_keyframe(type) ? 0 : sequence;
  head.base = is_keyframe(type) ? description : checksum;
  return head;
}

PacketHead PacketChain::stand_in(std::uint32_t description, PacketType type,
                                 const PacketChain& later) const {
  PacketHead head = next(description, type);
  head.info.type = type == PacketType::keyframe ? PacketType::snapshot
                   : type == PacketType::intra  ? PacketType::intra_catch_up
                                                : PacketType::catch_up;
  head.info.sequence = later.sequence;
  head.stands_for = later.checksum;
  return head;
}

void write_packet_head(const PacketHead& head, std::span<const std::byte> index,
                       std::span<const std::byte> guard_bands, std::vector<std::byte>& out) {
  const auto& info = head.info;
  auto flags = static_cast<std::uint8_t>(static_cast<unsigned>(head.index_mode) << kIndexModeShift |
                                         static_cast<unsigned>(info.type));
  if (info.lossy) flags |= kFlagLossy;
  if (!guard_bands.empty()) flags |= kFlagGuardBand;

  ByteWriter writer(out);
  writer.fixed(static_cast<std::uint8_t>(kSignature | kPacketVersion));
  writer.fixed(flags);
  writer.fixed(info.backend);
  writer.fixed(info.texture_id);
  writer.varint(info.sequence);
  if (!is_keyframe(info.type)) writer.varint(info.sequence - info.reference);
  writer.fixed(head.base);
  if (is_stand_in(info.type)) writer.fixed(head.stands_for);
  if (head.index_mode != IndexMode::all) {
    writer.varint(info.blocks);
    writer.varint(index.size());
  }
  if (!guard_bands.empty()) writer.varint(guard_bands.size());
  writer.bytes(index);
  writer.bytes(guard_bands);
}

std::uint32_t seal_packet(std::vector<std::byte>& packet) {
  const auto sum = checksum(packet);
  ByteWriter(packet).fixed(sum);
  return sum;
}

std::uint32_t packet_checksum(std::span<const std::byte> packet) noexcept {
  return ByteReader(packet.last(kPacketChecksum)).fixed<std::uint32_t>();
}

std::uint32_t checksum_after(const PacketParts& parts, std::span<const std::byte> packet) noexcept {
  return is_stand_in(parts.info.type) ? parts.stands_for : packet_checksum(packet);
}

Result<PacketParts> parse_packet(std::span<const std::byte> packet) noexcept {
  if (packet.empty()) return Status::truncated;
  const auto first = std::to_integer<std::uint8_t>(packet[0]);
  if ((first & kSignatureMask) != kSignature) return Status::not_gicodec;
  if ((first & ~kSignatureMask) != kPacketVersion) return Status::unsupported_version;
  if (packet.size() < kPacketChecksum) return Status::truncated;

  PacketParts parts;
  auto& info = parts.info;
  ByteReader reader(packet.first(packet.size() - kPacketChecksum));
  info.version = static_cast<std::uint8_t>(reader.fixed<std::uint8_t>() & ~kSignatureMask);
  const auto flags = reader.fixed<std::uint8_t>();
  const auto type = static_cast<std::uint8_t>(flags & kTypeMask);
  if ((flags & kReservedFlags) != 0 || type >= kPacketTypes) return Status::unsupported_feature;
  info.type = static_cast<PacketType>(type);
  info.lossy = (flags & kFlagLossy) != 0;
  parts.index_mode = static_cast<IndexMode>(flags >> kIndexModeShift & 3);
  info.backend = reader.fixed<std::uint8_t>();
  // hevc payloads depend on more of the past than the mirror.
  const bool by_mirror = is_intra(info.type) || is_stand_in(info.type);
  if (by_mirror && info.backend == kBackendHevc) return Status::corrupt;
  info.texture_id = reader.fixed<std::uint8_t>();
  info.sequence = static_cast<std::uint32_t>(reader.varint(kMaxSequence));
  if (!is_keyframe(info.type)) {
    const auto distance = static_cast<std::uint32_t>(reader.varint(kMaxSequence));
    if (reader.ok() && (distance == 0 || distance >= info.sequence)) return Status::corrupt;
    info.reference = info.sequence - distance;
  }
  parts.base = reader.fixed<std::uint32_t>();
  if (is_stand_in(info.type)) parts.stands_for = reader.fixed<std::uint32_t>();
  std::size_t index_size = 0;
  std::size_t guard_band_size = 0;
  info.all_blocks = parts.index_mode == IndexMode::all;
  if (!info.all_blocks) {
    info.blocks = static_cast<std::uint32_t>(reader.varint(kMaxBlocks));
    index_size = static_cast<std::size_t>(reader.varint(index_buffer_bound(kMaxBlocks)));
  }
  if ((flags & kFlagGuardBand) != 0) {
    guard_band_size = static_cast<std::size_t>(reader.varint(packet.size()));
    if (reader.ok() && guard_band_size == 0) return Status::corrupt;
  }
  if (!reader.ok()) return reader.status();
  if (info.sequence == 0) return Status::corrupt;
  info.header_size = packet.size() - reader.rest().size();
  parts.index = reader.bytes(index_size);
  parts.guard_bands = reader.bytes(guard_band_size);
  if (!reader.ok()) return reader.status();
  parts.payload = reader.rest();
  info.index_size = index_size;
  info.guard_band_size = guard_band_size;
  info.payload_size = parts.payload.size();
  return parts;
}

Result<PacketInfo> peek(std::span<const std::byte> packet) noexcept {
  const auto parts = parse_packet(packet);
  if (!parts) return parts.status();
  return parts->info;
}

Status verify_checksum(std::span<const std::byte> packet) noexcept {
  if (packet.size() < kPacketChecksum) return Status::truncated;
  const auto body = packet.first(packet.size() - kPacketChecksum);
  return packet_checksum(packet) == checksum(body) ? Status::ok : Status::checksum_mismatch;
}

}  // namespace gicodec
