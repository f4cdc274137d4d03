// The kernels of one instruction set (simd/dispatch.h).
#include "native/planes/kernels.h"

#include "simd/intrinsics.h"

#include <bit>
#include <cstring>

namespace gicodec::native::GICODEC_ISA {
namespace {

#include GICODEC_VECTORS

#include "native/planes/lookup.inl"

#include "native/planes/entropy.inl"

#include "native/planes/context.inl"

#include "native/planes/pairs.inl"
#include "native/planes/repeats.inl"

#include "native/planes/shared.inl"

#include "native/planes/planes.inl"

#include "native/rows/row_values.inl"
#include "native/rows/rows.inl"

#include "native/planes/estimate.inl"
#include "native/planes/layout.inl"
#include "native/planes/texels.inl"

#ifdef GICODEC_DECODE_ONLY
constexpr Kernels kKernels{.unpack = unpack,
                           .pack = pack,
                           .to_steps = to_steps,
                           .from_steps = from_steps,
                           .to_lanes = to_lanes,
                           .from_lanes = from_lanes,
                           .decode_planes = decode_planes,
                           .decode_pairs = decode_pairs,
                           .decode_rows = decode_rows,
                           .decode_values = decode_values};
#else
constexpr Kernels kKernels{unpack,       pack,       to_steps,     from_steps,    has_steps,
                           to_lanes,     from_lanes, model_planes, model_pairs,   decode_planes,
                           decode_pairs, model_rows, decode_rows,  decode_values, encode_steps,
                           price_steps,  cost};
#endif

}  // namespace
}  // namespace gicodec::native::GICODEC_ISA

namespace gicodec {
template <>
constinit const native::Kernels TableOf<native::Kernels, Isa::GICODEC_ISA>::kernels =
    native::GICODEC_ISA::kKernels;
}  // namespace gicodec
