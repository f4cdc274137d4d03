// Light of probes, and of a finer volume of probes where that reaches.
#pragma once

#include "client_light.h"
#include "probe_field.h"

namespace gicodec::ddgi {

class ProbeClientLight final : public ClientLight {
 public:
  /// `field`, and `fine` unless it is nullptr, must outlive it.
  explicit ProbeClientLight(const ProbeField& field, const ProbeField* fine = nullptr)
      : field_(field), fine_(fine) {}

  [[nodiscard]] Vec3 irradiance(const SeenSurface& seen) const override;

 private:
  const ProbeField& field_;
  const ProbeField* fine_;
};

}  // namespace gicodec::ddgi
