// Feed: volumes frame after frame, traced or played, to stream or to write to containers.
#pragma once

#include "dump/dump.h"

#include <gicodec/kind.h>
#include <gicodec/probes.h>
#include <gicodec/protocol.h>
#include <gicodec/volume.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace gicodec::kinds {

struct FeedVolume {
  std::string name;
  VolumeGeometry geometry;
  VolumeDesc desc;
  std::vector<float> errors = {};  ///< by texture, StreamedTexture::source_error; or empty
  /// By texture, the quantiser of HEVC that codes it in containers, negative: lossless; or empty.
  std::vector<int> quantisers = {};
  /// By texture, the attributes of dumps besides scene and time; or empty.
  std::vector<tools::DumpInfo> files = {};
  std::string layout = {};  ///< EngineLayout::name, or empty
  std::optional<std::array<double, 6>> bounds =
      {};  ///< that it lights, if its geometry does not say it
};

[[nodiscard]] inline bool is_probes(const FeedVolume& volume) {
  return volume.desc.kind == kKindProbes;
}

struct FeedRequest {
  double time = 0;                      ///< of the scene, seconds
  std::vector<Viewpoint> viewers = {};  ///< camera-locked volumes follow the first
  bool all = false;                     ///< a client wants everything, whatever the viewers
};

struct FeedFrame {
  struct Volume {
    Scroll scroll{};
    BlockMask active;                              ///< of the first group; empty: all are
    std::vector<std::vector<std::byte>> textures;  ///< tightly packed
  };
  double time = 0;     ///< of the scene, seconds
  double seconds = 0;  ///< of work
  std::vector<Volume> volumes;
  std::vector<std::string> remarks = {};  ///< for the operator
  std::uint64_t rays = 0;                 ///< traced for it, if counted
};

struct Feed {
  std::vector<FeedVolume> volumes;
  SceneId scene;                                      ///< that was traced, if known
  bool played = false;                                ///< frames have a fixed order
  std::function<FeedFrame(const FeedRequest&)> next;  ///< throws tools::Error
  std::vector<std::string> remarks = {};              ///< for the operator at the start
};

/// A feed of one volume. `trace` fills in the textures and remarks of each frame.
[[nodiscard]] inline Feed live_feed(std::string name, VolumeDesc desc,
                                    std::function<void(const FeedRequest&, FeedFrame&)> trace) {
  Feed feed;
  VolumeGeometry geometry;
  geometry.grid = desc.groups.front().textures.front().desc.grid;
  feed.volumes.push_back({std::move(name), geometry, std::move(desc)});
  feed.next = [trace = std::move(trace)](const FeedRequest& request) {
    const auto start = std::chrono::steady_clock::now();
    FeedFrame frame;
    frame.time = request.time;
    frame.volumes.resize(1);
    trace(request, frame);
    frame.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return frame;
  };
  return feed;
}

}  // namespace gicodec::kinds
