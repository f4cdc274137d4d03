#include "backend/hevc/ffmpeg_surface.h"

extern "C" {
#include <libavutil/hwcontext.h>
#include <libavutil/pixdesc.h>
}

#include <array>
#include <filesystem>

namespace gicodec::hevc {
namespace {

// Pixel formats in order of preference. Hardware takes 10 bits at the top of 16-bit words.
std::array<AVPixelFormat, 2> candidates(const PictureFormat& format) noexcept {
  const AVPixelFormat own = pixel_format(format);
  return {own, own == AV_PIX_FMT_YUV444P10LE ? AV_PIX_FMT_YUV444P16LE : AV_PIX_FMT_NONE};
}

// The first candidate that is in `list`, which ends with AV_PIX_FMT_NONE.
AVPixelFormat first_in(const PictureFormat& format, const AVPixelFormat* list) noexcept {
  if (list == nullptr) return AV_PIX_FMT_NONE;
  for (const AVPixelFormat wanted : candidates(format)) {
    for (const AVPixelFormat* entry = list; *entry != AV_PIX_FMT_NONE; ++entry) {
      if (*entry == wanted) return wanted;
    }
  }
  return AV_PIX_FMT_NONE;
}

// False without a render node: FFmpeg would print to standard error when it finds none.
bool may_have_device(AVHWDeviceType type) {
  std::error_code error;
  const bool render_node = type == AV_HWDEVICE_TYPE_VAAPI || type == AV_HWDEVICE_TYPE_QSV ||
                           type == AV_HWDEVICE_TYPE_DRM;
  return !render_node || std::filesystem::exists("/dev/dri", error);
}

AVPixelFormat open_device(const AVCodecHWConfig& config, const PictureFormat& format,
                          AVCodecContext& context) {
  if (!may_have_device(config.device_type)) return AV_PIX_FMT_NONE;
  AVBufferRef* opened = nullptr;
  if (av_hwdevice_ctx_create(&opened, config.device_type, nullptr, nullptr, 0) != 0) {
    return AV_PIX_FMT_NONE;
  }
  const AvOwner<AVBufferRef> device(opened);
  AVHWFramesConstraints* limits = av_hwdevice_get_hwframe_constraints(device.get(), nullptr);
  if (limits == nullptr) return AV_PIX_FMT_NONE;
  const AVPixelFormat pixels = first_in(format, limits->valid_sw_formats);
  av_hwframe_constraints_free(&limits);
  if (pixels == AV_PIX_FMT_NONE) return AV_PIX_FMT_NONE;
  AvOwner<AVBufferRef> frames(av_hwframe_ctx_alloc(device.get()));
  if (!frames) return AV_PIX_FMT_NONE;
  auto& description = *reinterpret_cast<AVHWFramesContext*>(frames->data);
  description.format = config.pix_fmt;
  description.sw_format = pixels;
  description.width = static_cast<int>(format.width);
  description.height = static_cast<int>(format.height);
  description.initial_pool_size = 4;
  if (av_hwframe_ctx_init(frames.get()) != 0) return AV_PIX_FMT_NONE;
  context.pix_fmt = config.pix_fmt;
  context.hw_frames_ctx = frames.release();  // the context frees it
  return pixels;
}

}  // namespace

AVPixelFormat choose_surface(const AVCodec& codec, const PictureFormat& format,
                             AVCodecContext& context) {
  if (const AVPixelFormat pixels = first_in(format, codec.pix_fmts); pixels != AV_PIX_FMT_NONE) {
    return context.pix_fmt = pixels;
  }
  for (int i = 0;; ++i) {
    const AVCodecHWConfig* config = avcodec_get_hw_config(&codec, i);
    if (config == nullptr) return AV_PIX_FMT_NONE;
    if ((config->methods & AV_CODEC_HW_CONFIG_METHOD_HW_FRAMES_CTX) == 0) continue;
    if (const auto pixels = open_device(*config, format, context); pixels != AV_PIX_FMT_NONE) {
      return pixels;
    }
  }
}

AvOwner<AVFrame> upload(const AVCodecContext& context, const AVFrame& frame) {
  AvOwner<AVFrame> surface(av_frame_alloc());
  if (surface && (av_hwframe_get_buffer(context.hw_frames_ctx, surface.get(), 0) != 0 ||
                  av_hwframe_transfer_data(surface.get(), &frame, 0) != 0)) {
    surface.reset();
  }
  return surface;
}

}  // namespace gicodec::hevc
