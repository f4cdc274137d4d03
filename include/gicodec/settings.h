// What encoders are told about their backend.
#pragma once

#include <gicodec/api.h>
#include <gicodec/isa.h>
#include <gicodec/threads.h>

#include <cstdint>
#include <string>

namespace GICODEC_API gicodec {

/// Settings common to all encoders; each backend says which it reads and refuses values outside
/// its range with Status::invalid_settings.
struct BackendSettings {
  int level = 0;  ///< lz4: 1..12, above 2 is LZ4HC; zstd: 1..22; 0 is the backend's default
  /// native: "fast" (the default) or "strong"; hevc: x265 preset; empty is the backend's default
  std::string preset = {};
  /// native: blocks per chunk at most, 1..4096; 0: by the size of the volume ("strong": up to
  /// 4096), alike for every update. Chunks are coded on their own, each by one thread: smaller ones
  /// use more threads, larger ones take fewer bytes.
  std::uint32_t chunk = 0;
  bool difference = true;  ///< raw, lz4, zstd: code differences to the mirror in updates
  /// Per update; hevc: 1..64, those of an encoder of FFmpeg's, x265 keeps to one.
  Threads threads = {};
  Isa isa = best_isa();  ///< every kernel, with no influence on the bytes; the machine must have it
};

}  // namespace gicodec
