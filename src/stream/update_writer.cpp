#include "stream/update_writer.h"

#include "bitstream/index_buffer.h"
#include "stream/border_section.h"

namespace gicodec {

Status UpdateWriter::write(const Mirror& mirror, BackendEncoder& backend, PacketHead head,
                           const Update& update, Packet& out) {
  const auto& desc = mirror.desc();
  const bool keyframe = head.info.keyframe || head.info.fresh;
  payload_.clear();
  Status status =
      backend.encode({desc, update.probes, update.cores, mirror.cores(), keyframe}, payload_);
  if (status != Status::ok) return status;
  if (payload_.size() > backend.bound(update.probes.size())) return Status::backend_failed;

  borders_.clear();
  if (!update.stale.empty()) {
    status = write_border_section({mirror, keyframe, update.probes, update.cores}, update.stale,
                                  borders_);
    if (status != Status::ok) return status;
  }
  head.info.lossy = backend.lossy();
  head.info.probes = static_cast<std::uint32_t>(update.probes.size());
  index_.clear();
  head.index_mode = encode_index_buffer(update.probes, probe_count(desc), index_);

  out.clear();
  out.reserve(kMaxPacketHead + index_.size() + borders_.size() + payload_.size() + kPacketChecksum);
  write_packet_head(head, index_, borders_, out);
  out.insert(out.end(), payload_.begin(), payload_.end());
  seal_packet(out);
  return Status::ok;
}

std::size_t update_bound(const TextureDesc& desc, const BackendEncoder& backend,
                         std::size_t probes) noexcept {
  return kMaxPacketHead + index_buffer_bound(probe_count(desc)) +
         border_section_bound(desc, probes, probes) + backend.bound(probes) + kPacketChecksum;
}

}  // namespace gicodec
