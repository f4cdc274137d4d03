#include "backend/hevc/codec.h"

#include <x265.h>

namespace gicodec::hevc {
namespace {

constexpr int kInfiniteInterval = -1;  // the session decides about keyframes

struct FreeParam {
  const x265_api* api;
  void operator()(x265_param* param) const noexcept { api->param_free(param); }
};
struct CloseEncoder {
  const x265_api* api;
  void operator()(x265_encoder* encoder) const noexcept { api->encoder_close(encoder); }
};
using ParamOwner = std::unique_ptr<x265_param, FreeParam>;
using EncoderOwner = std::unique_ptr<x265_encoder, CloseEncoder>;

void set_options(x265_param& param, const PictureFormat& format, const CoderSettings& settings) {
  param.internalBitDepth = format.bit_depth;
  param.internalCsp = format.monochrome ? X265_CSP_I400 : X265_CSP_I444;
  param.sourceWidth = static_cast<int>(format.width);
  param.sourceHeight = static_cast<int>(format.height);
  param.fpsNum = 30;
  param.fpsDenom = 1;
  param.logLevel = X265_LOG_NONE;
  param.bAllowNonConformance = 1;  // of size and level
  param.bAnnexB = 1;
  param.bRepeatHeaders = 1;
  param.bEmitInfoSEI = 0;
  // One picture in, one access unit out; IDR pictures on request.
  param.bframes = 0;
  param.lookaheadDepth = 0;
  param.frameNumThreads = 1;
  param.lookaheadThreads = 0;
  param.scenecutThreshold = 0;
  param.bOpenGOP = 0;
  param.keyframeMax = kInfiniteInterval;
  param.maxNumReferences = 1;                            // more cost memory and gain nothing
  param.bEnableWeightedPred = settings.weights ? 1 : 0;  // light often grows or fades everywhere
  // x265 3.5 can lose its wavefront's workers, and then waits for them for ever.
  param.bEnableWavefront = 0;
  param.bDistributeModeAnalysis = 0;
  param.bDistributeMotionEstimation = 0;
  param.maxCUSize = coding_tree_side(format);
  param.maxTUSize = param.maxCUSize;
  // Codes numbers, not for the eye.
  param.rc.rateControlMode = X265_RC_CQP;
  param.rc.aqMode = X265_AQ_NONE;
  param.rc.cuTree = 0;
  param.rc.ipFactor = 1.0;
  param.psyRd = 0;
  param.psyRdoq = 0;
  param.bEnableSAO = 1;  // see ~X265Encoder
  param.bLossless = settings.lossy_qp < 0 ? 1 : 0;
  if (settings.lossy_qp >= 0) {
    param.rc.qp = settings.lossy_qp;
  } else {
    param.bEnableLoopFilter = 0;
    param.selectiveSAO = 1;  // in IDR pictures only
  }
}

struct Opened {
  EncoderOwner encoder;
  x265_picture blank;
};

Result<Opened> open(const x265_api* api, const PictureFormat& format,
                    const CoderSettings& settings) {
  const ParamOwner param(api->param_alloc(), FreeParam{api});
  if (!param) return Status::out_of_memory;
  const char* preset = settings.preset.empty() ? "medium" : settings.preset.c_str();
  if (api->param_default_preset(param.get(), preset, "zerolatency") != 0) {
    return Status::invalid_settings;
  }
  set_options(*param, format, settings);
  EncoderOwner encoder(api->encoder_open(param.get()), CloseEncoder{api});
  if (!encoder) return Status::backend_failed;
  Opened opened{std::move(encoder), {}};
  api->picture_init(param.get(), &opened.blank);
  return opened;
}

// x265 fills tables when it opens its first encoder of a bit depth, without locking. The
// initialisation of a local constant locks.
template <int kBitDepth>
const x265_api* primed_api() {
  static const x265_api* const api = [] {
    const x265_api* found = x265_api_get(kBitDepth);
    const PictureFormat smallest{kMinWidth, kMinHeight, kBitDepth, false};
    if (found != nullptr && !open(found, smallest, {}).ok()) found = nullptr;
    return found;
  }();
  return api;
}

const x265_api* api_of(unsigned bit_depth) {
  switch (bit_depth) {
    case 8:
      return primed_api<8>();
    case 10:
      return primed_api<10>();
    case 12:
      return primed_api<12>();
    default:
      return nullptr;
  }
}

class X265Encoder final : public PictureEncoder {
 public:
  X265Encoder(const x265_api* api, const PictureFormat& format, Opened opened)
      : api_(api), opened_(std::move(opened)) {
    last_.reset(format);
  }
  X265Encoder(const X265Encoder&) = delete;
  X265Encoder& operator=(const X265Encoder&) = delete;
  // x265 3.5 leaks the buffers of its sample adaptive offset, some bytes per sample, unless the
  // last picture used it.
  ~X265Encoder() override {
    x265_nal* units = nullptr;
    std::uint32_t count = 0;
    if (next_ > 0) static_cast<void>(submit(last_, true, units, count));
  }

  Status encode(const Picture& picture, bool idr, std::vector<std::byte>& out) override {
    x265_nal* units = nullptr;
    std::uint32_t count = 0;
    if (!submit(picture, idr, units, count)) return Status::backend_failed;
    out.clear();
    for (const x265_nal& unit : std::span(units, count)) {
      const auto* bytes = reinterpret_cast<const std::byte*>(unit.payload);
      out.insert(out.end(), bytes, bytes + unit.sizeBytes);
    }
    return Status::ok;
  }

 private:
  bool submit(const Picture& picture, bool idr, x265_nal*& units, std::uint32_t& count) {
    x265_picture in = opened_.blank;
    in.sliceType = idr ? X265_TYPE_IDR : X265_TYPE_P;
    in.pts = next_++;
    for (std::size_t i = 0; i < picture.format.planes(); ++i) {
      // x265 only reads the planes.
      in.planes[i] = const_cast<std::byte*>(picture.plane(i).data());
      in.stride[i] = static_cast<int>(picture.format.row_bytes());
    }
    return api_->encoder_encode(opened_.encoder.get(), &units, &count, &in, nullptr) == 1;
  }

  const x265_api* api_;
  Opened opened_;
  Picture last_;  // a blank last picture
  std::int64_t next_ = 0;
};

}  // namespace

Result<std::unique_ptr<PictureEncoder>> open_x265(const PictureFormat& format,
                                                  const CoderSettings& settings) {
  const x265_api* api = api_of(format.bit_depth);
  if (api == nullptr) return Status::backend_unavailable;
  auto opened = open(api, format, settings);
  if (!opened) return opened.status();
  return std::unique_ptr<PictureEncoder>(
      std::make_unique<X265Encoder>(api, format, std::move(*opened)));
}

}  // namespace gicodec::hevc
