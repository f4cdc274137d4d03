#include "video.h"

#include "common/program.h"
#include "ddgi/texels.h"
#include "dump/error.h"

#include <gicodec/backend.h>
#include <gicodec/inspect.h>
#include <gicodec/probes.h>

#ifdef GICODEC_WITH_HEVC
#include "common/hevc_on_demand.h"
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace gicodec::maps {
namespace {

constexpr std::uint32_t kKeyframes = 25;  // pictures from one to the next
constexpr std::size_t kMostAtOnce = 50;   // that a client decodes in an update

/// A record of the kind's frames.
struct Frame {
  std::uint32_t first = 0, pages = 0, bytes = 0, number = 0, chain = 0;
};

TextureDesc picture_of(const IrradianceMapDesc& desc) {
  return probe_texture(Format::A2R10G10B10_UNORM_PACK32,
                       {desc.width / kMapTile, 1, desc.height / kMapTile}, kMapTile, 0,
                       Tiling::atlas_xy_z);
}

std::unique_ptr<Backend> make_backend(int qp) {
#ifdef GICODEC_WITH_HEVC
  HevcSettings settings;
  settings.lossy_qp = qp;
  return std::make_unique<tools::HevcOnDemand>(settings);
#else
  static_cast<void>(qp);
  tools::fail(tools::Exit::internal, "these programs are built without HEVC, which video needs");
#endif
}

}  // namespace

std::uint32_t to_video(Vec3 value) {
  const auto code = [](float v) {
    return static_cast<float>(ddgi::encode_gamma5(std::clamp(v, 0.0F, 1.0F)));
  };
  const float r = code(value.x), g = code(value.y), b = code(value.z);
  const auto rounded = [](float v) {
    return static_cast<std::uint32_t>(std::clamp(std::floor(v + 0.5F), 0.0F, 1023.0F));
  };
  return rounded((r + 2 * g + b) / 4) << 20 | rounded((r - b) / 2 + 512) << 10 |
         rounded((2 * g - r - b) / 4 + 512);
}

Vec3 from_video(std::uint32_t texel) {
  const auto part = [texel](unsigned shift) { return static_cast<float>(texel >> shift & 1023U); };
  const float y = part(20), co = part(10) - 512, cg = part(0) - 512;
  const auto channel = [](float code) {
    return ddgi::decode_gamma5(static_cast<std::uint32_t>(std::clamp(code, 0.0F, 1023.0F)));
  };
  return {channel(y - cg + co), channel(y + cg), channel(y - cg - co)};
}

std::vector<std::uint32_t> video_picture(std::span<const MapTexel> texels,
                                         std::span<const Vec3> values) {
  std::vector<std::uint32_t> picture(values.size());
  std::uint32_t last = to_video({});
  std::size_t place = 0;
  for (const MapTexel& texel : texels) {
    while (place < texel.place) picture[place++] = last;
    last = picture[place++] = to_video(values[texel.place]);
  }
  while (place < picture.size()) picture[place++] = last;
  return picture;
}

VideoEncoder::VideoEncoder(const IrradianceMapDesc& desc, int qp)
    : sizes(std::size_t{2} * desc.pages),
      pages(std::size_t{kMapPageBytes} * desc.pages),
      frames(sizeof(Frame) * desc.frames),
      desc_(desc),
      backend_(make_backend(qp)) {
  EncoderOptions options;
  options.backend = "hevc";
  options.backends = {backend_.get()};
  options.gop = 0;
  encoder_ = tools::take(Encoder::create(picture_of(desc), options), "video");
}

void VideoEncoder::add(std::span<const MapTexel> texels, std::span<const Vec3> values) {
  const std::vector<std::uint32_t> picture = video_picture(texels, values);
  const std::span<const std::byte> view = std::as_bytes(std::span(picture));
  if (number_ % kKeyframes == 0) encoder_->request_keyframe();
  bool key = number_ % kKeyframes == 0;
  Packet packet = tools::take(encoder_->encode(ConstTextureView(view), Selection::all()), "video");
  const auto pages_of = [](const Packet& p) {
    return static_cast<std::uint32_t>((p.size() + kMapPageBytes - 1) / kMapPageBytes);
  };
  if (next_ + pages_of(packet) > desc_.pages) {
    next_ = 0;
    if (!key) {
      key = true;
      encoder_->request_keyframe();
      packet = tools::take(encoder_->encode(ConstTextureView(view), Selection::all()), "video");
    }
  }
  Frame frame;
  frame.pages = pages_of(packet);
  if (frame.pages > desc_.pages)
    tools::fail(tools::Exit::usage, "a picture of {} bytes has no room in {} pages; raise qp",
                packet.size(), desc_.pages);
  if (key) start_ = next_;
  frame.first = next_;
  frame.bytes = static_cast<std::uint32_t>(packet.size());
  frame.number = ++number_;
  next_ += frame.pages;
  frame.chain = next_ - start_;
  const std::span<const std::byte> bytes(packet);
  for (std::uint32_t i = 0; i < frame.pages; ++i) {
    const auto part = bytes.subspan(std::size_t{i} * kMapPageBytes);
    const auto size = static_cast<std::uint16_t>(std::min<std::size_t>(part.size(), kMapPageBytes));
    std::byte* const page = &pages[std::size_t{kMapPageBytes} * (frame.first + i)];
    std::memset(page, 0, kMapPageBytes);
    std::memcpy(page, part.data(), size);
    std::memcpy(&sizes[std::size_t{2} * (frame.first + i)], &size, sizeof size);
  }
  std::memcpy(&frames[sizeof(Frame) * (number_ % desc_.frames)], &frame, sizeof frame);
  last_bytes_ = packet.size();
}

VideoDecoder::VideoDecoder(const IrradianceMapDesc& desc)
    : desc_(desc), backend_(make_backend(-1)), texels_(std::size_t{4} * desc.width * desc.height) {
  restart();
}

void VideoDecoder::restart() {
  DecoderOptions options;
  options.backends = {backend_.get()};
  decoder_ = tools::take(Decoder::create(picture_of(desc_), options), "video");
  decoded_ = 0;
}

bool VideoDecoder::update(std::span<const std::byte> sizes, std::span<const std::byte> pages,
                          std::span<const std::byte> frames, std::span<Vec3> values) {
  const auto frame_at = [&](std::uint32_t number) {
    Frame frame;
    std::memcpy(&frame, &frames[sizeof frame * (number % desc_.frames)], sizeof frame);
    const std::uint64_t end = std::uint64_t{frame.first} + frame.pages;
    const bool sound = frame.number == number && frame.pages > 0 && end <= desc_.pages &&
                       frame.chain >= frame.pages && frame.chain <= end &&
                       frame.bytes <= std::uint64_t{kMapPageBytes} * frame.pages;
    return sound ? std::optional(frame) : std::nullopt;
  };
  std::uint32_t newest = 0;
  for (std::uint32_t slot = 0; slot < desc_.frames; ++slot) {
    std::uint32_t number = 0;
    std::memcpy(&number, &frames[sizeof(Frame) * slot + offsetof(Frame, number)], sizeof number);
    if (number % desc_.frames == slot && frame_at(number)) newest = std::max(newest, number);
  }
  if (newest == decoded_ || newest == 0 || newest == refused_) return false;
  if (newest < decoded_) restart();  // the server begins anew
  // Back to what is decoded, or to the keyframe.
  std::vector<Frame> chain;
  for (std::uint32_t number = newest;; --number) {
    const auto frame = number > 0 ? frame_at(number) : std::nullopt;
    if (!frame || (!chain.empty() && frame->first + frame->pages != chain.back().first)) {
      return false;
    }
    chain.push_back(*frame);
    if (number == decoded_ + 1 && decoded_ != 0) break;
    if (frame->chain == frame->pages) break;
    if (chain.size() >= desc_.frames) return false;
  }
  // What is left is for the updates to come.
  if (chain.size() > kMostAtOnce) {
    chain.erase(chain.begin(), chain.end() - static_cast<std::ptrdiff_t>(kMostAtOnce));
  }
  std::vector<std::byte> packet;
  for (auto frame = chain.rbegin(); frame != chain.rend(); ++frame) {
    if (tools::interrupted()) return false;
    packet.clear();
    for (std::uint32_t page = frame->first; page < frame->first + frame->pages; ++page) {
      std::uint16_t size = 0;
      std::memcpy(&size, &sizes[std::size_t{2} * page], sizeof size);
      const auto bytes = pages.subspan(std::size_t{kMapPageBytes} * page,
                                       std::min<std::size_t>(size, kMapPageBytes));
      packet.insert(packet.end(), bytes.begin(), bytes.end());
    }
    const auto info = peek(packet);
    // What is missing may come with the next update.
    if (packet.size() != frame->bytes || !info || verify_checksum(packet) != Status::ok)
      return false;
    if (info->backend != kBackendHevc ||
        is_keyframe(info->type) != (frame->chain == frame->pages) ||
        decoder_->decode(packet, TextureView{texels_}) != Status::ok) {
      restart();
      refused_ = newest;
      return false;
    }
    decoded_ = frame->number;
  }
  for (std::size_t place = 0; place < values.size(); ++place) {
    std::uint32_t texel = 0;
    std::memcpy(&texel, &texels_[4 * place], sizeof texel);
    values[place] = from_video(texel);
  }
  return true;
}

}  // namespace gicodec::maps
