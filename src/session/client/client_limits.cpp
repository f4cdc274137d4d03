#include "session/client/client_limits.h"

#include "bitstream/description.h"
#include "stream/decoder_memory.h"

#include <algorithm>

namespace gicodec {
namespace {

std::uint64_t saturated(std::uint64_t a, std::uint64_t b) noexcept {
  return a > UINT64_MAX - b ? UINT64_MAX : a + b;
}

/// Bytes that a client holds, and that its decoders share.
struct Memory {
  std::uint64_t held = 0, scratch = 0;
  [[nodiscard]] std::uint64_t all() const noexcept { return saturated(held, scratch); }
};

void add(Memory& memory, const TextureDesc& desc, const Grid& region, Delivery delivery,
         unsigned frames, unsigned threads) noexcept {
  constexpr std::uint64_t kTexture = 1024, kBlock = sizeof(std::uint64_t);
  const std::uint64_t blocks = block_count(desc);
  std::uint64_t held =
      frames * (texture_bytes(desc) + kBlock * blocks + kTexture) + kBlock * blocks;
  TextureDesc of_stream = desc;
  std::uint64_t streams = 1;
  if (delivery == Delivery::shared) {
    streams = regions_of(desc, region).regions();
    of_stream = region_texture(desc, region, 0);  // The first region is the largest.
    held += (blocks + std::uint64_t{3} * block_count(of_stream)) * sizeof(std::uint32_t);
  }
  // The sum of all textures may overflow, that of one cannot.
  memory.held = saturated(memory.held, held + held_memory(desc) + streams * kTexture);
  memory.scratch = std::max(memory.scratch, scratch_memory(of_stream, threads));
}

Result<ClientVolume> volume_of(const DescribedVolume& said, const ClientOptions& options,
                               unsigned frames, Memory& memory) {
  auto desc = volume_desc_of(said, options.kinds);
  if (!desc) return desc.status();
  ClientVolume volume{said.id, 0, said.name, *std::move(desc), said.geometry, said.region, {}};
  for (const NamedTexture* texture : textures_of(volume.desc)) {
    const TextureDesc& own = texture->desc;
    if (texture_bytes(own) > options.limits.max_texture_bytes) return Status::limit_exceeded;
    add(memory, own, volume.region, options.delivery, frames, options.threads.count);
    const float error = said.textures[volume.textures.size()].largest_error;
    volume.textures.push_back({texture->name, own, {}, {}, error});
  }
  if (!(volume.textures[0].desc.grid == volume.geometry.grid)) return Status::corrupt;
  return volume;
}

}  // namespace

Result<VolumeDesc> volume_desc_of(const DescribedVolume& said, std::span<const Kind* const> kinds) {
  std::vector<TextureLayout> layouts;
  for (const DescribedTexture& texture : said.textures)
    layouts.push_back({texture.name, texture.layout});
  return read_volume_desc(said.kind, said.description, layouts, kinds);
}

std::uint64_t client_memory(const std::vector<ClientVolume>& volumes, Delivery delivery,
                            unsigned frames, unsigned threads) noexcept {
  Memory memory;
  for (const ClientVolume& volume : volumes) {
    for (const ClientTexture& texture : volume.textures) {
      add(memory, texture.desc, volume.region, delivery, frames, threads);
    }
  }
  return memory.all();
}

Result<std::vector<ClientVolume>> volumes_of(std::span<const DescribedVolume> said,
                                             const ClientOptions& options, unsigned frames) {
  std::vector<ClientVolume> volumes;
  Memory memory;
  for (const DescribedVolume& described : said) {
    auto volume = volume_of(described, options, frames, memory);
    if (!volume) return volume.status();
    if (memory.all() > options.limits.max_total_bytes) return Status::limit_exceeded;
    volumes.push_back(*std::move(volume));
  }
  return volumes;
}

TextureDesc stream_desc(const ClientVolume& volume, StreamId id) noexcept {
  const TextureDesc& desc = volume.textures[id.texture].desc;
  return id.region == StreamId::kWholeVolume ? desc
                                             : region_texture(desc, volume.region, id.region);
}

/// Bytes of the records that a new presence is compared with, unless they come with the update.
static std::uint64_t presence_work(const UpdateMessage& update, const ClientFrame& frame,
                                   StreamId stream, const PacketInfo& info) {
  const ClientVolume& volume = *frame.find(stream.volume);
  const auto [group, first] = group_of(volume.desc, stream.texture);
  if (stream.texture - first != group->presence) return 0;
  std::uint64_t work = 0;
  for (std::size_t t = 0; t < group->textures.size(); ++t) {
    if (group->textures[t].desc.presence == Presence::all) continue;
    StreamId other = stream;
    other.texture = static_cast<std::uint8_t>(first + t);
    const auto comes = [&](const UpdateMessage::Part& part) { return part.stream == other; };
    if (std::any_of(update.parts.begin(), update.parts.end(), comes)) continue;
    const TextureDesc desc = stream_desc(volume, other);
    const std::uint64_t all = block_count(desc);
    const bool any = info.all_blocks || is_keyframe(info.type);  // a keyframe clears the others
    const std::uint64_t blocks = any ? all : std::min<std::uint64_t>(info.blocks, all);
    work = saturated(work, blocks * block_bytes(desc));
  }
  return work;
}

std::uint64_t update_work(const UpdateMessage& update, const ClientFrame& frame) {
  std::uint64_t work = 0;
  const auto desc_of = [&](StreamId id) { return stream_desc(*frame.find(id.volume), id); };
  for (const UpdateMessage::Part& part : update.parts) {
    const auto info = peek(part.packet);
    if (!info) continue;
    work = saturated(work, packet_work(desc_of(part.stream), *info));
    work = saturated(work, presence_work(update, frame, part.stream, *info));
  }
  for (const UpdateMessage::Proof& proof : update.proofs) {
    const TextureDesc desc = desc_of(proof.stream);
    work = saturated(work, block_count(desc) * block_bytes(desc));
  }
  return work;
}

bool proofs_once(const UpdateMessage& update) {
  std::vector<StreamId> proven;
  for (const UpdateMessage::Proof& proof : update.proofs) proven.push_back(proof.stream);
  std::sort(proven.begin(), proven.end());
  return std::adjacent_find(proven.begin(), proven.end()) == proven.end();
}

}  // namespace gicodec
