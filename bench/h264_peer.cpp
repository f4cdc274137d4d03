#include "h264_peer.h"

#include "backend/hevc/ffmpeg.h"

extern "C" {
#include <libavutil/opt.h>
}

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>

namespace gicodec::bench {
namespace {

void require(bool done, const char* what) {
  if (!done) throw std::runtime_error(std::string("H.264: ") + what + " failed");
}

constexpr int kOffset = 512;  // of chroma

std::uint16_t code_of(int value) { return static_cast<std::uint16_t>(std::clamp(value, 0, 1023)); }

}  // namespace

struct H264Peer::Codec {
  hevc::AvOwner<AVCodecContext> encoder, decoder;
  hevc::AvOwner<AVFrame> in{av_frame_alloc()}, out{av_frame_alloc()};
  hevc::AvOwner<AVPacket> packet{av_packet_alloc()};
};

H264Peer::H264Peer(std::uint32_t width, std::uint32_t height, int qp)
    : codec_(std::make_unique<Codec>()), decoded_(std::size_t{4} * width * height) {
  const AVCodec* const x264 = avcodec_find_encoder_by_name("libx264");
  const AVCodec* const h264 = avcodec_find_decoder(AV_CODEC_ID_H264);
  require(x264 != nullptr && h264 != nullptr, "finding x264");
  codec_->encoder.reset(avcodec_alloc_context3(x264));
  codec_->decoder.reset(avcodec_alloc_context3(h264));
  for (const auto& context : {codec_->encoder.get(), codec_->decoder.get()}) {
    context->log_level_offset = hevc::kSilent;
  }
  AVCodecContext& encoder = *codec_->encoder;
  encoder.width = static_cast<int>(width);
  encoder.height = static_cast<int>(height);
  encoder.pix_fmt = AV_PIX_FMT_YUV444P10LE;
  encoder.time_base = {1, 5};
  encoder.gop_size = 1000;
  encoder.max_b_frames = 0;
  encoder.thread_count = 1;
  require(av_opt_set(encoder.priv_data, "tune", "zerolatency", 0) == 0, "its tune");
  require(av_opt_set_int(encoder.priv_data, "qp", qp, 0) == 0, "its quantiser");
  require(avcodec_open2(&encoder, x264, nullptr) == 0, "opening x264");
  codec_->decoder->flags |= AV_CODEC_FLAG_LOW_DELAY;
  codec_->decoder->thread_count = 1;
  require(avcodec_open2(codec_->decoder.get(), h264, nullptr) == 0, "opening the decoder");
  AVFrame& in = *codec_->in;
  in.format = encoder.pix_fmt;
  in.width = encoder.width;
  in.height = encoder.height;
  require(av_frame_get_buffer(&in, 0) == 0, "a picture's memory");
  in.pts = 0;
}

H264Peer::H264Peer(H264Peer&&) noexcept = default;
H264Peer::~H264Peer() = default;

std::size_t H264Peer::add(std::span<const std::uint32_t> texels) {
  AVFrame &in = *codec_->in, &out = *codec_->out;
  AVPacket& packet = *codec_->packet;
  require(av_frame_make_writable(&in) == 0, "a picture's memory");
  const auto width = static_cast<std::size_t>(in.width);
  const auto sample = [&](AVFrame& frame, std::size_t plane, std::size_t i) -> std::uint16_t& {
    std::uint8_t* const row =
        frame.data[plane] + static_cast<std::ptrdiff_t>(i / width) * frame.linesize[plane];
    return reinterpret_cast<std::uint16_t*>(row)[i % width];
  };
  for (std::size_t i = 0; i < texels.size(); ++i) {
    const auto channel = [&](unsigned shift) {
      return static_cast<int>(texels[i] >> shift & 1023);
    };
    const int r = channel(0), g = channel(10), b = channel(20);
    sample(in, 0, i) = code_of((r + 2 * g + b + 2) >> 2);
    sample(in, 1, i) = code_of(((r - b + 1) >> 1) + kOffset);
    sample(in, 2, i) = code_of(((2 * g - r - b + 2) >> 2) + kOffset);
  }
  require(avcodec_send_frame(codec_->encoder.get(), &in) == 0, "coding");
  ++in.pts;
  require(avcodec_receive_packet(codec_->encoder.get(), &packet) == 0, "coding");
  const auto bytes = static_cast<std::size_t>(packet.size);
  require(avcodec_send_packet(codec_->decoder.get(), &packet) == 0, "decoding");
  require(avcodec_receive_frame(codec_->decoder.get(), &out) == 0, "decoding");
  for (std::size_t i = 0; i < texels.size(); ++i) {
    const int y = sample(out, 0, i), co = sample(out, 1, i) - kOffset,
              cg = sample(out, 2, i) - kOffset;
    const std::uint32_t texel = static_cast<std::uint32_t>(code_of(y - cg + co)) |
                                static_cast<std::uint32_t>(code_of(y + cg)) << 10 |
                                static_cast<std::uint32_t>(code_of(y - cg - co)) << 20;
    std::memcpy(&decoded_[sizeof texel * i], &texel, sizeof texel);
  }
  av_packet_unref(&packet);
  av_frame_unref(&out);
  return bytes;
}

}  // namespace gicodec::bench
