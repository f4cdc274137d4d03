// A kind of light that the programs trace and draw.
#pragma once

#include "feed.h"
#include "settings.h"
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
  std::uint32_t seed = 1;                ///< of all random numbers
  unsigned threads = 0;                  ///< see ddgi::ThreadPool
  std::function<bool()> cancelled = {};  ///< see ddgi::ThreadPool
};

/// A scene and its tracer, which a feed keeps from frame to frame.
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
  std::span<const Setting> settings;  ///< of tracing
  std::span<const Setting> drawing;   ///< of drawing
  /// A feed that traces live. Frames depend only on request and times, not on the number of
  /// threads. Throws tools::Error.
  Feed (*trace)(TraceRequest request);
  /// Light of such a volume in a scene, which must outlive the light. Throws tools::Error of
  /// Exit::bad_input if they do not belong together.
  std::unique_ptr<VolumeLight> (*light)(const ddgi::RayScene& scene, const VolumeDesc& desc,
                                        const Settings& drawing);
  /// Largest memory of the light in bytes. `textures`: bytes of the textures, which do not count.
  std::uint64_t (*light_memory)(const VolumeDesc& desc, std::uint64_t textures);
  /// Blocks stand in the world, so that viewers need only some of them.
  bool culled = false;
  /// Settings are flags of their own: --NAME VALUE instead of --set NAME=VALUE.
  bool flags = false;
  /// The light depends on earlier updates, not only on the last.
  bool remembers = false;
};

}  // namespace gicodec::kinds
