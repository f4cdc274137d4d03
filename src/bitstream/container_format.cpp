// Entries and index parts of containers.
#include "bitstream/container_format.h"

#include "base/bytes.h"
#include "base/checksum.h"
#include "bitstream/region_field.h"

#include <algorithm>

namespace gicodec {
namespace {

constexpr std::uint8_t kIndexKeyframe = 0x01;
constexpr auto kMaxOffset = std::numeric_limits<std::uint64_t>::max();

}  // namespace

Result<ContainerVersion> container_version(std::span<const std::byte> head) noexcept {
  const auto magic = std::as_bytes(std::span(kMagic));
  const std::size_t size = std::min(head.size(), magic.size());
  // Another format's file may be shorter than this header.
  if (!std::equal(magic.begin(), magic.begin() + static_cast<std::ptrdiff_t>(size), head.begin())) {
    return Status::not_gicodec;
  }
  if (head.size() < ContainerVersion::kBytes) return Status::truncated;
  return ContainerVersion{std::to_integer<std::uint8_t>(head[magic.size()]),
                          std::to_integer<std::uint8_t>(head[magic.size() + 1])};
}

void append_entry(EntryType type, std::span<const std::byte> head, std::span<const std::byte> body,
                  std::vector<std::byte>& out) {
  const std::size_t start = out.size();
  out.reserve(start + 1 + kMaxVarint + head.size() + body.size() + kEntryChecksum);
  ByteWriter writer(out);
  writer.fixed(static_cast<std::uint8_t>(type));
  writer.varint(head.size() + body.size());
  writer.bytes(head);
  writer.bytes(body);
  writer.fixed(checksum(std::span(out).subspan(start)));
}

std::vector<PacketRule> packet_rules(const ContainerDescription& description) {
  std::vector<PacketRule> rules;
  rules.reserve(description.textures.size());
  for (const TextureEntry& texture : description.textures) {
    PacketRule rule;
    rule.lossless = texture.largest_error == 0;
    const Grid& region = description.volumes[texture.volume].region;
    if (region.x != 0) {
      rule.regions = is_known(texture) ? regions_of(texture.desc, region).regions() : kMaxBlocks;
    }
    rules.push_back(rule);
  }
  return rules;
}

void write_index_part(std::span<const SeekEntry> packets, std::uint64_t before,
                      std::uint64_t offset, std::vector<std::byte>& out) {
  ByteWriter writer(out);
  writer.fixed(before);
  writer.varint(packets.size());
  SeekEntry last;
  for (const SeekEntry& packet : packets) {
    writer.varint(packet.frame - last.frame);
    writer.varint(packet.offset - last.offset);
    writer.fixed(packet.texture_id);
    writer.varint(to_region_field(packet.region));
    writer.fixed(packet.keyframe ? kIndexKeyframe : std::uint8_t{0});
    last = packet;
  }
  writer.fixed(offset);
  writer.bytes(std::as_bytes(std::span(kIndexMark)));
}

Result<IndexPartHead> read_index_part_head(std::span<const std::byte> body) {
  ByteReader reader(body);
  IndexPartHead head;
  head.before = reader.fixed<std::uint64_t>();
  head.packets = reader.varint();
  if (!reader.ok()) return Status::corrupt;
  return head;
}

bool is_index_tail(std::span<const std::byte> tail, std::uint64_t offset) noexcept {
  ByteReader reader(tail);
  const auto said = reader.fixed<std::uint64_t>();
  const auto mark = std::as_bytes(std::span(kIndexMark));
  return reader.ok() && said == offset &&
         std::equal(reader.rest().begin(), reader.rest().end(), mark.begin(), mark.end());
}

Status read_index_part(std::span<const std::byte> body, std::span<const PacketRule> rules,
                       std::uint64_t begin, std::uint64_t offset, std::vector<SeekEntry>& index) {
  if (body.size() < kIndexTail || !is_index_tail(body.last(kIndexTail), offset)) {
    return Status::corrupt;
  }
  ByteReader reader(body.first(body.size() - kIndexTail));
  (void)reader.fixed<std::uint64_t>();
  const auto count = reader.varint(body.size() / kMinSeekEntry);
  const std::uint64_t first_frame = index.empty() ? 0 : index.back().frame;
  SeekEntry packet;
  for (std::uint64_t i = 0; i < count && reader.ok(); ++i) {
    packet.frame += reader.varint(kMaxOffset - packet.frame);
    const std::uint64_t distance = reader.varint(offset - packet.offset);
    packet.offset += distance;
    packet.texture_id = reader.fixed<std::uint8_t>();
    packet.region = from_region_field(reader.varint(kMaxRegionField));
    const auto flags = reader.fixed<std::uint8_t>();
    packet.keyframe = flags == kIndexKeyframe;
    if (distance == 0 || packet.offset < begin || packet.offset >= offset ||
        packet.frame < first_frame || packet.texture_id >= rules.size() ||
        !rules[packet.texture_id].has(packet.region) || flags > kIndexKeyframe) {
      return Status::corrupt;
    }
    index.push_back(packet);
  }
  return reader.ok() && reader.rest().empty() ? Status::ok : Status::corrupt;
}

}  // namespace gicodec
