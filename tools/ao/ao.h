// AO points (Neff et al.) as a kind that the programs trace and draw.
#pragma once

#include "kinds/traced_kind.h"

namespace gicodec::ao {

extern const kinds::TracedKind kTracedAoPoints;

}  // namespace gicodec::ao
