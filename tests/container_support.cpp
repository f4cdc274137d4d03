#include "container_support.h"

#include "base/bytes.h"
#include "base/checksum.h"
#include "bitstream/description.h"
#include "bitstream/region_field.h"

namespace gicodec::test {

Bytes PacketMaker::make(std::uint8_t texture_id, std::uint32_t region, bool keyframe,
                        Random& random, std::size_t payload, bool lossy) {
  const TextureEntry& texture = description_->textures[texture_id];
  const Grid& size = description_->volumes[texture.volume].region;
  const TextureDesc desc =
      region == StreamId::kWholeVolume ? texture.desc : region_texture(texture.desc, size, region);
  PacketChain& chain = chains_[region_key(texture_id, region)];
  chain.texture_id = texture_id;
  PacketHead head =
      chain.next(description_hash(desc), keyframe ? PacketType::keyframe : PacketType::delta);
  head.info.lossy = lossy;
  Bytes packet;
  write_packet_head(head, {}, {}, packet);
  const Bytes bytes = noise(random, payload);
  packet.insert(packet.end(), bytes.begin(), bytes.end());
  seal_packet(packet);
  chain.sequence = head.info.sequence;
  chain.checksum = packet_checksum(packet);
  return packet;
}

States PacketMaker::states() const {
  States states;
  for (const auto& [key, chain] : chains_) states[key] = chain.checksum;
  return states;
}

ContainerDescription probe_description(std::span<const ProbeTexture> textures, Metadata metadata) {
  ContainerDescription description;
  for (std::size_t next = 0; next < textures.size();) {
    const Grid grid = textures[next].desc.grid;
    std::vector<NamedTexture> named;
    for (; next < textures.size() && textures[next].desc.grid == grid &&
           named.size() < kMaxVolumeTextures;
         ++next) {
      named.push_back({textures[next].name, textures[next].desc, {}, {}});
    }
    const auto volume = probe_volume(named);
    const std::string name = "volume " + std::to_string(description.volumes.size());
    if (!volume || add_volume(description, name, *volume) != Status::ok) return {};
  }
  for (std::size_t i = 0; i < textures.size(); ++i) {
    description.textures[i].metadata = textures[i].metadata;
    description.textures[i].largest_error = textures[i].largest_error;
  }
  description.metadata = std::move(metadata);
  return description;
}

ContainerDescription sample_description() {
  ContainerDescription description;
  const Grid grid{2, 1, 2}, wide{3, 1, 4};
  const std::vector<NamedTexture> two{
      {"color", probe_texture(Format::A2B10G10R10_UNORM_PACK32, grid, 2), {}, {}},
      {"visibility",
       probe_texture(Format::R16G16_SFLOAT, grid, 3, 1, Tiling::slices_xz_y),
       {},
       {}}};
  const std::vector<NamedTexture> one{
      {"color", probe_texture(Format::R16_SFLOAT, wide, 1, 0), {}, {}}};
  if (add_volume(description, "near", *probe_volume(two)) != Status::ok ||
      add_volume(description, "far", *probe_volume(one)) != Status::ok) {
    return {};
  }
  description.textures[0].metadata = {{"role", "irradiance"}};
  description.volumes[1].region = {2, 1, 2};
  description.metadata = {{"writer", "test"}, {"", ""}, {"writer", "again"}};
  return description;
}

Sample make_sample(std::uint64_t seed, std::uint32_t frames, std::uint32_t gop, std::uint32_t flush,
                   std::span<const Metadata> metadata) {
  Random random(seed);
  Sample sample;
  sample.description = sample_description();
  MemorySink sink;
  auto writer = *ContainerWriter::create(sink, sample.description);
  for (std::size_t i = 0; i < metadata.size(); ++i) {
    if (writer.add_metadata(static_cast<std::uint8_t>(i), metadata[i]) != Status::ok) return {};
  }
  PacketMaker maker(sample.description);
  std::map<std::uint64_t, std::uint32_t> made;
  const TextureRegion regions[] = {{0}, {1}, {2, 0}, {2, 1}, {2, 2}, {2, 3}};
  std::uint64_t frame = 0;
  for (std::uint32_t step = 0; step < frames; ++step) {
    frame += step == 0 ? 0 : pick(random, 1, 3);
    for (const auto& [id, region] : regions) {
      // Not every texture and region has a packet in every frame; one begins late.
      if (id == 1 && step % 3 == 1) continue;
      if (id == 2 && step % 4 == (region + 1) % 4) continue;
      if (region == 3 && step < 2) continue;
      const bool keyframe = made[region_key(id, region)]++ % gop == 0;
      const Bytes packet = maker.make(id, region, keyframe, random, pick(random, 0, 60));
      if (writer.add(frame, packet, region) != Status::ok) return {};
      sample.packets.push_back({frame, region, id, keyframe, packet});
      sample.ends.push_back(writer.bytes_written());
    }
    sample.frames[frame] = maker.states();
    if (flush == 0 || step % flush != flush - 1 || step + 1 == frames) continue;
    sample.parts.push_back(writer.bytes_written());
    if (writer.flush() != Status::ok) return {};
  }
  sample.parts.push_back(writer.bytes_written());
  if (writer.finish() != Status::ok || writer.bytes_written() != sink.bytes.size()) return {};
  sample.bytes = std::move(sink.bytes);
  sample.end_offset = sample.bytes.size() - kEndEntry;
  return sample;
}

Bytes entry(std::uint8_t type, std::span<const std::byte> body) {
  Bytes out;
  ByteWriter writer(out);
  writer.fixed(type);
  writer.varint(body.size());
  writer.bytes(body);
  writer.fixed(checksum(out));
  return out;
}

Bytes packet_entry(const ContainerPacket& packet) {
  Bytes body;
  ByteWriter writer(body);
  writer.varint(packet.frame);
  writer.varint(to_region_field(packet.region));
  writer.bytes(packet.bytes);
  return entry(2, body);
}

Bytes end_entry(std::uint64_t part) {
  Bytes body;
  ByteWriter(body).fixed(part);
  return entry(4, body);
}

Bytes head_of(const ContainerDescription& description) {
  MemorySink sink;
  (void)ContainerWriter::create(sink, description);
  return sink.bytes;
}

Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

std::span<const std::byte> packet_of(const Sample& sample, std::size_t packet) {
  const std::size_t size = packet_entry(sample.packets[packet]).size();
  const auto end = static_cast<std::size_t>(sample.ends[packet]);
  return std::span(sample.bytes).subspan(end - size, size);
}

std::vector<SeekEntry> index_of(const Sample& sample) {
  std::vector<SeekEntry> index;
  for (std::size_t i = 0; i < sample.packets.size(); ++i) {
    const ContainerPacket& packet = sample.packets[i];
    index.push_back({packet.frame, sample.ends[i] - packet_of(sample, i).size(), packet.region,
                     packet.texture_id, packet.keyframe});
  }
  return index;
}

bool same_packet(const ContainerPacket& a, const ContainerPacket& b) {
  return a.frame == b.frame && a.region == b.region && a.texture_id == b.texture_id &&
         a.keyframe == b.keyframe && a.bytes == b.bytes;
}

bool same_packets(std::span<const ContainerPacket> a, std::span<const ContainerPacket> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), same_packet);
}

