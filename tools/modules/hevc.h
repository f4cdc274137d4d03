// What the module gicodec-hevc offers: the backend of gicodec::hevc.
#pragma once

#include "modules/module.h"

#include <gicodec/hevc.h>

#include <memory>

namespace gicodec::tools {

struct HevcModule {
  ModuleHead head;
  /// As HevcBackend::HevcBackend, make_encoder, make_decoder, encoder_in_use.
  std::unique_ptr<Backend> (*make_backend)(const HevcSettings& settings);
  Result<std::string> (*encoder_in_use)(const HevcSettings& settings, const TextureDesc& desc,
                                        const BackendSettings& backend);
};

/// Loaded at the first call; throws Error of Exit::internal if that fails.
[[nodiscard]] const HevcModule& hevc_module();

}  // namespace gicodec::tools
