#include "tools/hostile_containers.h"

#include "bitstream/description.h"
#include "bitstream/packet.h"
#include "container_support.h"
#include "dump/error.h"

#include <gicodec/gicodec.h>

#include <fmt/core.h>

#include <functional>
#include <utility>

namespace gicodec::tools {
namespace {

/// As large as one texture may be.
const TextureDesc kGreat = probe_texture(Format::R8G8B8A8_UNORM, {256, 256, 256}, 2);
/// As many probes as there may be.
const TextureDesc kMany = probe_texture(Format::R16_SFLOAT, {256, 256, 256}, 1, 0);
const TextureDesc kSmall = probe_texture(Format::R16_SFLOAT, {4, 2, 3}, 1, 0);

/// A keyframe without probes, which stands for a texture of zeros. An encoder would hold that
/// texture; the description's hash is all that such a packet has of it.
Packet zeros(const TextureDesc& desc) {
  auto encoder = take(Encoder::create(kSmall), "encoder");
  const std::vector<std::byte> texels(static_cast<std::size_t>(texture_bytes(kSmall)));
  const Packet small = take(encoder.encode(ConstTextureView(texels)), "packet");
  const PacketParts parts = take(parse_packet(small), "packet");
  const PacketHead head{
      .info = parts.info, .index_mode = parts.index_mode, .base = description_hash(desc)};
  Packet packet;
  write_packet_head(head, parts.index, parts.guard_bands, packet);
  packet.insert(packet.end(), parts.payload.begin(), parts.payload.end());
  seal_packet(packet);
  return packet;
}

using test::ProbeTexture;

std::vector<std::byte> container(const ContainerDescription& description,
                                 const std::vector<Packet>& packets, std::size_t repeats = 1) {
  test::MemorySink file;
  auto writer = take(ContainerWriter::create(file, description), "writer");
  for (std::size_t frame = 0; frame < repeats; ++frame) {
    for (const Packet& packet : packets) check(writer.add(frame, packet), "packet");
  }
  check(writer.finish(), "index");
  return std::move(file.bytes);
}

ContainerDescription one(const TextureDesc& desc, Metadata metadata = {}) {
  const ProbeTexture texture{"t", desc, std::move(metadata)};
  return test::probe_description({&texture, 1});
}

/// Cut into regions of a probe each, of which the first ones have a packet.
std::vector<std::byte> cut(const TextureDesc& desc, std::size_t regions) {
  ContainerDescription description = one(desc);
  description.volumes[0].region = {1, 1, 1};
  const TextureDesc part = region_texture(desc, {1, 1, 1}, 0);
  const std::vector<std::byte> texels(static_cast<std::size_t>(texture_bytes(part)));
  auto encoder = take(Encoder::create(part), "encoder");
  const Packet packet = take(encoder.encode(ConstTextureView(texels)), "packet");
  test::MemorySink file;
  auto writer = take(ContainerWriter::create(file, description), "writer");
  for (std::uint32_t region = 0; region < regions; ++region) {
    check(writer.add(0, packet, region), "packet");
  }
  check(writer.finish(), "index");
  return std::move(file.bytes);
}

/// Entries from `make` until they fill the description.
Metadata fill(const std::function<std::pair<std::string, std::string>(std::size_t)>& make) {
  constexpr std::size_t kRoom = kHostileBytes - 2048;
  Metadata metadata;
  for (std::size_t bytes = 0; bytes < kRoom;) {
    metadata.push_back(make(metadata.size()));
    bytes += metadata.back().first.size() + metadata.back().second.size() + 6;
  }
  metadata.pop_back();
  return metadata;
}

/// Small numbers in few characters.
std::string short_name(std::size_t i) {
  std::string name;
  for (; i > 0 || name.empty(); i /= 64) name += static_cast<char>('0' + i % 64);
  return name;
}

HostileContainer of_metadata(std::string name, Metadata metadata, std::string refusal = "") {
  return {std::move(name), container(one(kMany, std::move(metadata)), {}), std::move(refusal),
          true};
}

}  // namespace

std::vector<HostileContainer> hostile_containers() {
  std::vector<HostileContainer> all;
  const auto add = [&](HostileContainer next) { all.push_back(std::move(next)); };
  add({"great texture, no packets", container(one(kGreat), {}), "", true});
  {
    std::vector<ProbeTexture> textures;
    for (int i = 0; i < 256; ++i) textures.push_back({short_name(i + 64), kGreat});
    add({"256 great textures, no packets", container(test::probe_description(textures), {}), "",
         true});
  }
  const std::string takes = "--max-memory";
  add({"great texture of zeros", container(one(kGreat), {zeros(kGreat)}), takes});
  add({"many probes of zeros", container(one(kMany), {zeros(kMany)}), takes});
  add({"great texture of regions", cut(kGreat, 1), takes, false, true});
  add({"packets of many regions", cut(kMany, 16000), ""});
  {
    const Packet packet = zeros(kSmall);
    const std::size_t repeats = (kHostileBytes - 4096) / (packet.size() + 20);
    add({"small packets", container(one(kSmall), {packet}, repeats), ""});
  }

  add(of_metadata("all probes inactive", {{"inactive", "0-16777214"}}));
  add(of_metadata("all probes inactive, 20 times", Metadata(20, {"inactive", "0-16777214"}),
                  "metadata inactive stands twice"));
  {
    std::string odd;
    for (std::size_t probe = 0; odd.size() < kHostileBytes - 4096; probe += 2) {
      odd += fmt::format("{},", probe);
    }
    add(of_metadata("every second probe inactive", {{"inactive", odd}}));
  }
  add(of_metadata("a long inactive that makes no sense",
                  {{"inactive", std::string(kHostileBytes - 4096, ' ') + "x"}}, "line 1"));
  add(of_metadata("empty entries",
                  fill([](std::size_t) { return std::pair(std::string(), std::string()); })));
  add(of_metadata("names", fill([](std::size_t i) { return std::pair(short_name(i), ""); })));
  add(of_metadata("attributes", fill([](std::size_t i) {
                    return std::pair("attribute:" + short_name(i), std::string("int 1"));
                  }),
                  "more than 4096 attributes"));
  add(of_metadata("attributes of all frames", fill([](std::size_t i) {
                    return std::pair(fmt::format("attribute@{}:a", i), std::string("int 1"));
                  })));
  add(of_metadata("attributes of one frame", fill([](std::size_t i) {
                    return std::pair("attribute@1:" + short_name(i), std::string("int 1"));
                  }),
                  "more than 4096 attributes"));
  add(of_metadata("one attribute many times", fill([](std::size_t) {
                    return std::pair(std::string("attribute:a"), std::string("int 1"));
                  }),
                  "metadata attribute:a stands twice"));
  add(of_metadata("a long name that makes no sense",
                  {{"attribute@" + std::string(kHostileBytes - 4096, '\x1b'), ""}}, "is damaged"));
  add(of_metadata("control characters", {{"dropped", std::string(kHostileBytes - 4096, '\x1b')}}));
  {
    ContainerDescription description = one(kSmall);
    description.metadata = fill([](std::size_t i) { return std::pair(short_name(i), ""); });
    add({"names of the file", container(description, {zeros(kSmall)}), ""});
    description.metadata = {{"frames", std::string(kHostileBytes - 4096, '\x1b')}};
    auto cut = container(description, {zeros(kSmall)});
    cut.resize(cut.size() - 1);
    add({"a long number of frames, cut off", std::move(cut), "its end is missing"});
  }
  return all;
}

std::vector<std::byte> small_packets_of_a_great_region() {
  const TextureDesc desc = probe_texture(Format::R8_UNORM, {256, 256, 256}, 1, 0);
  ContainerDescription description = one(desc);
  description.volumes[0].region = desc.grid;
  std::vector<std::byte> texels(static_cast<std::size_t>(texture_bytes(desc)));
  EncoderOptions options;
  options.backend = "raw";
  options.gop = 0;
  auto encoder = take(Encoder::create(region_texture(desc, desc.grid, 0), options), "encoder");
  test::MemorySink file;
  auto writer = take(ContainerWriter::create(file, description), "writer");
  for (std::uint32_t block = 0; file.bytes.size() < kHostileBytes - 4096; ++block) {
    texels[block] = std::byte{1};
    const std::vector<std::uint32_t> blocks{block};
    check(
        writer.add(block,
                   take(encoder.encode(ConstTextureView(texels), Selection(blocks)), "packet"), 0),
        "packet");
  }
  check(writer.finish(), "index");
  return std::move(file.bytes);
}

}  // namespace gicodec::tools