Status read_all(ContainerReader& reader, std::vector<ContainerPacket>& packets) {
  for (;;) {
    ContainerPacket packet;
    const Status status = reader.next(packet);
    if (status == Status::end) return Status::ok;
    if (status != Status::ok) return status;
    packets.push_back(std::move(packet));
  }
}

Status read_through(std::span<const std::byte> file, bool pipe, const DecodeLimits& limits) {
  const Exact bytes(file);
  MemorySource memory(bytes.span());
  PipeSource piped(bytes.span());
  Source& source = pipe ? static_cast<Source&>(piped) : memory;
  auto reader = ContainerReader::open(source, limits);
  if (!reader) return reader.status();
  std::vector<ContainerPacket> packets;
  return read_all(*reader, packets);
}

Status Player::play(ContainerReader& reader, std::uint64_t last_frame) {
  for (;;) {
    ContainerPacket packet;
    const Status more = reader.next(packet);
    if (more != Status::ok && more != Status::end) return more;
    if (more == Status::end || packet.frame > last_frame) return Status::ok;
    if (const Status status = take(packet); status != Status::ok) return status;
  }
}

Status Player::take(const ContainerPacket& packet) {
  const auto parts = parse_packet(packet.bytes);
  if (!parts) return parts.status();
  if (const Status sum = verify_checksum(packet.bytes); sum != Status::ok) return sum;
  const std::uint64_t key = region_key(packet.texture_id, packet.region);
  if (!packet.keyframe) {
    const auto before = states.find(key);
    if (before == states.end() || before->second != parts->base) return Status::reference_missing;
  }
  states[key] = packet_checksum(packet.bytes);
  ++packets;
  return Status::ok;
}

}  // namespace gicodec::test
