// Pictures of what a client holds: the lit scene, or the textures where no scene is known.
#pragma once

#include "ddgi/client_renderer.h"
#include "ddgi/probe_field.h"
#include "picture_folder.h"

#include <gicodec/client.h>

#include <string>

namespace gicodec::streaming {

class Painter {
 public:
  /// `scene` may be nullptr, must outlive it.
  Painter(const ddgi::Scene* scene, const ddgi::RenderOptions& options, unsigned threads,
          PictureFolder pictures);
  ~Painter();

  /// One picture, or one of each texture. Returns the seconds that drawing took, files not counted.
  /// Throws tools::Error, of Exit::bad_input where the textures are no irradiance volume, and
  /// ddgi::Cancelled after an interrupt, without a file.
  double draw(const ClientFrame& frame, const ddgi::Camera& camera, std::uint32_t number);

 private:
  double draw_scene(const ClientFrame& frame, const ddgi::Camera& camera, std::uint32_t number);

  const ddgi::Scene* scene_;
  ddgi::RenderOptions options_;
  PictureFolder pictures_;
  ddgi::ThreadPool pool_;
  std::unique_ptr<ddgi::RayScene> rays_;
};

/// Light from a volume as it stands in the world; probes that were not received do not shine.
/// Throws tools::Error of Exit::bad_input for a volume without irradiance and visibility.
[[nodiscard]] ddgi::ProbeField probe_field(const ClientVolume& volume);

}  // namespace gicodec::streaming
