// What decoders hold at their worst and what packets have them do, in bytes: what limits are
// compared with.
#pragma once

#include <gicodec/packet.h>
#include <gicodec/texture.h>

#include "texture/guard_band.h"

#include <algorithm>
#include <cstdint>

namespace gicodec {

/// By a decoder between two packets: the mirror's cores, rings and marks, and the probes updated.
[[nodiscard]] inline std::uint64_t held_memory(const TextureDesc& desc) noexcept {
  constexpr std::uint64_t kFixed = 1024, kProbe = 1 + 4;
  return kFixed + probe_count(desc) * (core_bytes(desc) + ring_bytes(desc) + kProbe);
}

/// By the scratch that decoders share, for the largest of their textures. Per probe: the cores of
/// a packet, planes and reference of a byte backend; rings and their probes; lists of probes, of
/// which cutting chunks takes five. Per thread: a native chunk's blocks and the mirror's as words,
/// and lanes.
[[nodiscard]] inline std::uint64_t scratch_memory(const TextureDesc& desc,
                                                  unsigned threads) noexcept {
  constexpr std::uint64_t kFixed = 256 << 10, kFixedOfThread = 2 << 20, kProbe = 40;
  constexpr std::uint64_t kChunkProbes = 4096, kLaneBlocks = 1280;
  const std::uint64_t probes = probe_count(desc), core = core_bytes(desc);
  const std::uint64_t of_thread =
      (4 * std::min(probes, kChunkProbes) + kLaneBlocks) * core + kFixedOfThread;
  return kFixed + probes * (3 * core + ring_bytes(desc) + kProbe) + threads * of_thread;
}

/// Work: the blocks that a packet writes or, as a keyframe, clears.
[[nodiscard]] inline std::uint64_t packet_work(const TextureDesc& desc,
                                               const PacketInfo& info) noexcept {
  const std::uint64_t all = probe_count(desc);
  const std::uint64_t written = info.all_probes ? all : std::min<std::uint64_t>(info.probes, all);
  return (written + (info.keyframe ? all : 0)) * (core_bytes(desc) + ring_bytes(desc));
}

}  // namespace gicodec
