#define GICODEC_ISA sse4
#define GICODEC_VECTORS "native/simd_sse4.inl"
#include "native/kernels.inl"
