// From an instruction set to code: kernels<Table>(isa) is the only way.
// The loops of a stage are in a source of its room, which is compiled once per instruction set with
// GICODEC_ISA as the set's name (src/CMakeLists.txt lists the sources, cmake/Kernels.cmake the
// sets). The source ends with the stage's table, a struct of pointers to its loops. All else in it
// has internal linkage: the linker could otherwise take an inline function from it for other code,
// which would then run on a machine without the instruction set. All sets give the same bits.
#pragma once

#include <gicodec/isa.h>

namespace gicodec {

/// The table of one stage, compiled for one set.
template <typename Table, Isa isa>
struct TableOf {
  static const Table kernels;
};

template <typename Table, Isa... built>
const Table* find_table(Isa isa) noexcept {
#if defined(__clang__)
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wundefined-var-template"  // Other sources define them.
#endif
  const Table* found = nullptr;
  ((found = built == isa ? &TableOf<Table, built>::kernels : found), ...);
  return found;
#if defined(__clang__)
#pragma clang diagnostic pop
#endif
}

/// Precondition: is_supported(isa).
template <typename Table>
[[nodiscard]] const Table& kernels(Isa isa) noexcept {
  using enum Isa;
  return *find_table<Table, GICODEC_ISAS>(isa);
}

}  // namespace gicodec
