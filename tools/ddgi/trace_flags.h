// The command line of gi-trace.
#pragma once

#include "command_line/command_line.h"
#include "ddgi_volume.h"
#include "kinds/kind_flags.h"
#include "scene_source.h"

#include <gicodec/engines.h>

#include <string>
#include <vector>

namespace gicodec::ddgi {

struct TraceFlags {
  SceneFlags scene;
  kinds::KindFlags kind;
  std::string output, export_gltf, mode = "converged", rotation, encoding, sh = "none", layout,
                                   files;
  std::vector<std::string> formats, cores;  ///< "color=R16G16B16A16_SFLOAT"
  std::uint32_t frames = 64, warmup = 32, view_samples = 0;
  double start = 0, fps = 10;
  TraceOptions trace;
  const EngineLayout* engine = nullptr;  ///< that of `layout`
  unsigned threads = 0;
  bool quiet = false, overwrite = false, resume = false, list = false;
};

/// The kind of file that textures are written as unless told: exr, or gic for textures of other
/// blocks than probes.
[[nodiscard]] std::string usual_files(const TraceFlags& flags);

void add_flags(tools::Command& app, TraceFlags& flags);
/// Throws tools::Error of Exit::usage where flags of probes were given for another kind.
void check_kind(const tools::Command& app, const TraceFlags& flags);
/// Turns the names among the flags into TraceFlags::trace and `engine`, and settles `files`. Throws
/// tools::Error of Exit::usage.
void resolve(TraceFlags& flags);
/// All that the texels of frame N depend on, as JSON.
[[nodiscard]] std::string settings(const TraceFlags& flags, const VolumeShape& shape);

}  // namespace gicodec::ddgi
