// Owners of FFmpeg's objects, and code that its encoders and decoders share.
#pragma once

#include "backend/hevc/picture.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/frame.h>
#include <libavutil/pixfmt.h>
}

#include <memory>

namespace gicodec::hevc {

struct FreeAv {
  void operator()(AVCodecContext* context) const noexcept { avcodec_free_context(&context); }
  void operator()(AVFrame* frame) const noexcept { av_frame_free(&frame); }
  void operator()(AVPacket* packet) const noexcept { av_packet_free(&packet); }
  void operator()(AVDictionary* dictionary) const noexcept { av_dict_free(&dictionary); }
  void operator()(AVBufferRef* reference) const noexcept { av_buffer_unref(&reference); }
};
template <typename T>
using AvOwner = std::unique_ptr<T, FreeAv>;

/// A context's offset of log levels. It silences the context's messages without changing the
/// process-wide log level and callback, which are the application's. FFmpeg reads 8 bits of a
/// level.
inline constexpr int kSilent = 128;

/// FFmpeg's format of a Picture's samples.
[[nodiscard]] constexpr AVPixelFormat pixel_format(const PictureFormat& format) noexcept {
  if (format.monochrome) return AV_PIX_FMT_GRAY8;
  return format.bit_depth == 8    ? AV_PIX_FMT_YUV444P
         : format.bit_depth == 10 ? AV_PIX_FMT_YUV444P10LE
                                  : AV_PIX_FMT_YUV444P12LE;
}

}  // namespace gicodec::hevc
