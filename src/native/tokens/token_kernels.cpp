// The kernels of one instruction set (simd/dispatch.h).
#include "native/tokens/token_kernels.h"

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

#ifdef GICODEC_DECODE_ONLY
constexpr TokenKernels kKernels{nullptr, read_tokens};
#else
constexpr TokenKernels kKernels{write_tokens, read_tokens};
#endif

}  // namespace
}  // namespace gicodec::native::GICODEC_ISA

namespace gicodec {
template <>
constinit const native::TokenKernels TableOf<native::TokenKernels, Isa::GICODEC_ISA>::kernels =
    native::GICODEC_ISA::kKernels;
}  // namespace gicodec
