// The cost estimate of the mode search.

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

/// Rows run on into each other here: an estimate needs no exact edges.
template <bool kWide, bool kPartial>
GICODEC_INLINE void estimate_modes(const CostJob& job, std::uint16_t (*costs)[kLanes]) {
  const unsigned texels = job.rows * job.width, margin = job.width + 1;
  const std::size_t plane_size = job.texels * kLanes;
  const std::size_t first = std::size_t{job.first_row} * job.width;
  const std::size_t span = std::size_t{margin + texels} * kLanes;
  std::uint16_t* const differences = job.scratch;  // [plane][margin, texel][lane]
  std::uint16_t* const e0 = differences + job.planes * span;
  for (unsigned p = 0; p < job.planes; ++p) {
    std::uint16_t* const d = differences + p * span;
    for (unsigned t = 0; t < margin + texels; ++t) {
      // Values before the row above were not loaded.
      if (t == 0 || first + t < margin) {
        store(d + t * kLanes, set(0));
        continue;
      }
      const std::size_t at = p * plane_size + (first + t - margin) * kLanes;
      I16 reference = load(job.reference + at);
      if (job.scaled && p + 1 < job.planes) {
        const std::size_t e = at + (job.planes - 1 - p) * plane_size;
        reference = scaled(reference, scale_of(load(job.reference + e), load(job.current + e)));
      }
      I16 difference = sub(load(job.current + at), reference);
      if constexpr (kPartial) {
        difference = select(from_bits(job.present[first + t - margin].here), difference,
                            load(d + (t - 1) * kLanes));
      }
      store(d + t * kLanes, difference);
    }
  }
  const std::size_t row = std::size_t{job.width} * kLanes;
  for (unsigned m = 0; m < job.count; ++m) {
    const Mode& mode = job.modes[m];
    const Weights weights = uniform_weights(mode, kWide);
    const bool no_operator = mode.w == 0 && mode.n == 0 && mode.nw == 0 && mode.ne == 0;
    // Steps of noise: all planes change by about 1, and follow() predicts their signs.
    const bool follows = no_operator && !kWide && mode.context_class == kFollowClass;
    I16 total = set(0), moved = set(0);
    for (unsigned p = 0; p < job.planes; ++p) {
      const std::uint16_t* at = differences + p * span + std::size_t{margin} * kLanes;
      for (unsigned t = 0; t < texels; ++t, at += kLanes) {
        I16 e = load(at);
        if (!no_operator) {
          const Four f = {load(at - kLanes), load(at - row), load(at - row - kLanes),
                          load(at - row + kLanes)};
          e = sub(e, kWide ? apply_wide(weights, f) : apply_narrow(weights, f));
        }
        if (p == 0) {
          store(e0 + t * kLanes, e);
        } else if (mode.cross != 0 && !(job.scaled && p + 1 == job.planes)) {
          e = sub(e, apply_cross(weights, load(e0 + t * kLanes)));
        }
        I16 cost = estimate(e, kWide);
        if constexpr (kPartial) cost = keep(from_bits(job.present[first + t].here), cost);
        total = add_sat(total, cost);
        if (!follows) continue;
        if constexpr (kPartial) e = keep(from_bits(job.present[first + t].here), e);
        moved = add_sat(moved, magnitude(e));
      }
    }
    if (follows) {
      const I16 most = set(static_cast<int>(std::min(texels * job.planes * 5 / 4, 65534U)));
      total = select(equal(min_u(moved, most), moved), set(0), total);
    }
    store(costs[m], total);
  }
}
template <bool kWide>
void estimate_present(const CostJob& job, std::uint16_t (*costs)[kLanes]) {
  if (job.present == nullptr) {
    estimate_modes<kWide, false>(job, costs);
  } else {
    estimate_modes<kWide, true>(job, costs);
  }
}
void cost(const CostJob& job, std::uint16_t (*costs)[kLanes]) {
  if (job.wide) {
    estimate_present<true>(job, costs);
  } else {
    estimate_present<false>(job, costs);
  }
}
