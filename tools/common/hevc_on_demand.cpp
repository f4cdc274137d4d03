#include "hevc_on_demand.h"

#include "dump/error.h"
#include "modules/hevc.h"

namespace gicodec::tools {
namespace {

class DecoderOnDemand final : public BackendDecoder {
 public:
  DecoderOnDemand(const HevcSettings& settings, const TextureDesc& desc)
      : settings_(settings), desc_(desc) {}

  Status decode(const DecodeJob& job) override {
    if (decoder_ == nullptr) {
      auto decoder = make();
      // As for a backend that cannot code the texture.
      if (decoder.status() == Status::unsupported_format ||
          decoder.status() == Status::unsupported_shape) {
        return Status::backend_missing;
      }
      if (!decoder) return decoder.status();
      decoder_ = *std::move(decoder);
    }
    return decoder_->decode(job);
  }

 private:
  [[nodiscard]] Result<std::unique_ptr<BackendDecoder>> make() const {
    try {
      return hevc_module().make_backend(settings_)->make_decoder(desc_);
    } catch (const Error&) {
      return Status::backend_missing;  // load_backend() says why.
    }
  }

  HevcSettings settings_;
  TextureDesc desc_;
  std::unique_ptr<BackendDecoder> decoder_;
};

}  // namespace

Result<std::unique_ptr<BackendEncoder>> HevcOnDemand::make_encoder(
    const TextureDesc& desc, const BackendSettings& settings) const {
  return hevc_module().make_backend(settings_)->make_encoder(desc, settings);
}

Result<std::unique_ptr<BackendDecoder>> HevcOnDemand::make_decoder(const TextureDesc& desc) const {
  return std::unique_ptr<BackendDecoder>(std::make_unique<DecoderOnDemand>(settings_, desc));
}

}  // namespace gicodec::tools
