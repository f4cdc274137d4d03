#include "stream/packet_writer.h"

#include "bitstream/index_buffer.h"

namespace gicodec {

Status PacketWriter::write(const TextureDesc& desc, const BlockHistory& history,
                           std::span<const BlockId> held, const Contents& contents,
                           BackendEncoder& backend, PacketHead head, Packet& out,
                           std::vector<std::byte>& decoded) {
  const bool intra = is_intra(head.info.type), keyframe = is_keyframe(head.info.type) || intra;
  const auto& blocks = contents.blocks;
  BlockTable records = history.table(), mirror = history.table(),
             existing = history.presence_table();
  records.place = contents.ids.data();
  mirror.place = existing.place = held.data();
  presence_.clear();
  stale_.clear();
  before_.clear();
  for (std::size_t i = 0; i < blocks.size() && history.has_stale_bands(); ++i) {
    const auto band = history.stale_band(contents.ids[i]),
               band_before = history.stale_band(held[blocks[i]]);
    if (!band.empty()) stale_.add(blocks[i], band);
    if (!band_before.empty()) before_.add(blocks[i], band_before);
  }
  for (std::size_t i = 0; i < blocks.size() && desc.presence != Presence::all; ++i) {
    const auto exists = history.presence(contents.ids[i]);
    presence_.insert(presence_.end(), exists.begin(), exists.end());
  }
  payload_.clear();
  decoded.resize(backend.lossy() ? blocks.size() * block_bytes(desc) : 0);
  Status status = backend.encode({.desc = desc,
                                  .blocks = blocks,
                                  .records = records,
                                  .mirror = {mirror, nullptr, existing},
                                  .keyframe = keyframe,
                                  .intra = intra && !backend.lossy(),
                                  .presence = presence_,
                                  .decoded = decoded},
                                 payload_);
  if (status != Status::ok) return status;
  if (payload_.size() > backend.bound(blocks.size())) return Status::backend_failed;
  if (backend.lossy()) records = {decoded.data(), block_bytes(desc)};

  guard_bands_.clear();
  if (!stale_.empty()) {
    status = write_guard_band_section({desc, keyframe, blocks, records, mirror, before_}, stale_,
                                      band_memory_, guard_bands_);
    if (status != Status::ok) return status;
  }
  head.info.lossy = backend.lossy() || history.lossy();
  head.info.blocks = static_cast<std::uint32_t>(blocks.size());
  index_.clear();
  head.index_mode = encode_index_buffer(blocks, block_count(desc), index_);

  out.clear();
  out.reserve(kMaxPacketHead + index_.size() + guard_bands_.size() + payload_.size() +
              kPacketChecksum);
  write_packet_head(head, index_, guard_bands_, out);
  out.insert(out.end(), payload_.begin(), payload_.end());
  seal_packet(out);
  return Status::ok;
}

std::size_t packet_bound(const TextureDesc& desc, const BackendEncoder& backend,
                         std::size_t blocks) noexcept {
  return kMaxPacketHead + index_buffer_bound(block_count(desc)) +
         guard_band_section_bound(desc, blocks, blocks) + backend.bound(blocks) + kPacketChecksum;
}

}  // namespace gicodec
