// Messages: what is read can be written, and is read again as the same bytes.
#include "input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gicodec;
  fuzz::Exact bytes(std::as_bytes(std::span(data, size)));
  const auto message = read_message(bytes.span(), {.max_bytes = 1 << 20, .max_probes = 1 << 16});
  if (!message) return 0;
  Message written, again;
  fuzz::check(write_message(*message, written) == Status::ok, "what was read can be written");
  const auto second = read_message(written);
  fuzz::check(second.ok(), "what was written can be read");
  fuzz::check(write_message(*second, again) == Status::ok && again == written,
              "writing is the inverse of reading");
  return 0;
}
