// Messages: what is read can be written, and is read again as the same bytes.
#include "cost.h"

#include <gicodec/protocol.h>

#include <optional>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gicodec;
  fuzz::Exact bytes(std::as_bytes(std::span(data, size)));
  constexpr MessageLimits kLimits{.max_bytes = 1 << 20, .max_blocks = 1 << 16};
  // Items of lists take up to eight times their least bytes, a list of blocks that grows and its
  // mask ten bytes per block.
  const bool mask = fuzz::is_subscribe(bytes.span());
  const std::size_t allowed = 16 * size + 4096 + (mask ? 10 * std::size_t{kLimits.max_blocks} : 0);
  std::optional<Result<AnyMessage>> read;
  fuzz::check_cost("a message costs what it is worth", [&]() -> fuzz::Allowance {
    read.emplace(read_message(bytes.span(), kLimits));
    return {allowed, 2 * allowed};
  });
  const auto& message = *read;
  if (!message) return 0;
  Message written, again;
  fuzz::check(write_message(*message, written) == Status::ok, "what was read can be written");
  const auto second = read_message(written);
  fuzz::check(second.ok(), "what was written can be read");
  fuzz::check(write_message(*second, again) == Status::ok && again == written,
              "writing is the inverse of reading");
  return 0;
}
