#include "modules/hevc.h"

#include "modules/module.h"

namespace gicodec::tools {
namespace {

std::unique_ptr<Backend> make_backend(const HevcSettings& settings) {
  return std::make_unique<HevcBackend>(settings);
}

Result<std::string> encoder_in_use(const HevcSettings& settings, const TextureDesc& desc,
                                   const BackendSettings& backend) {
  return HevcBackend(settings).encoder_in_use(desc, backend);
}

}  // namespace

extern "C" GICODEC_MODULE_EXPORT const HevcModule gicodec_module;
const HevcModule gicodec_module{{"gicodec-hevc"}, make_backend, encoder_in_use};

}  // namespace gicodec::tools
