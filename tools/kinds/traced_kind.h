// A kind of payload that the programs trace and draw.
#pragma once

#include "settings.h"
#include "source.h"
#include "volume_light.h"

#include "ddgi/scene.h"

#include <functional>
#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace gicodec::kinds {

struct TraceRequest {
  ddgi::Scene scene;
  Settings settings;
  std::uint32_t seed = 1;                ///< of all that is random
  unsigned threads = 0;                  ///< as for ddgi::ThreadPool
  std::function<bool()> cancelled = {};  ///< likewise
};

/// A scene and what traces it: what a source keeps from frame to frame.
template <typename Server>
struct Tracer {
  ddgi::Scene scene;
  Server server;

  template <typename Options>
  Tracer(TraceRequest request, const Options& options)
      : scene(std::move(request.scene)),
        server(scene, options, request.threads, std::move(request.cancelled)) {}
};

struct TracedKind {
  std::string_view name;              ///< that of the library's Kind
  std::string_view summary;           ///< one line
  std::span<const Setting> settings;  ///< of what is traced
  std::span<const Setting> drawing;   ///< of how a client draws with it
  /// Traces live. Throws tools::Error. Its frames are the same for the same request and times,
  /// whatever the number of threads.
  Source (*trace)(TraceRequest request);
  /// Light of such a volume in a scene, which must outlive it. Throws tools::Error of
  /// Exit::bad_input where they do not belong together.
  std::unique_ptr<VolumeLight> (*light)(const ddgi::RayScene& scene, const VolumeDesc& desc,
                                        const Settings& drawing);
  /// Bytes that it takes besides the textures that it is shown, at most, by what these take.
  std::uint64_t (*light_memory)(const VolumeDesc& desc, std::uint64_t textures);
  /// Its blocks stand in the world, so that viewers need some of them only.
  bool culled = false;
  /// Its settings are flags of their own: --NAME VALUE rather than --set NAME=VALUE.
  bool flags = false;
  /// What its light shows depends on the updates before the last, too.
  bool remembers = false;
};

}  // namespace gicodec::kinds
