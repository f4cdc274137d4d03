#include "native/kernels.h"

#include <immintrin.h>

#include <cstring>

namespace gicodec::native::avx512 {
namespace {

#include "native/simd_avx512.inl"

#include "native/entropy.inl"

#include "native/context.inl"

#include "native/pairs.inl"
#include "native/planes.inl"

#include "native/estimate.inl"
#include "native/layout.inl"
#include "native/texels.inl"

}  // namespace

extern const Kernels kKernels = {"avx512",     unpack,        pack,         to_lanes,
                                 from_lanes,   model_planes,  model_pairs,  decode_planes,
                                 decode_pairs, decode_values, encode_steps, price_steps,
                                 cost};

}  // namespace gicodec::native::avx512
