// Layout changes between blocks and lanes, and the cost estimate of the mode search.

void to_lanes(const std::uint16_t* const* blocks, std::size_t count, std::uint16_t* lanes) {
  for (std::size_t t = 0; t < count; t += 8) {
    for (unsigned l = 0; l < kLanes; l += 8) {
      const std::uint16_t* in[8];
      std::uint16_t* out[8];
      for (unsigned k = 0; k < 8; ++k) {
        in[k] = blocks[l + k] + t;
        out[k] = lanes + (t + k) * kLanes + l;
      }
      transpose8(in, out);
    }
  }
}
void from_lanes(const std::uint16_t* lanes, std::size_t count, std::uint16_t* const* blocks) {
  for (std::size_t t = 0; t < count; t += 8) {
    for (unsigned l = 0; l < kLanes; l += 8) {
      const std::uint16_t* in[8];
      std::uint16_t* out[8];
      for (unsigned k = 0; k < 8; ++k) {
        in[k] = lanes + (t + k) * kLanes + l;
        out[k] = blocks[l + k] + t;
      }
      transpose8(in, out);
    }
  }
}

/// About 16 per octave: what a residual costs by its magnitude, in steps of 1 and of 16.
inline constexpr NibbleTable kCostBy1 = {
    {0, 20, 33, 42, 48, 53, 57, 61, 64, 67, 69, 72, 74, 76, 78, 80}};
inline constexpr NibbleTable kCostBy16 = {
    {0, 81, 96, 106, 112, 118, 122, 126, 128, 131, 133, 136, 138, 140, 142, 144}};
inline constexpr NibbleTable kCostBy256 = {
    {0, 145, 160, 170, 176, 182, 186, 190, 192, 195, 197, 200, 202, 204, 206, 208}};
GICODEC_INLINE I16 estimate(I16 e, bool wide) {
  const I16 a = magnitude(e), top = set(15);
  const I16 c =
      max_s(lookup16(kCostBy1, min_u(a, top)), lookup16(kCostBy16, min_u(shift_right<4>(a), top)));
  return wide ? max_s(c, lookup16(kCostBy256, min_u(shift_right<8>(a), top))) : c;
}

/// Rows run on into each other here: an estimate needs no exact edges. Of large blocks every second
/// vector is looked at.
template <bool kWide>
GICODEC_INLINE void estimate_modes(const CostJob& job, std::uint32_t* costs) {
  const unsigned texels = job.core * job.core;
  const unsigned padded = (texels + kLanes - 1) / kLanes * kLanes;
  const unsigned margin = (job.core + 1 + kLanes) / kLanes * kLanes;
  std::uint16_t* const differences = job.scratch;  // [plane][margin, texel]
  std::uint16_t* const e0 = differences + job.planes * (margin + padded);
  for (unsigned p = 0; p < job.planes; ++p) {
    const std::uint16_t* current = job.current + p * job.stride;
    const std::uint16_t* reference = job.reference + p * job.stride;
    std::uint16_t* const d = differences + p * (margin + padded) + margin;
    for (unsigned t = 0; t < margin; t += kLanes) store(d - margin + t, set(0));
    for (unsigned t = 0; t < texels; t += kLanes)
      store(d + t, sub(load(current + t), load(reference + t)));
    for (unsigned t = texels; t < padded; ++t) d[t] = 0;
  }
  const unsigned stride = padded > 2 * kLanes ? 2 * kLanes : kLanes;
  for (unsigned m = 0; m < job.count; ++m) {
    const Weights weights = uniform_weights(job.modes[m], kWide);
    const bool cross = job.modes[m].cross != 0;
    I16 total = set(0);
    for (unsigned p = 0; p < job.planes; ++p) {
      const std::uint16_t* const d = differences + p * (margin + padded) + margin;
      for (unsigned t = stride - kLanes; t < texels; t += stride) {
        const std::uint16_t* const at = d + t;
        const Four f = {load(at - 1), load(at - job.core), load(at - job.core - 1),
                        load(at - job.core + 1)};
        I16 op = kWide ? apply_wide(weights, f) : apply_narrow(weights, f);
        if (p > 0 && cross) op = add(op, apply_cross(weights, load(e0 + t)));
        const I16 e = sub(load(at), op);
        if (p == 0) store(e0 + t, e);
        total = add_sat(total, estimate(e, kWide));
      }
    }
    costs[m] = sum_lanes(total);
  }
}
void cost(const CostJob& job, std::uint32_t* costs) {
  if (job.wide) {
    estimate_modes<true>(job, costs);
  } else {
    estimate_modes<false>(job, costs);
  }
}
