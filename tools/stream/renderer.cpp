#include "renderer.h"

#include "clock.h"
#include "common/preview_picture.h"
#include "common/program.h"
#include "ddgi/picture.h"
#include "dump/dump.h"
#include "dump/error.h"

namespace gicodec::streaming {
namespace {

using tools::Exit;
using tools::fail;

/// A client's volume as a HeldVolume for lights.
class Held {
 public:
  explicit Held(const ClientVolume& volume, const kinds::HeldVolume* finer = nullptr)
      : volume_{volume.desc, volume.geometry, {}, finer} {
    for (const ClientTexture& texture : volume.textures) {
      auto& mask = received_.emplace_back();
      for (const std::uint64_t serial : texture.changed) mask.push_back(serial > 0 ? 1 : 0);
      textures_.push_back({texture.name, texture.desc, texture.texels, mask});
    }
    volume_.textures = textures_;
  }
  [[nodiscard]] const kinds::HeldVolume& volume() const { return volume_; }

 private:
  std::vector<std::vector<std::uint8_t>> received_;
  std::vector<kinds::HeldTexture> textures_;
  kinds::HeldVolume volume_;
};

}  // namespace

Renderer::Renderer(const ddgi::Scene* scene, const ddgi::RenderOptions& options, unsigned threads,
                   PictureFolder pictures, kinds::DrawingFlags drawing)
    : scene_(scene),
      options_(options),
      pictures_(std::move(pictures)),
      drawing_(std::move(drawing)),
      pool_(threads, tools::interrupted) {
  if (scene_ != nullptr) rays_ = std::make_unique<ddgi::RayScene>(*scene_);
}

Renderer::~Renderer() = default;

double Renderer::draw(const ClientFrame& frame, const ddgi::Camera& camera, std::uint32_t number) {
  if (scene_ != nullptr) return draw_scene(frame, camera, number);
  for (const ClientVolume& volume : frame.volumes) {
    for (const ClientTexture& texture : volume.textures) {
      tools::Dump dump{{}, texture.texels};
      dump.info.desc = texture.desc;
      const auto [path, existing] = pictures_.texture(volume.name, texture.name, number);
      tools::write_preview(path, dump, {}, existing);
    }
  }
  return 0;
}

double Renderer::draw_scene(const ClientFrame& frame, const ddgi::Camera& camera,
                            std::uint32_t number) {
  const auto [path, existing] = pictures_.frame(number);  // Before the work.
  const double start = now();
  if (frame.volumes.empty()) fail(Exit::bad_input, "the server has no volume");
  rays_->set_state(scene_->state_at(frame.time));
  const ClientVolume& first = frame.volumes.front();
  prepare_light(first);
  std::optional<Held> finer;
  if (frame.volumes.size() > 1 && frame.volumes[1].desc.kind == first.desc.kind)
    finer.emplace(frame.volumes[1]);
  light_->update(Held(first, finer ? &finer->volume() : nullptr).volume(), frame.time);
  const ddgi::Picture picture = render(*rays_, light_.get(), camera, options_, pool_);
  const double seconds = now() - start;
  ddgi::write_picture(path, picture, camera.exposure, existing);
  return seconds;
}

void Renderer::prepare_light(const ClientVolume& volume) {
  if (light_ && instance_ == volume.instance) return;
  const kinds::TracedKind* const row = kinds::find_traced_kind(volume.desc.kind);
  if (row == nullptr) {
    fail(Exit::bad_input,
         "volume {}: is of a kind that cannot be drawn with a scene; without --scene its "
         "textures are",
         volume.name);
  }
  light_ = kinds::make_light(*row, *rays_, volume.desc, drawing_);
  instance_ = volume.instance;
}

}  // namespace gicodec::streaming
