// Light of probes as a client holds them, and of a finer volume of probes where that reaches.
#pragma once

#include "ddgi/probe_field.h"
#include "kinds/volume_light.h"

#include <optional>

namespace gicodec::probes {

class ProbeVolumeLight final : public kinds::VolumeLight {
 public:
  /// Probes that were not received do not shine. Throws tools::Error of Exit::bad_input for a
  /// volume without irradiance and visibility.
  void update(const kinds::HeldVolume& volume, double time) override;
  [[nodiscard]] ddgi::Vec3 irradiance(const ddgi::SeenSurface& seen) const override;

 private:
  std::optional<ddgi::ProbeField> world_, fine_;
};

}  // namespace gicodec::probes
