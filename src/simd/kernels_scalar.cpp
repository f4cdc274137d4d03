#define GICODEC_ISA scalar
#include "simd/kernels.inl"
