#define GICODEC_ISA avx512
#include "simd/kernels.inl"
