#include "session/client_limits.h"

#include "stream/decoder_memory.h"

#include <algorithm>

namespace gicodec {
namespace {

std::uint64_t saturated(std::uint64_t a, std::uint64_t b) noexcept {
  return a > UINT64_MAX - b ? UINT64_MAX : a + b;
}

bool repeated(std::vector<StreamId>& streams) {
  std::sort(streams.begin(), streams.end());
  return std::adjacent_find(streams.begin(), streams.end()) != streams.end();
}

}  // namespace

std::uint64_t client_memory(const Welcome& said, unsigned frames, unsigned threads) noexcept {
  constexpr std::uint64_t kTexture = 512, kProbe = sizeof(std::uint64_t);
  std::uint64_t held = 0, scratch = 0;
  for (const DescribedVolume& volume : said.volumes) {
    const ChunkGrid chunks(volume.geometry.grid, said.chunk);
    for (const DescribedTexture& texture : volume.textures) {
      const TextureDesc& desc = texture.desc;
      const std::uint64_t frame = texture_bytes(desc) + kProbe * probe_count(desc) + kTexture;
      held = saturated(held, frames * frame);
      TextureDesc of_stream = desc;
      std::uint64_t streams = 1;
      if (said.delivery == Delivery::shared) {
        streams = chunks.chunks();
        of_stream.grid = chunks.grid_of(0);  // None is larger.
        held = saturated(held, std::uint64_t{probe_count(desc)} * sizeof(std::uint32_t));
        held = saturated(held, texture_bytes(of_stream));
      }
      held = saturated(held, held_memory(desc));
      held = saturated(held, streams * kTexture * 2);
      scratch = std::max(scratch, scratch_memory(of_stream, threads));
    }
  }
  return saturated(held, scratch);
}

TextureDesc stream_desc(const ClientVolume& volume, const Grid& chunk, StreamId id) {
  TextureDesc desc = volume.textures[id.texture].desc;
  if (id.chunk != StreamId::kWholeVolume) {
    desc.grid = ChunkGrid(volume.geometry.grid, chunk).grid_of(id.chunk);
  }
  return desc;
}

std::uint64_t update_work(const UpdateMessage& update, const std::vector<ClientVolume>& volumes,
                          const Grid& chunk) {
  std::uint64_t work = 0;
  const auto desc_of = [&](StreamId id) { return stream_desc(volumes[id.volume], chunk, id); };
  for (const UpdateMessage::Part& part : update.parts) {
    const auto info = peek(part.packet);
    if (!info) continue;
    work = saturated(work, packet_work(desc_of(part.stream), *info));
  }
  for (const UpdateMessage::Proof& proof : update.proofs) {
    const TextureDesc desc = desc_of(proof.stream);
    work = saturated(work, probe_count(desc) * core_bytes(desc));
  }
  return work;
}

bool streams_once(const UpdateMessage& update) {
  std::vector<StreamId> first, fresh, proven;
  for (const UpdateMessage::Part& part : update.parts) {
    const auto info = peek(part.packet);
    (info.ok() && info->fresh ? fresh : first).push_back(part.stream);
  }
  for (const UpdateMessage::Proof& proof : update.proofs) proven.push_back(proof.stream);
  return !repeated(first) && !repeated(fresh) && !repeated(proven);
}

}  // namespace gicodec
