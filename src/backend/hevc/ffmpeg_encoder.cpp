#include "backend/hevc/codec.h"
#include "backend/hevc/ffmpeg.h"
#include "backend/hevc/ffmpeg_surface.h"

extern "C" {
#include <libavutil/opt.h>
}

#include <cstring>

namespace gicodec::hevc {
namespace {

constexpr int kEndlessGop = 1 << 24;  // the session decides about keyframes
constexpr unsigned kHighAlignmentShift = 6;

struct Option {
  std::string_view encoder;  // a name or the end of one
  const char* key;
  const char* value;
};
// No delay, IDR pictures on demand, no loss.
constexpr Option kOptions[] = {
    {"libx265", "tune", "zerolatency"},
    {"libx265", "forced-idr", "1"},
    {"_nvenc", "tune", "lossless"},
    {"_nvenc", "rc", "constqp"},
    {"_nvenc", "qp", "0"},
    {"_nvenc", "zerolatency", "1"},
    {"_nvenc", "delay", "0"},
    {"_nvenc", "forced-idr", "1"},
    {"_nvenc", "surfaces", "1"},
    {"_vaapi", "rc_mode", "CQP"},
    {"_vaapi", "qp", "1"},
    {"_vaapi", "async_depth", "1"},
    {"_qsv", "async_depth", "1"},
    {"_qsv", "forced_idr", "1"},
    {"_amf", "usage", "ultralowlatency"},
};

constexpr std::string_view kX265 = "libx265";
constexpr std::string_view kX265Params =
    "log-level=none:lossless=1:frame-threads=1:scenecut=0:open-gop=0:ref=1:bframes=0:info=0:"
    "allow-non-conformance=1:psy-rd=0:psy-rdoq=0:"
    "pools=none:wpp=0:";  // as in x265_encoder.cpp

Status set_options(const std::string& name, const PictureFormat& format,
                   const CoderSettings& settings, AVCodecContext& context) {
  const auto set = [&](const char* key, const char* value) {
    // Ignores options that this version of the encoder does not know.
    return av_opt_find(context.priv_data, key, nullptr, 0, 0) == nullptr ||
           av_opt_set(context.priv_data, key, value, 0) >= 0;
  };
  for (const Option& option : kOptions) {
    if (name.ends_with(option.encoder) && !set(option.key, option.value)) {
      return Status::backend_unavailable;
    }
  }
  if (name == kX265) {
    const std::string tree = std::to_string(coding_tree_side(format));
    const std::string params = std::string(kX265Params) + "ctu=" + tree + ":max-tu-size=" + tree;
    if (!set("x265-params", params.c_str())) {
      return Status::backend_unavailable;
    }
    if (!settings.preset.empty() && !set("preset", settings.preset.c_str())) {
      return Status::backend_unavailable;
    }
  }
  return Status::ok;
}

// Copies samples to FFmpeg's frame, shifted to the top of a word if its format requires that.
void copy_samples(const Picture& picture, AVFrame& frame) {
  const bool shifted = frame.format == AV_PIX_FMT_YUV444P16LE;
  const std::size_t row = picture.format.row_bytes();
  for (std::size_t i = 0; i < picture.format.planes(); ++i) {
    const std::byte* from = picture.plane(i).data();
    std::uint8_t* to = frame.data[i];
    for (std::uint32_t y = 0; y < picture.format.height;
         ++y, from += row, to += frame.linesize[i]) {
      if (!shifted) {
        std::memcpy(to, from, row);
        continue;
      }
      for (std::size_t x = 0; x < row; x += sizeof(std::uint16_t)) {
        std::uint16_t sample;
        std::memcpy(&sample, from + x, sizeof sample);
        sample = static_cast<std::uint16_t>(sample << kHighAlignmentShift);
        std::memcpy(to + x, &sample, sizeof sample);
      }
    }
  }
}

class FfmpegEncoder final : public PictureEncoder {
 public:
  FfmpegEncoder(AvOwner<AVCodecContext> context, AVPixelFormat pixels, AvOwner<AVPacket> packet)
      : context_(std::move(context)), packet_(std::move(packet)), pixels_(pixels) {}

  Status encode(const Picture& picture, bool idr, std::vector<std::byte>& out) override {
    AvOwner<AVFrame> frame(av_frame_alloc());
    if (!frame) return Status::out_of_memory;
    frame->format = pixels_;
    frame->width = static_cast<int>(picture.format.width);
    frame->height = static_cast<int>(picture.format.height);
    if (av_frame_get_buffer(frame.get(), 0) != 0) return Status::out_of_memory;
    copy_samples(picture, *frame);
    if (context_->hw_frames_ctx != nullptr) frame = upload(*context_, *frame);
    if (!frame) return Status::backend_failed;
    frame->pict_type = idr ? AV_PICTURE_TYPE_I : AV_PICTURE_TYPE_P;
    frame->pts = next_++;
    av_packet_unref(packet_.get());
    if (avcodec_send_frame(context_.get(), frame.get()) != 0 ||
        avcodec_receive_packet(context_.get(), packet_.get()) != 0) {
      return Status::backend_failed;  // also for an encoder that needs more pictures first
    }
    const auto* bytes = reinterpret_cast<const std::byte*>(packet_->data);
    out.assign(bytes, bytes + packet_->size);
    return Status::ok;
  }

 private:
  AvOwner<AVCodecContext> context_;
  AvOwner<AVPacket> packet_;
  AVPixelFormat pixels_;
  std::int64_t next_ = 0;
};

}  // namespace

Result<std::unique_ptr<PictureEncoder>> open_ffmpeg_encoder(const std::string& name,
                                                            const PictureFormat& format,
                                                            const CoderSettings& settings) {
  const AVCodec* codec = avcodec_find_encoder_by_name(name.c_str());
  if (codec == nullptr || codec->id != AV_CODEC_ID_HEVC) return Status::backend_unavailable;
  AvOwner<AVCodecContext> context(avcodec_alloc_context3(codec));
  AvOwner<AVPacket> packet(av_packet_alloc());
  if (!context || !packet) return Status::out_of_memory;
  context->log_level_offset = kSilent;
  context->width = static_cast<int>(format.width);
  context->height = static_cast<int>(format.height);
  context->time_base = {1, 30};
  context->gop_size = kEndlessGop;
  context->max_b_frames = 0;
  context->thread_count = static_cast<int>(settings.threads);
  context->flags = AV_CODEC_FLAG_LOW_DELAY;
  const AVPixelFormat pixels = choose_surface(*codec, format, *context);
  if (pixels == AV_PIX_FMT_NONE) return Status::backend_unavailable;
  if (const Status status = set_options(name, format, settings, *context); status != Status::ok) {
    return status;
  }
  if (avcodec_open2(context.get(), codec, nullptr) != 0) return Status::backend_unavailable;
  return std::unique_ptr<PictureEncoder>(
      std::make_unique<FfmpegEncoder>(std::move(context), pixels, std::move(packet)));
}

}  // namespace gicodec::hevc
