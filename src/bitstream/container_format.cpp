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
constexpr std::size_t kMinRun = 2;    ///< bytes
constexpr std::size_t kMinPlace = 4;  ///< bytes
/// Bytes of the smallest part: type, size, counts of packets, runs and parts, directory, tail,
/// checksum.
constexpr std::size_t kMinPartEntry = 1 + 1 + 3 + 8 + kIndexTail + kEntryChecksum;

void write_runs(std::span<const PartRun> runs, ByteWriter& writer) {
  writer.varint(runs.size());
  for (const PartRun& run : runs) {
    writer.varint(run.gap);
    writer.varint(run.length);
  }
}

void read_runs(ByteReader& reader, std::vector<PartRun>& runs) {
  const auto count = reader.varint(std::min(kMaxPartRuns, reader.rest().size() / kMinRun));
  runs.reserve(static_cast<std::size_t>(count));
  for (std::uint64_t i = 0; i < count && reader.ok(); ++i) {
    const PartRun run{reader.varint(), reader.varint()};
    if (run.gap == 0 || run.length == 0) return reader.fail(Status::corrupt);
    runs.push_back(run);
  }
}

void read_packets(ByteReader& reader, std::span<const PacketRule> rules, std::uint64_t begin,
                  std::uint64_t offset, std::vector<SeekEntry>& packets) {
  const auto count = reader.varint(reader.rest().size() / kMinSeekEntry);
  packets.reserve(static_cast<std::size_t>(count));
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
        packet.texture_id >= rules.size() || !rules[packet.texture_id].has(packet.region) ||
        flags > kIndexKeyframe) {
      return reader.fail(Status::corrupt);
    }
    packets.push_back(packet);
  }
}

void read_places(ByteReader& reader, std::uint64_t offset, std::uint64_t most,
                 std::vector<PartPlace>& places) {
  const auto count = reader.varint(std::min(most, offset / kMinPartEntry));
  if (count > reader.rest().size() / kMinPlace) return reader.fail(Status::corrupt);
  places.reserve(static_cast<std::size_t>(count));
  std::uint64_t end = 0, offset_before = 0, frame_before = 0;
  for (std::uint64_t i = 0; i < count && reader.ok(); ++i) {
    PartPlace& place = places.emplace_back();
    place.offset = offset_before + reader.varint(offset - offset_before);
    place.size = reader.varint(offset - place.offset);
    place.frame = frame_before + reader.varint(kMaxOffset - frame_before);
    read_runs(reader, place.needs);
    if (place.offset < end || place.size < kMinPartEntry) return reader.fail(Status::corrupt);
    end = place.end();
    offset_before = place.offset;
    frame_before = place.frame;
  }
}

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

void write_index_part(const IndexPart& part, std::uint64_t offset, std::vector<std::byte>& out) {
  ByteWriter writer(out);
  writer.varint(part.packets.size());
  SeekEntry last;
  for (const SeekEntry& packet : part.packets) {
    writer.varint(packet.frame - last.frame);
    writer.varint(packet.offset - last.offset);
    writer.fixed(packet.texture_id);
    writer.varint(to_region_field(packet.region));
    writer.fixed(packet.keyframe ? kIndexKeyframe : std::uint8_t{0});
    last = packet;
  }
  write_runs(part.needs, writer);
  writer.fixed(part.directory);
  writer.varint(part.parts.size());
  std::uint64_t offset_before = 0, frame_before = 0;
  for (const PartPlace& place : part.parts) {
    writer.varint(place.offset - offset_before);
    writer.varint(place.size);
    writer.varint(place.frame - frame_before);
    write_runs(place.needs, writer);
    offset_before = place.offset;
    frame_before = place.frame;
  }
  writer.fixed(offset);
  writer.bytes(std::as_bytes(std::span(kIndexMark)));
}

bool is_index_tail(std::span<const std::byte> tail, std::uint64_t offset) noexcept {
  ByteReader reader(tail);
  const auto said = reader.fixed<std::uint64_t>();
  const auto mark = std::as_bytes(std::span(kIndexMark));
  return reader.ok() && said == offset &&
         std::equal(reader.rest().begin(), reader.rest().end(), mark.begin(), mark.end());
}

Result<IndexPart> read_index_part(std::span<const std::byte> body,
                                  std::span<const PacketRule> rules, std::uint64_t begin,
                                  std::uint64_t offset, std::uint64_t most_parts) {
  if (body.size() < kIndexTail || !is_index_tail(body.last(kIndexTail), offset)) {
    return Status::corrupt;
  }
  ByteReader reader(body.first(body.size() - kIndexTail));
  IndexPart part;
  read_packets(reader, rules, begin, offset, part.packets);
  read_runs(reader, part.needs);
  part.directory = reader.fixed<std::uint64_t>();
  read_places(reader, offset, most_parts, part.parts);
  const bool directory =
      part.directory == 0 || (!part.parts.empty() && part.parts.front().offset == part.directory);
  if (!reader.ok() || !reader.rest().empty() || !directory) return Status::corrupt;
  return part;
}

}  // namespace gicodec
