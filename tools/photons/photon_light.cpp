// Light of photons, drawn.
#include "photons.h"
#include "splatting.h"

#include <optional>

namespace gicodec::photons {
namespace {

class PhotonLight final : public kinds::VolumeLight {
 public:
  explicit PhotonLight(const VolumeDesc& desc) : held_(desc) {}

  void update(const kinds::HeldVolume& volume, double /*time*/) override { held_.update(volume); }
  void prepare(const ddgi::RayScene& scene, const ddgi::PictureView& view,
               ddgi::ThreadPool& pool) override {
    picture_.emplace(scene, view, held_.batches(), pool);
  }
  [[nodiscard]] ddgi::Vec3 irradiance(const ddgi::SeenSurface& seen) const override {
    return picture_ ? picture_->irradiance(seen) / ddgi::kPi : ddgi::Vec3{};
  }

 private:
  HeldPhotons held_;
  std::optional<SplatPicture> picture_;
};

}  // namespace

std::unique_ptr<kinds::VolumeLight> light(const ddgi::RayScene& /*scene*/, const VolumeDesc& desc) {
  return std::make_unique<PhotonLight>(desc);
}

}  // namespace gicodec::photons
