// Pictures of a client's frames: the lit scene, or the textures if no scene is known.
#pragma once

#include "ddgi/client_renderer.h"
#include "picture_folder.h"
#include "programs/kind_table.h"

#include <gicodec/client.h>

#include <string>

namespace gicodec::streaming {

class Renderer {
 public:
  /// `scene` may be nullptr; it must outlive the renderer. `drawing`: how light is drawn.
  Renderer(const ddgi::Scene* scene, const ddgi::RenderOptions& options, unsigned threads,
           PictureFolder pictures, kinds::DrawingFlags drawing);
  ~Renderer();

  /// Draws one picture, or one per texture. Returns the seconds of drawing, without writing files.
  /// Throws tools::Error (Exit::bad_input if the first volume cannot be drawn), and ddgi::Cancelled
  /// after an interrupt; then there is no file.
  double draw(const ClientFrame& frame, const ddgi::Camera& camera, std::uint32_t number);

 private:
  double draw_scene(const ClientFrame& frame, const ddgi::Camera& camera, std::uint32_t number);
  /// Makes the light of the volume, unless there is one.
  void prepare_light(const ClientVolume& volume);

  const ddgi::Scene* scene_;
  ddgi::RenderOptions options_;
  PictureFolder pictures_;
  kinds::DrawingFlags drawing_;
  ddgi::ThreadPool pool_;
  std::unique_ptr<ddgi::RayScene> rays_;
  std::unique_ptr<kinds::VolumeLight> light_;
  std::uint64_t instance_ = 0;  ///< of the light's volume
};

}  // namespace gicodec::streaming
