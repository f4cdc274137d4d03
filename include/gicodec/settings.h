// Settings of an encoder's backend.
#pragma once

#include <gicodec/api.h>
#include <gicodec/isa.h>
#include <gicodec/threads.h>

#include <cstdint>
#include <string>

namespace GICODEC_API gicodec {

/// Each backend reads some of these, and refuses a value outside its range with invalid_settings.
struct BackendSettings {
  /// lz4: 1..12, LZ4HC from 3 on; zstd: 1..22; both also -64..-1, which are faster and larger, for
  /// lz4 its acceleration; 0: the backend's default.
  int level = 0;
  /// native: "turbo" for fast links, "fast" (the default) or "strong"; hevc: an x265 preset; empty:
  /// the backend's default, but for native at a Server, which then chooses for each client.
  std::string preset = {};
  /// native: most blocks per chunk, 1..4096. 0: chosen by the volume's size, the same for every
  /// update ("strong": up to 4096). A thread codes a chunk on its own: smaller chunks use more
  /// threads, larger ones take fewer bytes.
  std::uint32_t chunk = 0;
  bool difference = true;  ///< raw, lz4, zstd: updates code differences to the mirror
  /// Threads per update. hevc: 1..64, for FFmpeg's encoders; x265 uses one.
  Threads threads = {};
  Isa isa = best_isa();  ///< kernels, without effect on the bytes; the machine must have it
};

}  // namespace gicodec
