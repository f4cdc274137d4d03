// Photons as a kind that the programs trace and draw.
#pragma once

#include "batch_pool.h"

#include "kinds/traced_kind.h"

namespace gicodec::photons {

extern const kinds::TracedKind kTracedPhotons;

/// TracedKind::trace and TracedKind::light.
[[nodiscard]] kinds::Feed trace(kinds::TraceRequest request);
[[nodiscard]] std::unique_ptr<kinds::VolumeLight> light(const ddgi::RayScene& scene,
                                                        const VolumeDesc& desc);

}  // namespace gicodec::photons
