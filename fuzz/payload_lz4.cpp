#include "payload.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return gicodec::fuzz::fuzz_payload(gicodec::kBackendLz4, data, size);
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  return gicodec::fuzz::mutate_payloads(data, size, max_size, seed);
}
