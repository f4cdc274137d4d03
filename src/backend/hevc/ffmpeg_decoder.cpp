#include "backend/hevc/codec.h"
#include "backend/hevc/ffmpeg.h"

#include <climits>
#include <cstring>

namespace gicodec::hevc {
namespace {

constexpr std::int64_t kCodedMargin = 64;  // coded sizes exceed the cropped ones by less

class FfmpegDecoder final : public PictureDecoder {
 public:
  FfmpegDecoder(AvOwner<AVCodecContext> context, AvOwner<AVPacket> packet, AvOwner<AVFrame> frame)
      : context_(std::move(context)), packet_(std::move(packet)), frame_(std::move(frame)) {}

  Status decode(const AccessUnit& unit, Picture& picture) override {
    if (const Status status = fill_packet(unit); status != Status::ok) return status;
    if (avcodec_send_packet(context_.get(), packet_.get()) != 0) return Status::corrupt;
    if (avcodec_receive_frame(context_.get(), frame_.get()) != 0) return Status::corrupt;
    const AVFrame& frame = *frame_;
    if (frame.width != static_cast<int>(picture.format.width) ||
        frame.height != static_cast<int>(picture.format.height) ||
        frame.format != pixel_format(picture.format) || frame.decode_error_flags != 0) {
      return Status::corrupt;
    }
    const std::size_t row = picture.format.row_bytes();
    for (std::size_t i = 0; i < picture.format.planes(); ++i) {
      const std::uint8_t* from = frame.data[i];
      std::byte* to = picture.plane(i).data();
      for (std::uint32_t y = 0; y < picture.format.height; ++y, from += frame.linesize[i]) {
        std::memcpy(to, from, row);
        to += row;
      }
    }
    // A second picture in the access unit is an error.
    return avcodec_receive_frame(context_.get(), frame_.get()) == AVERROR(EAGAIN) ? Status::ok
                                                                                  : Status::corrupt;
  }

 private:
  Status fill_packet(const AccessUnit& unit) {
    std::size_t size = 0;
    for (const NalUnit& nal : unit.units) size += kStartCode.size() + nal.size();
    if (size > INT_MAX / 2) return Status::limit_exceeded;
    av_packet_unref(packet_.get());
    if (av_new_packet(packet_.get(), static_cast<int>(size)) != 0) return Status::out_of_memory;
    std::uint8_t* to = packet_->data;
    for (const NalUnit& nal : unit.units) {
      std::memcpy(to, kStartCode.data(), kStartCode.size());
      std::memcpy(to + kStartCode.size(), nal.data(), nal.size());
      to += kStartCode.size() + nal.size();
    }
    return Status::ok;
  }

  AvOwner<AVCodecContext> context_;
  AvOwner<AVPacket> packet_;
  AvOwner<AVFrame> frame_;
};

}  // namespace

Result<std::unique_ptr<PictureDecoder>> open_ffmpeg_decoder(const PictureFormat& format,
                                                            unsigned threads) {
  const AVCodec* codec = avcodec_find_decoder_by_name("hevc");
  if (codec == nullptr) return Status::backend_unavailable;
  AvOwner<AVCodecContext> context(avcodec_alloc_context3(codec));
  AvOwner<AVPacket> packet(av_packet_alloc());
  AvOwner<AVFrame> frame(av_frame_alloc());
  if (!context || !packet || !frame) return Status::out_of_memory;
  context->log_level_offset = kSilent;
  context->flags = AV_CODEC_FLAG_LOW_DELAY;
  context->err_recognition = AV_EF_EXPLODE;
  context->thread_count = static_cast<int>(threads);
  context->thread_type = FF_THREAD_SLICE;  // frame threads would delay pictures
  context->max_pixels = (format.width + kCodedMargin) * (format.height + kCodedMargin);
  if (avcodec_open2(context.get(), codec, nullptr) != 0) return Status::backend_unavailable;
  return std::unique_ptr<PictureDecoder>(
      std::make_unique<FfmpegDecoder>(std::move(context), std::move(packet), std::move(frame)));
}

}  // namespace gicodec::hevc
