// Irradiance vector grids as a kind that is traced and drawn (Pacanowski et al.).
#pragma once

#include "vector_light.h"
#include "vector_server.h"

#include "kinds/traced_kind.h"

namespace gicodec::vectors {

extern const kinds::TracedKind kTracedVectors;

/// The box is the scene's, unless it is set.
[[nodiscard]] VectorOptions options_of(const kinds::Settings& settings, const ddgi::Scene& scene,
                                       std::uint32_t seed);

}  // namespace gicodec::vectors
