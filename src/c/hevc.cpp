// The HEVC backend for the C interface.
#include "c/calls.h"

#include <gicodec/c/hevc.h>
#include <gicodec/hevc.h>

#include <utility>

using namespace gicodec;

namespace gicodec::c {
namespace {

/// With the backend that it names.
struct OwnedBackend : gicodec_backend {
  explicit OwnedBackend(HevcSettings settings) : hevc(std::move(settings)) { backend = &hevc; }
  HevcBackend hevc;
};

}  // namespace
}  // namespace gicodec::c

extern "C" {

gicodec_status gicodec_hevc_create(const gicodec_hevc_options* options, gicodec_backend** out) {
  if (out == nullptr) return GICODEC_INVALID_ARGUMENT;
  *out = nullptr;
  gicodec_hevc_options given;
  if (const Status status = c::take(options, given); status != Status::ok) {
    return c::number(status);
  }
  if (given.packing > static_cast<uint32_t>(HevcPacking::luma) ||
      given.layout > static_cast<uint32_t>(HevcLayout::packed)) {
    return GICODEC_INVALID_SETTINGS;
  }
  return c::call([&] {
    HevcSettings settings;
    settings.packing = static_cast<HevcPacking>(given.packing);
    settings.layout = static_cast<HevcLayout>(given.layout);
    settings.encoder = c::text(given.encoder, settings.encoder);
    settings.decoder = c::text(given.decoder, settings.decoder);
    if (given.decoder_threads != 0) settings.decoder_threads = given.decoder_threads;
    if (given.lossy != 0) settings.lossy_qp = static_cast<int>(std::min(given.quantiser, 255U));
    *out = new c::OwnedBackend(std::move(settings));
    return Status::ok;
  });
}

void gicodec_hevc_destroy(gicodec_backend* backend) {
  delete static_cast<c::OwnedBackend*>(backend);
}

}  // extern "C"
