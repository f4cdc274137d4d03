#define GICODEC_ISA avx2
#include "simd/kernels.inl"
