#include "payload.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return gicodec::fuzz::fuzz_payload(gicodec::kBackendRaw, data, size);
}
