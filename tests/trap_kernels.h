// Proof of which instruction set runs: kernels of a set are turned into traps. For processes that
// end soon, such as those of death tests.
#pragma once

#include <gicodec/isa.h>

#include "native/kernels.h"
#include "simd/kernels.h"

#include <sys/mman.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>

namespace gicodec::test {

/// Every function of a table of kernels ends the process with SIGTRAP from now on.
template <typename Kernels>
__attribute__((no_sanitize("thread")))  // which knows nothing of code being written
void trap_table(const Kernels& table) {
  constexpr unsigned char kTrap = 0xCC;  // int3
  unsigned char* functions[sizeof table / sizeof(unsigned char*)];
  std::memcpy(functions, &table, sizeof table);
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  for (unsigned char* function : functions) {
    const auto start = reinterpret_cast<std::uintptr_t>(function) / page * page;
    if (mprotect(reinterpret_cast<void*>(start), page, PROT_READ | PROT_WRITE | PROT_EXEC) != 0) {
      std::abort();
    }
    *const_cast<volatile unsigned char*>(function) = kTrap;
  }
}

/// Those of strip, reconstruct and the transforms.
inline void trap_texel_kernels(Isa isa) { trap_table(kernels(isa)); }
inline void trap_native_kernels(Isa isa) { trap_table(native::kernels(isa)); }
inline void trap_kernels(Isa isa) {
  trap_texel_kernels(isa);
  trap_native_kernels(isa);
}

}  // namespace gicodec::test
