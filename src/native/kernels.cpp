#include "native/kernels.h"

namespace gicodec::native {
#include "simd/dispatch.inl"
}  // namespace gicodec::native
