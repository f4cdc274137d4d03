// The kernels of one instruction set (simd/dispatch.h).
#include "native/kernels.h"

#include "simd/intrinsics.h"

#include <bit>
#include <cstring>

namespace gicodec::native::GICODEC_ISA {
namespace {

#include GICODEC_VECTORS

#include "native/lookup.inl"

#include "native/entropy.inl"

#include "native/context.inl"

#include "native/pairs.inl"
#include "native/repeats.inl"

#include "native/shared.inl"

#include "native/planes.inl"

#include "native/estimate.inl"
#include "native/layout.inl"
#include "native/texels.inl"

constexpr Kernels kKernels{unpack,       pack,          to_steps,     from_steps,  has_steps,
                           to_lanes,     from_lanes,    model_planes, model_pairs, decode_planes,
                           decode_pairs, decode_values, encode_steps, price_steps, cost};

}  // namespace
}  // namespace gicodec::native::GICODEC_ISA

namespace gicodec {
template <>
constinit const native::Kernels TableOf<native::Kernels, Isa::GICODEC_ISA>::kernels =
    native::GICODEC_ISA::kKernels;
}  // namespace gicodec
