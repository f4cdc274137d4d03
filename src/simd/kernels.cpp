#include "simd/kernels.h"

namespace gicodec {

namespace scalar {
extern const Kernels kKernels;
}
#if defined(__x86_64__)
namespace sse4 {
extern const Kernels kKernels;
}
namespace avx2 {
extern const Kernels kKernels;
}
namespace avx512 {
extern const Kernels kKernels;
}
#endif

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

const Kernels& kernels() noexcept {
  static const Kernels& best = kernels(best_isa());
  return best;
}

}  // namespace gicodec
