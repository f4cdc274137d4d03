// What gi-trace writes of each frame: a file for each texture, or all frames in one container.
#pragma once

#include "ddgi_volume.h"
#include "dump_folder.h"
#include "engine_textures.h"
#include "trace_flags.h"
#include "volume_container.h"

#include <optional>
#include <string>
#include <vector>

namespace gicodec::ddgi {

/// The dumps that the flags ask for; `engine`: nullptr for the tracer's own textures. Throws
/// tools::Error of Exit::usage for a texture that such files cannot hold.
[[nodiscard]] FrameFiles files_of(const TraceFlags& flags, const EngineTextures* engine);

class TraceOutput {
 public:
  /// All of these must outlive it.
  TraceOutput(const TraceFlags& flags, const DdgiVolume& volume, EngineTextures* engine,
              DumpFolder& folder);

  /// The frame that was just traced.
  void write(std::uint32_t frame, double time);
  /// Whether frames are there as soon as they are traced.
  [[nodiscard]] bool writes_frames() const { return !container_; }
  /// What has all frames.
  void finish();

 private:
  [[nodiscard]] std::vector<FrameTexture> current() const;

  const DdgiVolume& volume_;
  EngineTextures* engine_;
  DumpFolder& folder_;
  std::optional<VolumeContainer> container_;
};

}  // namespace gicodec::ddgi
