// Which instruction sets this machine can run.
#include "native/kernels.h"

#include <cstring>

namespace gicodec::native {
namespace {

KernelList detect() noexcept {
  KernelList list{{&scalar::kKernels}, 1};
#if defined(GICODEC_NATIVE_X86)
  __builtin_cpu_init();
  if (!__builtin_cpu_supports("sse4.1") || !__builtin_cpu_supports("popcnt")) return list;
  list.entry[list.count++] = &sse41::kKernels;
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("bmi") ||
      !__builtin_cpu_supports("bmi2")) {
    return list;
  }
  list.entry[list.count++] = &avx2::kKernels;
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512cd")) {
    list.entry[list.count++] = &avx512::kKernels;
  }
#endif
  return list;
}

}  // namespace

const KernelList& available_kernels() noexcept {
  static const KernelList list = detect();
  return list;
}

const Kernels* find_kernels(const char* name) noexcept {
  const KernelList& list = available_kernels();
  if (name == nullptr || *name == '\0') return list.entry[list.count - 1];
  for (unsigned i = 0; i < list.count; ++i) {
    if (std::strcmp(list.entry[i]->name, name) == 0) return list.entry[i];
  }
  return nullptr;
}

}  // namespace gicodec::native
