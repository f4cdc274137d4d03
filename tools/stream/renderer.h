// Pictures of what a client holds: the lit scene, or the textures where no scene is known.
#pragma once

#include "ddgi/client_renderer.h"
#include "picture_folder.h"
#include "programs/kind_table.h"

#include <gicodec/client.h>

#include <string>

namespace gicodec::streaming {

class Renderer {
 public:
  /// `scene` may be nullptr, must outlive it. `drawing`: how light is drawn with.
  Renderer(const ddgi::Scene* scene, const ddgi::RenderOptions& options, unsigned threads,
           PictureFolder pictures, kinds::DrawingFlags drawing);
  ~Renderer();

  /// One picture, or one of each texture. Returns the seconds that drawing took, files not counted.
  /// Throws tools::Error, of Exit::bad_input where the first volume cannot be drawn, and
  /// ddgi::Cancelled after an interrupt, without a file.
  double draw(const ClientFrame& frame, const ddgi::Camera& camera, std::uint32_t number);

 private:
  double draw_scene(const ClientFrame& frame, const ddgi::Camera& camera, std::uint32_t number);
  /// That of the volume, if it is another than before.
  void prepare_light(const ClientVolume& volume);

  const ddgi::Scene* scene_;
  ddgi::RenderOptions options_;
  PictureFolder pictures_;
  kinds::DrawingFlags drawing_;
  ddgi::ThreadPool pool_;
  std::unique_ptr<ddgi::RayScene> rays_;
  std::unique_ptr<kinds::VolumeLight> light_;
  std::uint64_t instance_ = 0;  ///< of the volume that it is of
};

}  // namespace gicodec::streaming
