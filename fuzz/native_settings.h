// The settings of native encoders that inputs choose.
#pragma once

#include "native/frame/payload.h"

#include <array>
#include <cstdint>

namespace gicodec::fuzz {

/// Bit 0: strong, else fast; bit 1: two threads; bit 3: turbo; bit 4: other forms are not tried;
/// bit 6: matches. Bits 4 to 7 choose the streams of tokens, too.
inline native::PayloadSettings native_settings(std::uint8_t flags) {
  native::PayloadSettings settings;
  if ((flags & 1) != 0) settings.chunk.preset = native::Preset::strong;
  settings.threads = 1 + (flags >> 1 & 1);
  if ((flags & 8) != 0) settings.chunk.preset = native::Preset::turbo;
  settings.chunk.others = (flags & 16) == 0;
  settings.chunk.streams = 4U << (flags >> 4) % 5;
  if ((flags & 64) != 0) settings.chunk.matches_within = 1U << 20;
  return settings;
}

/// Those that make continuous textures rows, what adapts, matches, and tokens.
inline constexpr std::array<std::uint8_t, 4> kChunkKinds{16, 17, 64, 24};

}  // namespace gicodec::fuzz
