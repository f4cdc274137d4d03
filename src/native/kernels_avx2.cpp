#define GICODEC_ISA avx2
#define GICODEC_VECTORS "native/simd_avx2.inl"
#include "native/kernels.inl"
