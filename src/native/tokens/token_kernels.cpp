// The kernels of one instruction set (simd/dispatch.h).
#include "native/tokens/token_kernels.h"

#include "base/parts.h"
#include "simd/intrinsics.h"

#include <bit>
#include <cstring>

namespace gicodec::native::GICODEC_ISA {
namespace {

#include GICODEC_VECTORS

#include "simd/memory.inl"

#include "native/tokens/differences.inl"
#include "native/tokens/read_tokens.inl"
#include "native/tokens/write_tokens.inl"

constexpr TokenKernels kKernels{kEncodes ? write_tokens : nullptr, read_tokens};

}  // namespace
}  // namespace gicodec::native::GICODEC_ISA

namespace gicodec {
template <>
constinit const native::TokenKernels TableOf<native::TokenKernels, Isa::GICODEC_ISA>::kernels =
    native::GICODEC_ISA::kKernels;
}  // namespace gicodec
