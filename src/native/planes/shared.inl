// Mantissas under a shared exponent (docs/native.md, "Shared exponents"): what is known of other
// texels counts in units of the one that is coded.

/// 2^(theirs − mine), at most 2, in 64ths; 0 below them.
inline constexpr NibbleTable kScales = {{0, 1, 2, 4, 8, 16, 32, 64, 128}};
GICODEC_INLINE I16 scale_of(I16 theirs, I16 mine) {
  const I16 above = max_s(add(sub(theirs, mine), set(7)), set(0));
  return lookup16(kScales, min_u(above, set(8)));
}
/// a · scale, and as many times a weight in eighths; a is below 2^10, or wraps.
GICODEC_INLINE I16 mul_scaled(I16 a, I16 scale, I16 weight) {
  return mul_rounded(shift_left<5>(a), shift_left<4>(mul_lo(weight, scale)));
}
GICODEC_INLINE I16 scaled(I16 a, I16 scale) {
  return mul_rounded(shift_left<5>(a), shift_left<4>(scale));
}
GICODEC_INLINE I16 apply_scaled(const Weights& k, const Four& d, const Four& scale) {
  const I16 sum = add(add(mul_scaled(d.w, scale.w, k.w), mul_scaled(d.n, scale.n, k.n)),
                      add(mul_scaled(d.nw, scale.nw, k.nw), mul_scaled(d.ne, scale.ne, k.ne)));
  return shift_arithmetic<3>(add(sum, set(4)));
}
