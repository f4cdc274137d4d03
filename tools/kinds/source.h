// What is streamed and written to containers: volumes, frame after frame, traced or played.
#pragma once

#include "dump/dump.h"

#include <gicodec/kind.h>
#include <gicodec/probes.h>
#include <gicodec/protocol.h>
#include <gicodec/volume.h>
#include <gicodec/voxels.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace gicodec::kinds {

struct SourceVolume {
  std::string name;
  VolumeGeometry geometry;
  VolumeDesc desc;
  std::vector<float> errors = {};  ///< by texture, StreamedTexture::source_error; or none at all
  /// By texture, the quantiser of HEVC that codes it in containers, negative: it stays lossless; or
  /// none at all.
  std::vector<int> quantisers = {};
  /// By texture, what dumps of it say besides scene and time; or none at all.
  std::vector<tools::DumpInfo> files = {};

  /// Of all groups.
  [[nodiscard]] std::vector<NamedTexture> textures() const {
    std::vector<NamedTexture> all;
    for (const TextureGroup& group : desc.groups) {
      all.insert(all.end(), group.textures.begin(), group.textures.end());
    }
    return all;
  }
};

[[nodiscard]] inline bool is_probes(const SourceVolume& volume) {
  return volume.desc.kind == kKindProbes;
}

struct SourceRequest {
  double time = 0;                      ///< of the scene, seconds
  std::vector<Viewpoint> viewers = {};  ///< camera-locked volumes follow the first
  bool all = false;                     ///< somebody wants everything, wherever viewers look
};

struct SourceFrame {
  struct Volume {
    Scroll scroll{};
    BlockMask active;                              ///< of the first group; empty: all are
    std::vector<std::vector<std::byte>> textures;  ///< tightly packed
  };
  double time = 0;     ///< that it shows
  double seconds = 0;  ///< that it took
  std::vector<Volume> volumes;
  std::vector<std::string> remarks = {};  ///< for the operator
  std::uint64_t rays = 0;                 ///< that it took, if they were counted
};

struct Source {
  std::vector<SourceVolume> volumes;
  SceneId scene;                                          ///< where it was traced, if known
  bool played = false;                                    ///< frames have an order of their own
  std::function<SourceFrame(const SourceRequest&)> next;  ///< throws tools::Error
  std::vector<std::string> remarks = {};                  ///< for the operator, when it begins
};

/// A source of one volume, which `trace` fills in: its textures, and remarks.
[[nodiscard]] inline Source live_source(
    std::string name, VolumeDesc desc,
    std::function<void(const SourceRequest&, SourceFrame&)> trace) {
  Source source;
  VolumeGeometry geometry;
  geometry.grid = desc.groups.front().textures.front().desc.grid;
  source.volumes.push_back({std::move(name), geometry, std::move(desc)});
  source.next = [trace = std::move(trace)](const SourceRequest& request) {
    const auto start = std::chrono::steady_clock::now();
    SourceFrame frame;
    frame.time = request.time;
    frame.volumes.resize(1);
    trace(request, frame);
    frame.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return frame;
  };
  return source;
}

}  // namespace gicodec::kinds
