// The kernels of one instruction set: GICODEC_ISA is its namespace, GICODEC_VECTORS the file with
// its vectors.
#include "native/kernels.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include <cstring>

namespace gicodec::native::GICODEC_ISA {
namespace {

#include GICODEC_VECTORS

#include "native/entropy.inl"

#include "native/context.inl"

#include "native/pairs.inl"
#include "native/planes.inl"

#include "native/estimate.inl"
#include "native/layout.inl"
#include "native/texels.inl"

}  // namespace

extern const Kernels kKernels;
constinit const Kernels kKernels{unpack,        pack,         to_lanes,      from_lanes,
                                 model_planes,  model_pairs,  decode_planes, decode_pairs,
                                 decode_values, encode_steps, price_steps,   cost};

}  // namespace gicodec::native::GICODEC_ISA
