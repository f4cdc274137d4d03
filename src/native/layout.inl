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

/// Rows run on into each other here: an estimate needs no exact edges. Every second vector is looked
/// at where there are several.
std::uint32_t cost(const CostJob& job, std::uint32_t limit) {
  const unsigned texels = job.core * job.core;
  const unsigned padded = (texels + kLanes - 1) / kLanes * kLanes;
  const unsigned margin = job.core + 1 + kLanes;
  std::uint16_t* const d = job.scratch + margin;
  std::uint16_t* const e0 = d + padded + margin;
  for (unsigned t = 0; t < margin; t += kLanes) store(job.scratch + t, set(0));
  const Weights weights = uniform_weights(job.mode, job.wide);
  const unsigned first = padded > kLanes ? kLanes : 0;
  std::uint32_t sum = 0;
  alignas(64) std::uint16_t lanes[kLanes];
  for (unsigned p = 0; p < job.planes && sum <= limit; ++p) {
    const std::uint16_t* current = job.current + p * job.stride;
    const std::uint16_t* reference = job.reference + p * job.stride;
    for (unsigned t = 0; t < texels; t += kLanes) store(d + t, sub(load(current + t), load(reference + t)));
    for (unsigned t = texels; t < padded; ++t) d[t] = 0;
    I16 total = set(0);
    for (unsigned t = first; t < texels; t += 2 * kLanes) {
      const std::uint16_t* const at = d + t;
      const Four f = {load(at - 1), load(at - job.core), load(at - job.core - 1), load(at - job.core + 1)};
      I16 op = job.wide ? apply_wide(weights, f) : apply_narrow(weights, f);
      if (p > 0) op = add(op, apply_cross(weights, load(e0 + t)));
      const I16 e = sub(load(at), op);
      if (p == 0) store(e0 + t, e);
      const I16 a = magnitude(e);
      // A piecewise linear logarithm: 16 per octave.
      const auto part = [&a](int top) { return min_u(a, set(top)); };
      I16 c = add(add(shift_left<3>(part(1)), shift_left<2>(part(3))), add(shift_left<1>(part(7)), part(15)));
      c = add(c, add(shift_right<1>(part(31)), shift_right<2>(part(63))));
      if (job.wide) {
        c = add(c, add(shift_right<3>(part(127)), shift_right<4>(part(255))));
        c = add(c, add(shift_right<5>(part(511)), shift_right<7>(part(4095))));
      } else {
        c = add(c, shift_right<3>(part(255)));
      }
      total = add_sat(total, c);
    }
    store(lanes, total);
    for (unsigned l = 0; l < kLanes; ++l) sum += lanes[l];
  }
  return sum;
}
