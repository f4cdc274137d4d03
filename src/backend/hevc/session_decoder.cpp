#include "backend/hevc/session_decoder.h"

#include "backend/hevc/payload.h"
#include "base/checksum.h"
#include "base/guard.h"
#include "transform/yuv444p16.h"

namespace gicodec::hevc {

Status SessionDecoder::decode(const DecodeJob& job) {
  if (!job.keyframe && !ready_) return Status::reference_missing;
  const Status status = guarded([&] { return decode_update(job); });
  ready_ = status == Status::ok;
  if (!ready_) decoder_.reset();
  return status;
}

Status SessionDecoder::decode_update(const DecodeJob& job) {
  if (!is_supported(job.isa)) return Status::invalid_settings;
  if (job.records.size() != job.blocks.size() * block_bytes(desc_)) return Status::invalid_argument;
  if (job.blocks.empty()) {
    if (job.keyframe) decoder_.reset();
    return job.payload.empty() ? Status::ok : Status::corrupt;
  }
  const auto payload = read_payload(job.payload);
  if (!payload) return payload.status();
  const PayloadHead& head = payload->head;
  const auto shape = frame_shape(desc_, head.packing, head.layout, head.size_class);
  if (!shape) return shape.status();
  const bool colour = is_a2rgb10(desc_.record.format);
  if (head.bit_depth != shape->picture.bit_depth || (!colour && (head.alpha != 0 || head.lossy)) ||
      (head.layout == HevcLayout::packed &&
       job.blocks.size() > std::size_t{shape->columns} * shape->rows) ||
      job.payload.size() > payload_bound(shape->picture, job.records.size() / desc_.record.bytes)) {
    return Status::corrupt;
  }
  const auto unit = parse_access_unit(payload->access_unit, shape->picture, sets_);
  if (!unit) return unit.status();
  if (unit->idr) {
    decoder_.reset();
    auto opened = open_decoder(kind_, shape->picture, threads_);
    if (!opened) return opened.status();
    decoder_ = std::move(*opened);
    shape_ = *shape;
    picture_.reset(shape_.picture);
    raster_.resize(raster_bytes(desc_, shape_));
  } else if (job.keyframe || !decoder_ || !(*shape == shape_)) {
    return Status::corrupt;
  }
  if (const Status status = decoder_->decode(*unit, picture_); status != Status::ok) return status;
  picture_to_raster(job.isa, desc_, shape_, picture_, raster_);
  raster_to_blocks(desc_, shape_, job.blocks, raster_, job.records);
  if (colour) {
    if (const Status status = read_alpha(*payload, job.records); status != Status::ok)
      return status;
  }
  clear_all_absent(desc_, job.presence, job.records);
  // A third-party decoder may hide an error; wrong texels must not get out.
  return checksum(job.records) == head.hash ? Status::ok : Status::corrupt;
}

}  // namespace gicodec::hevc
