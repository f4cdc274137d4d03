// Proof of which instruction set runs: kernels of a set are turned into traps. For processes that
// end soon, such as those of death tests.
#pragma once

#include <gicodec/isa.h>

#include "native/planes/kernels.h"
#include "texture/block_kernels.h"
#include "transform/byte_plane_kernels.h"
#include "transform/yuv444_kernels.h"

#if (defined(__x86_64__) || defined(__aarch64__)) && !defined(_WIN32)
#define GICODEC_TRAPS  // There are such instructions, and memory that holds code can be written.

#include <sys/mman.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <type_traits>

namespace gicodec::test {

#if defined(__x86_64__)
inline constexpr std::uint8_t kTrap = 0xCC;  // int3
#else
inline constexpr std::uint32_t kTrap = 0xD4200000;  // brk #0
#endif

/// Every function of a table of kernels ends the process with SIGTRAP from now on.
template <typename Table>
__attribute__((no_sanitize("thread")))  // which knows nothing of code being written
void trap_table(const Table& table) {
  char* functions[sizeof table / sizeof(char*)];
  std::memcpy(functions, &table, sizeof table);
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  for (char* function : functions) {
    const auto start = reinterpret_cast<std::uintptr_t>(function) / page * page;
    if (mprotect(reinterpret_cast<void*>(start), page, PROT_READ | PROT_WRITE | PROT_EXEC) != 0) {
      std::abort();
    }
    *reinterpret_cast<volatile std::remove_const_t<decltype(kTrap)>*>(function) = kTrap;
    __builtin___clear_cache(function, function + sizeof kTrap);
  }
}

/// Those of strip, reconstruct and the transforms.
inline void trap_texel_kernels(Isa isa) {
  trap_table(kernels<BlockKernels>(isa));
  trap_table(kernels<Yuv444Kernels>(isa));
  trap_table(kernels<BytePlaneKernels>(isa));
}
inline void trap_native_kernels(Isa isa) { trap_table(kernels<native::Kernels>(isa)); }
inline void trap_kernels(Isa isa) {
  trap_texel_kernels(isa);
  trap_native_kernels(isa);
}

}  // namespace gicodec::test
#endif
