#include "simd/kernels.h"

namespace gicodec {
#include "simd/dispatch.inl"
}  // namespace gicodec
