#include "backend/hevc/session_encoder.h"

#include "base/checksum.h"
#include "base/guard.h"
#include "transform/yuv444p16.h"

#include <algorithm>

namespace gicodec::hevc {
namespace {

// Pictures at the start of each group that are decoded to check an FFmpeg encoder: an IDR picture
// and one that refers to it.
constexpr unsigned kCheckedPictures = 2;

}  // namespace

std::string_view SessionEncoder::encoder_name() const noexcept {
  if (candidate_ >= settings_.encoders.size()) return "x265";
  return settings_.encoders[candidate_];
}

std::size_t SessionEncoder::bound(std::size_t blocks) const {
  return payload_bound(largest_.picture, blocks * record_count(desc_.block));
}

void SessionEncoder::close() noexcept {
  encoder_.reset();
  decoder_.reset();
}

Status SessionEncoder::open_first() {
  shape_ = largest_;
  return open_encoder(shape_.picture);
}

// Opens the current candidate, or the next one that can be opened.
Status SessionEncoder::open_encoder(const PictureFormat& format) {
  close();
  for (; candidate_ < settings_.encoders.size(); ++candidate_) {
    auto opened = open_ffmpeg_encoder(settings_.encoders[candidate_], format, settings_.coder);
    if (opened) {
      encoder_ = std::move(*opened);
      return Status::ok;
    }
  }
  CoderSettings coder = settings_.coder;
  coder.weights = candidate_ < last_candidate();
  auto opened = open_x265(format, coder);
  if (!opened) return opened.status();
  encoder_ = std::move(*opened);
  return Status::ok;
}

Status SessionEncoder::encode(const EncodeJob& job, std::vector<std::byte>& out) {
  const std::size_t before = out.size();
  const Status status = guarded([&] { return encode_update(job, out); });
  if (status != Status::ok) {
    out.resize(before);
    close();
  }
  return status;
}

// A packed picture shrinks only at a keyframe, or when it is four times too high: a change of size
// costs an IDR picture.
std::uint8_t SessionEncoder::choose_class(const EncodeJob& job) const noexcept {
  if (settings_.layout == HevcLayout::atlas) return 0;
  const std::uint8_t needed = size_class_of(desc_, job.blocks.size());
  const bool keep =
      !job.keyframe && encoder_ && needed <= shape_.size_class && needed + 2 > shape_.size_class;
  return keep ? shape_.size_class : needed;
}

Status SessionEncoder::encode_update(const EncodeJob& job, std::vector<std::byte>& out) {
  if (job.blocks.empty()) {  // no picture; the next one after a keyframe is an IDR picture
    if (job.keyframe) close();
    return Status::ok;
  }
  if (job.keyframe && candidate_ == last_candidate()) {  // retries x265 with weights
    --candidate_;
    close();
  }
  const auto shape = frame_shape(desc_, settings_.packing, settings_.layout, choose_class(job));
  if (!shape) return shape.status();
  if (!encoder_ || !(*shape == shape_)) {
    const bool reuse = encoder_ && shape->picture == shape_.picture;
    shape_ = *shape;
    if (!reuse) {
      if (const Status status = open_encoder(shape_.picture); status != Status::ok) return status;
    }
    since_idr_ = 0;
  }
  if (job.keyframe) since_idr_ = 0;
  // The rest of the raster is what the decoder's picture holds: the mirror in an atlas, earlier
  // blocks in a packed picture.
  if (job.keyframe || raster_.size() != raster_bytes(desc_, shape_)) {
    raster_.assign(raster_bytes(desc_, shape_), std::byte{0});
  }
  records_.clear();
  for (std::size_t i = 0; i < job.blocks.size(); ++i) {
    const auto block = job.records[i];
    records_.insert(records_.end(), block.begin(), block.end());
  }
  fill_absent(desc_, job.presence, records_);
  blocks_to_raster(desc_, shape_, job.blocks, records_, raster_);
  raster_to_picture(settings_.isa, desc_, shape_, raster_, picture_);
  PayloadHead head{.packing = shape_.packing,
                   .layout = shape_.layout,
                   .lossy = lossy(),
                   .bit_depth = shape_.picture.bit_depth,
                   .size_class = shape_.size_class};
  std::vector<std::byte> alpha;
  if (is_a2rgb10(desc_.record.format)) {
    auto section = write_alpha(records_, head);
    if (!section) return section.status();
    alpha = std::move(*section);
  }
  if (const Status status = encode_picture(since_idr_ == 0); status != Status::ok) return status;
  ++since_idr_;
  if (lossy()) {
    picture_to_raster(settings_.isa, desc_, shape_, decoded_, raster_);
    raster_to_blocks(desc_, shape_, job.blocks, raster_, records_);
    const Payload own{.head = head, .alpha_section = alpha, .access_unit = {}};
    if (const Status status = read_alpha(own, records_); status != Status::ok) return status;
  }
  clear_all_absent(desc_, job.presence, records_);
  if (lossy()) std::copy(records_.begin(), records_.end(), job.decoded.begin());
  head.hash = checksum(records_);
  const std::size_t before = out.size();
  write_payload(head, alpha, access_unit_, out);
  return out.size() - before <= bound(job.blocks.size()) ? Status::ok : Status::backend_failed;
}

// Encodes the picture. Falls back to the next encoder, with an IDR picture, until one is right.
Status SessionEncoder::encode_picture(bool idr) {
  for (;;) {
    const Status status = encode_once(idr);
    if (status == Status::ok || candidate_ == last_candidate()) return status;
    ++candidate_;
    if (const Status opened = open_encoder(shape_.picture); opened != Status::ok) return opened;
    since_idr_ = 0;
    idr = true;
  }
}

Status SessionEncoder::encode_once(bool idr) {
  if (const Status status = encoder_->encode(picture_, idr, encoded_); status != Status::ok) {
    return status;
  }
  access_unit_.clear();
  append_access_unit(encoded_, access_unit_);
  return check_or_decode(idr);
}

bool SessionEncoder::must_decode() const noexcept {
  const bool trusted = candidate_ >= settings_.encoders.size();
  return lossy() || (!trusted && since_idr_ < kCheckedPictures);
}

// Refuses what decoders would refuse.
Status SessionEncoder::check_or_decode(bool idr) {
  const auto unit = parse_access_unit(access_unit_, shape_.picture, sets_);
  if (!unit) return unit.status();
  if (unit->idr != idr) return Status::backend_failed;
  if (!must_decode()) {
    decoder_.reset();
    return Status::ok;
  }
  if (idr) {
    auto opened = open_decoder(settings_.decoder, shape_.picture, 1);
    if (!opened) return opened.status();
    decoder_ = std::move(*opened);
  }
  if (!decoder_) return Status::backend_failed;
  if (decoded_.format != shape_.picture) decoded_.reset(shape_.picture);
  if (const Status status = decoder_->decode(*unit, decoded_); status != Status::ok) return status;
  return lossy() || decoded_.samples == picture_.samples ? Status::ok : Status::backend_failed;
}

}  // namespace gicodec::hevc
