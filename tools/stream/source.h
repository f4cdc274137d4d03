// What a server shows: volumes, frame after frame, traced or played.
#pragma once

#include "ddgi/ddgi_volume.h"
#include "ddgi/scene_source.h"

#include <gicodec/isa.h>
#include <gicodec/kind.h>
#include <gicodec/protocol.h>
#include <gicodec/volume.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace gicodec::streaming {

struct SourceVolume {
  std::string name;
  VolumeGeometry geometry;
  VolumeDesc desc;
  std::vector<float> errors = {};  ///< by texture, StreamedTexture::source_error; or none at all

  /// Of all sets.
  [[nodiscard]] std::vector<NamedTexture> textures() const {
    std::vector<NamedTexture> all;
    for (const BlockSet& set : desc.sets) {
      all.insert(all.end(), set.textures.begin(), set.textures.end());
    }
    return all;
  }
};

struct SourceRequest {
  double time = 0;                 ///< of the scene, seconds
  std::optional<Position> viewer;  ///< whom camera-locked volumes follow
};

struct SourceFrame {
  struct Volume {
    Scroll scroll{};
    BlockMask active;                              ///< of the first set
    std::vector<std::vector<std::byte>> textures;  ///< tightly packed
  };
  double time = 0;     ///< that it shows
  double seconds = 0;  ///< that it took
  std::vector<Volume> volumes;
  std::vector<std::string> remarks = {};  ///< for the operator
};

struct Source {
  std::vector<SourceVolume> volumes;
  SceneId scene;                                          ///< where it was traced, if known
  bool played = false;                                    ///< frames have an order of their own
  std::function<SourceFrame(const SourceRequest&)> next;  ///< throws tools::Error
  std::vector<std::string> remarks = {};                  ///< for the operator, when it begins
};

struct FineVolume {
  Grid grid;
  float spacing = 0.5F;
};

/// Traces a scene live: volume "world" as the flags say and, if asked for, "fine" around the
/// viewer or else the scene's camera. `threads` as for ddgi::ThreadPool.
[[nodiscard]] Source trace_source(const ddgi::SceneFlags& scene, const ddgi::TraceOptions& options,
                                  const std::optional<FineVolume>& fine, unsigned threads);

struct PlayOptions {
  bool loop = false;              ///< begin again after the last frame, else stay there
  double rate = 10;               ///< of frames that do not say their time
  bool allow_incomplete = false;  ///< play the whole frames before a cut or damage
  Isa isa = best_isa();
};

/// Plays a container, or dumps of a folder, which is looked through first. Throws tools::Error of
/// Exit::bad_input where something is missing or damaged, unless that is allowed.
[[nodiscard]] Source play_source(const std::string& path, const PlayOptions& options);

}  // namespace gicodec::streaming
