// Input frames of an FFmpeg encoder: in memory, or on a device.
#pragma once

#include "backend/hevc/ffmpeg.h"
#include "backend/hevc/picture.h"

namespace gicodec::hevc {

/// Sets context.pix_fmt and, for an encoder that takes only device frames, opens the device.
/// Returns the pixel format of frames in memory; AV_PIX_FMT_NONE if there is none.
[[nodiscard]] AVPixelFormat choose_surface(const AVCodec& codec, const PictureFormat& format,
                                           AVCodecContext& context);
/// A copy of `frame` on the device of `context`; null on failure.
[[nodiscard]] AvOwner<AVFrame> upload(const AVCodecContext& context, const AVFrame& frame);

}  // namespace gicodec::hevc
