#define GICODEC_NO_UNROLL
#define GICODEC_ISA scalar
#define GICODEC_VECTORS "native/simd_scalar.inl"
#include "native/kernels.inl"
