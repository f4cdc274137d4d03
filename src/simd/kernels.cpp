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
  static constexpr const Kernels* kByIsa[] = {
    &scalar::kKernels,
#if defined(__x86_64__)
    &sse4::kKernels,
    &avx2::kKernels,
    &avx512::kKernels,
#endif
  };
  return *kByIsa[static_cast<std::size_t>(isa)];
}

const Kernels& kernels() noexcept {
  static const Kernels& best = kernels(best_isa());
  return best;
}

}  // namespace gicodec
