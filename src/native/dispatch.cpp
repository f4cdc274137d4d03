#include "native/kernels.h"

namespace gicodec::native {

const Kernels& kernels(Isa isa) noexcept {
  switch (isa) {
#if defined(__x86_64__)
    case Isa::sse4:
      return sse4::kKernels;
    case Isa::avx2:
      return avx2::kKernels;
    case Isa::avx512:
      return avx512::kKernels;
#endif
    default:
      return scalar::kKernels;
  }
}

}  // namespace gicodec::native
