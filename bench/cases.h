// Backends and presets that are compared, and what they are compared on.
#pragma once

#include "dumps.h"

#include <gicodec/gicodec.h>

#include <chrono>
#include <string>
#include <vector>

namespace gicodec::bench {

struct Case {
  std::string label, backend, preset;
  int level = 0;
  const Backend* object = nullptr;  ///< where not built in
  bool slow = false;                ///< left out by --quick
  bool difference = true;           ///< raw: to the mirror
  Isa isa = best_isa();
};
[[nodiscard]] std::vector<Case> cases(Isa isa);

[[nodiscard]] Encoder make_encoder(const TextureDesc& desc, const Case& c, unsigned threads = 1);
[[nodiscard]] Decoder make_decoder(const TextureDesc& desc, const Case& c, unsigned threads = 1);
/// By the clock.
using Clock = std::chrono::steady_clock;
[[nodiscard]] inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}
/// Why a backend does not code a texture; empty if it does.
[[nodiscard]] std::string refusal(const TextureDesc& desc, const Case& c);

}  // namespace gicodec::bench
