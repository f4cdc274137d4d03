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

/// A piecewise linear logarithm of residuals: 16 per octave.
GICODEC_INLINE I16 estimate(I16 e, bool wide) {
  const I16 a = magnitude(e);
  const auto part = [&a](int top) { return min_u(a, set(top)); };
  I16 c = add(add(shift_left<3>(part(1)), shift_left<2>(part(3))), add(shift_left<1>(part(7)), part(15)));
  c = add(c, add(shift_right<1>(part(31)), shift_right<2>(part(63))));
  if (!wide) return add(c, shift_right<3>(part(255)));
  c = add(c, add(shift_right<3>(part(127)), shift_right<4>(part(255))));
  return add(c, add(shift_right<5>(part(511)), shift_right<7>(part(4095))));
}

/// Rows run on into each other here: an estimate needs no exact edges. Of large blocks every second
/// vector is looked at.
template <bool kWide>
GICODEC_INLINE void estimate_modes(const CostJob& job, std::uint32_t* costs) {
  const unsigned texels = job.core * job.core;
  const unsigned padded = (texels + kLanes - 1) / kLanes * kLanes;
  const unsigned margin = job.core + 1 + kLanes;
  std::uint16_t* const d = job.scratch + margin;
  std::uint16_t* const e0 = d + padded;  // [mode][texel]
  for (unsigned t = 0; t < margin; t += kLanes) store(job.scratch + t, set(0));
  const unsigned stride = padded > 2 * kLanes ? 2 * kLanes : kLanes;
  I16 total[kModes];
  for (unsigned m = 0; m < job.count; ++m) total[m] = set(0);
  for (unsigned p = 0; p < job.planes; ++p) {
    const std::uint16_t* current = job.current + p * job.stride;
    const std::uint16_t* reference = job.reference + p * job.stride;
    for (unsigned t = 0; t < texels; t += kLanes) store(d + t, sub(load(current + t), load(reference + t)));
    for (unsigned t = texels; t < padded; ++t) d[t] = 0;
    for (unsigned t = stride - kLanes; t < texels; t += stride) {
      const std::uint16_t* const at = d + t;
      const Four f = {load(at - 1), load(at - job.core), load(at - job.core - 1), load(at - job.core + 1)};
      const I16 here = load(at);
      for (unsigned m = 0; m < job.count; ++m) {
        const Weights weights = uniform_weights(job.modes[m], kWide);
        I16 op = kWide ? apply_wide(weights, f) : apply_narrow(weights, f);
        if (p > 0) op = add(op, apply_cross(weights, load(e0 + m * padded + t)));
        const I16 e = sub(here, op);
        if (p == 0) store(e0 + m * padded + t, e);
        total[m] = add_sat(total[m], estimate(e, kWide));
      }
    }
  }
  for (unsigned m = 0; m < job.count; ++m) costs[m] = sum_lanes(total[m]);
}
void cost(const CostJob& job, std::uint32_t* costs) {
  if (job.wide) {
    estimate_modes<true>(job, costs);
  } else {
    estimate_modes<false>(job, costs);
  }
}
