#define GICODEC_NO_UNROLL
#include "native/kernels.h"

#include <cstring>

namespace gicodec::native::scalar {
namespace {

#include "native/simd_scalar.inl"

#include "native/entropy.inl"

#include "native/context.inl"

#include "native/pairs.inl"
#include "native/planes.inl"

#include "native/estimate.inl"
#include "native/layout.inl"
#include "native/texels.inl"

}  // namespace

extern const Kernels kKernels = {"scalar",     unpack,        pack,         to_lanes,
                                 from_lanes,   model_planes,  model_pairs,  decode_planes,
                                 decode_pairs, decode_values, encode_steps, price_steps,
                                 cost};

}  // namespace gicodec::native::scalar
