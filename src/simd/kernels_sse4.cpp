#define GICODEC_ISA sse4
#include "simd/kernels.inl"
