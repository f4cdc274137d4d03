// The backend "hevc" as the tools use it: known by name at once, loaded when it has work.
#pragma once

#include <gicodec/hevc.h>

namespace gicodec::tools {

/// make_encoder() loads the module at once, decoders with their first packet. A module that cannot
/// be loaded is an Error of hevc_module(), so call that first; to decoders it is backend_missing.
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
