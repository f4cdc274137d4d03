// The distribution that codes given counts in least space.
#pragma once

#include "native/planes/tables.h"

namespace gicodec::native {

/// Counts of values by bin_of(). Of integer arithmetic alone: the same everywhere.
[[nodiscard]] Distribution fit_distribution(const std::uint32_t (&counts)[kBins]) noexcept;

}  // namespace gicodec::native
