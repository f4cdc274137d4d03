#include "native/kernels.h"

namespace gicodec::native {

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

}  // namespace gicodec::native
