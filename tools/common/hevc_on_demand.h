// The backend "hevc" of the tools: its name is always known, its module loads when it is needed.
#pragma once

#include <gicodec/hevc.h>

namespace gicodec::tools {

/// make_encoder() loads the module, decoders load it with their first packet. If it cannot be
/// loaded, hevc_module() throws Error, so call that before make_encoder(); decoders answer
/// backend_missing.
class HevcOnDemand final : public Backend {
 public:
  HevcOnDemand() = default;
  explicit HevcOnDemand(HevcSettings settings) : settings_(std::move(settings)) {}

  std::uint8_t id() const override { return kBackendHevc; }
  std::string_view name() const override { return "hevc"; }
  Result<std::unique_ptr<BackendEncoder>> make_encoder(
      const TextureDesc& desc, const BackendSettings& settings) const override;
  Result<std::unique_ptr<BackendDecoder>> make_decoder(const TextureDesc& desc) const override;

 private:
  HevcSettings settings_;
};

}  // namespace gicodec::tools
