// Which planes hold nothing but multiples: values of fewer bits than their format has, or rounded
// to a grid.
#pragma once

#include <gicodec/backend.h>

#include "base/memory.h"
#include "native/planes/kernels.h"
#include "native/planes/planes.h"

#include <cstdint>

namespace gicodec::native {

/// Gives every plane the largest step of which all its values are multiples, as far as a sample of
/// the blocks lets one hope for any.
void find_steps(const EncodeJob& job, const Kernels& kernels, PlaneLayout& layout,
                Vector<std::uint16_t>& scratch);

}  // namespace gicodec::native
