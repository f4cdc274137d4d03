#define GICODEC_ISA avx512
#define GICODEC_VECTORS "native/simd_avx512.inl"
#include "native/kernels.inl"
