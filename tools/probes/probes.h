// Probes as a kind that is traced and drawn (Majercik et al., Stengel et al.).
#pragma once

#include "probe_server.h"

#include "kinds/traced_kind.h"

namespace gicodec::probes {

extern const kinds::TracedKind kTracedProbes;

/// Throws tools::Error of Exit::usage.
[[nodiscard]] ProbeOptions options_of(const kinds::Settings& settings, std::uint32_t seed);

}  // namespace gicodec::probes
