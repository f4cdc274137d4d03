// The "native" backend: the library's own codec (docs/native.md).
#pragma once

#include <gicodec/backend.h>

namespace gicodec {

class NativeBackend final : public Backend {
 public:
  [[nodiscard]] std::uint8_t id() const override { return kBackendNative; }
  [[nodiscard]] std::string_view name() const override { return "native"; }
  [[nodiscard]] Result<std::unique_ptr<BackendEncoder>> make_encoder(
      const TextureDesc& desc, const BackendSettings& settings) const override;
  [[nodiscard]] Result<std::unique_ptr<BackendDecoder>> make_decoder(
      const TextureDesc& desc) const override;
};

}  // namespace gicodec
