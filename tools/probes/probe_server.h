// Traces probes: a volume over the scene, and a finer one around a viewer.
#pragma once

#include "ddgi/ddgi_volume.h"
#include "ddgi/engine_textures.h"
#include "kinds/feed.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gicodec::probes {

struct FineVolume {
  Grid grid;
  float spacing = 0.5F;
};

struct ProbeOptions {
  ddgi::TraceOptions trace;
  std::uint32_t warmup = 32;             ///< noisy: updates before the first frame
  const EngineLayout* layout = nullptr;  ///< whose textures there are; nullptr: the tracer's own
  std::optional<FineVolume> fine;        ///< follows the first viewer, or else the scene's camera
};

class ProbeServer {
 public:
  /// Throws tools::Error.
  ProbeServer(ddgi::Scene scene, const ProbeOptions& options, unsigned threads,
              std::function<bool()> cancelled);

  [[nodiscard]] std::vector<kinds::FeedVolume> volumes() const;
  /// How many probes there are, and why they are black if they are.
  [[nodiscard]] std::vector<std::string> remarks() const;
  [[nodiscard]] kinds::FeedFrame next(const kinds::FeedRequest& request);

 private:
  kinds::FeedFrame::Volume trace_fine(const Position& eye, double time);
  void remark(const ddgi::UpdateStatistics& update, std::vector<std::string>& remarks);

  ProbeOptions options_;
  ddgi::Scene scene_;
  ddgi::ThreadPool pool_;
  ddgi::RayScene rays_;
  ddgi::DdgiVolume world_;
  std::optional<ddgi::EngineTextures> engine_;
  std::optional<VolumeGeometry> fine_geometry_;
  std::unique_ptr<ddgi::DdgiVolume> fine_;
  bool begun_ = false, still_bouncing_ = false;
};

}  // namespace gicodec::probes
