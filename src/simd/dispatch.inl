// The tables of kernels of every instruction set, by Isa. Part of each room that has such tables:
// included in a namespace with a struct `Kernels`; every set's namespace within it has one object
// of that type. Isa is the only way to a table, so that sessions use the set that they were given.

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
