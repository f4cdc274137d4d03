// The kernels of one instruction set (simd/dispatch.h).
#include "native/planes/kernels.h"

#include "base/parts.h"
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

constexpr Kernels kKernels{.unpack = unpack,
                           .pack = pack,
                           .to_steps = to_steps,
                           .from_steps = from_steps,
                           .has_steps = kEncodes ? has_steps : nullptr,
                           .to_lanes = to_lanes,
                           .from_lanes = from_lanes,
                           .model_planes = kEncodes ? model_planes : nullptr,
                           .model_pairs = kEncodes ? model_pairs : nullptr,
                           .decode_planes = decode_planes,
                           .decode_pairs = decode_pairs,
                           .model_rows = kEncodes ? model_rows : nullptr,
                           .decode_rows = decode_rows,
                           .decode_values = decode_values,
                           .encode_steps = kEncodes ? encode_steps : nullptr,
                           .price_steps = kEncodes ? price_steps : nullptr,
                           .cost = kEncodes ? cost : nullptr};

}  // namespace
}  // namespace gicodec::native::GICODEC_ISA

namespace gicodec {
template <>
constinit const native::Kernels TableOf<native::Kernels, Isa::GICODEC_ISA>::kernels =
    native::GICODEC_ISA::kKernels;
}  // namespace gicodec
