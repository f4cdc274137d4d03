// What is around a texel of a strip of rows, and guesses by it (docs/native/rows.md). In each step
// every lane is at a texel of its row whose neighbours above are done.

GICODEC_INLINE I16 max_u(I16 a, I16 b) { return sub(add(a, b), min_u(a, b)); }
GICODEC_INLINE I16 sub_sat(I16 a, I16 b) { return sub(a, min_u(a, b)); }
GICODEC_INLINE I16 distance(I16 a, I16 b) {
  const I16 least = min_u(a, b);
  return add(sub(a, least), sub(b, least));
}
GICODEC_INLINE I16 add_signed(I16 value, I16 up, I16 down, I16 largest) {
  return min_u(sub_sat(add_sat(value, up), down), largest);
}

/// Sums of six stay below 2^15.
constexpr int kMostError = 5461;
/// What a strip has besides the rows above: most have neither a slice before nor a past.
template <bool kFlat>
struct Beside {
  static bool slices(const RowStrip& s) { return !kFlat && s.z_repeats != nullptr; }
  static bool deep(const RowStrip& s) { return !kFlat && s.deep; }
  static bool update(const RowStrip& s) { return !kFlat && s.update; }
  static unsigned guesses(const RowStrip& s) { return kFlat ? 2 : row_guesses(s.deep, s.update); }
};

/// Rows of one kind of what is kept, by step; a load from a step's begin has the lanes of the rows
/// above.
struct Trail {
  std::uint16_t* at;
  GICODEC_INLINE std::uint16_t* step(std::size_t t) const {
    return at + (t % kTrailSteps) * kTrailStride;
  }
  GICODEC_INLINE I16 w(std::size_t t) const { return load(step(t - 1) + 1); }
  GICODEC_INLINE I16 n(std::size_t t) const { return load(step(t - 2)); }
  GICODEC_INLINE I16 nw(std::size_t t) const { return load(step(t - 3)); }
  GICODEC_INLINE I16 ne(std::size_t t) const { return load(step(t - 1)); }
  GICODEC_INLINE void put(std::size_t t, I16 value) const { store(step(t) + 1, value); }
};
GICODEC_INLINE Trail trail_of(const RowStrip& s, unsigned channel, unsigned kind) {
  return {s.trail + (channel * kRowTrail + kind) * std::size_t{kTrailSteps * kTrailStride}};
}
GICODEC_INLINE Trail trail_of_repeats(const RowStrip& s) { return trail_of(s, s.channels, 0); }
constexpr unsigned kValueTrail = 0, kResidualTrail = 1, kGuessTrail = 2,
                   kPartTrail = kGuessTrail + kRowGuesses;
GICODEC_INLINE unsigned parts_of(const RowStrip& s, unsigned k) {
  return k > s.lead && !s.channel[k].low ? kRowParts : 0;
}

/// Calls body(trail, its row of the strip above).
template <bool kFlat, typename Body>
GICODEC_INLINE void for_each_trail(const RowStrip& s, const Body& body) {
  const std::size_t stride = above_stride(s.columns);
  const unsigned guesses = Beside<kFlat>::guesses(s);
  for (unsigned k = 0; k < s.channels; ++k) {
    std::uint16_t* const above = s.channel[k].above;
    for (unsigned i = 0; i < kGuessTrail + guesses; ++i)
      body(trail_of(s, k, i), above + i * stride);
    for (unsigned i = 0; i < parts_of(s, k); ++i) {
      body(trail_of(s, k, kPartTrail + i), above + (kPartTrail + i) * stride);
    }
  }
  body(trail_of_repeats(s), s.above);
}

/// Where the lanes are at a step.
struct RowPlace {
  std::size_t step;    ///< of trails
  std::size_t values;  ///< of a channel, its lanes'
  std::uint32_t active;
  M16 here, first_column, no_row_above, no_ne, corner;
};
GICODEC_INLINE RowPlace place_of(const RowStrip& s, std::size_t t) {
  const auto lane_at = [t](std::size_t column) -> std::uint32_t {
    if (t < column || (t - column) % kRowDelay != 0) return 0;
    const std::size_t lane = (t - column) / kRowDelay;
    return lane < kLanes ? 1U << lane : 0;
  };
  const std::size_t begin = t < s.columns ? 0 : (t - s.columns) / kRowDelay + 1;
  const std::size_t entered = t / kRowDelay + 1, end = entered < s.rows ? entered : s.rows;
  const auto below = [](std::size_t lane) { return lane >= 32 ? 0xFFFFFFFFU : (1U << lane) - 1; };
  RowPlace p;
  p.step = t + kTrailSteps;
  p.values = t * kLanes;
  p.active = begin < end ? below(end) & ~below(begin) : 0;
  p.here = from_bits(p.active);
  p.first_column = from_bits(lane_at(0));
  p.no_row_above = from_bits(s.first ? 1 : 0);
  p.corner = from_bits(s.first && t == 0 ? 1 : 0);
  p.no_ne = from_bits(lane_at(s.columns - 1U) | (s.first ? 1U : 0U));
  return p;
}

/// Values of a channel around a texel, in the slice before, and in the mirror.
struct RowValues {
  Four now;
  I16 z, zw, zn;
  I16 past, past_w, past_n;
};
template <bool kFlat>
GICODEC_INLINE RowValues values_around(const RowStrip& s, unsigned k, const RowPlace& p) {
  const RowChannel& channel = s.channel[k];
  const Trail trail = trail_of(s, k, kValueTrail);
  RowValues a;
  const I16 none = set(0);
  a.z = a.zw = a.zn = a.past = a.past_w = a.past_n = none;
  if (Beside<kFlat>::deep(s)) {
    a.z = load(channel.slice + p.values);
    a.zw = select(p.first_column, a.z, load(channel.slice + p.values - kLanes));
    a.zn = select(p.no_row_above, a.z, load(channel.slice_above + p.values));
  }
  const I16 n = trail.n(p.step);
  a.now.w = select(p.corner, a.z, select(p.first_column, n, trail.w(p.step)));
  a.now.n = select(p.no_row_above, a.now.w, n);
  a.now.nw = select(mask_or(p.first_column, p.no_row_above), a.now.n, trail.nw(p.step));
  a.now.ne = select(p.no_ne, a.now.n, trail.ne(p.step));
  if (!Beside<kFlat>::update(s)) return a;
  a.past = load(channel.past + p.values);
  const I16 above = select(p.no_row_above, a.past, load(channel.past_above + p.values));
  a.past_w = select(p.first_column, above, load(channel.past + p.values - kLanes));
  a.past_n = select(p.no_row_above, a.past_w, above);
  return a;
}
/// Of residuals and errors, which are 0 beyond edges.
GICODEC_INLINE Four trail_around(const Trail& trail, const RowPlace& p) {
  const I16 n = trail.n(p.step);
  return {select(p.first_column, n, trail.w(p.step)), n, trail.nw(p.step), trail.ne(p.step)};
}
GICODEC_INLINE I16 sum_around(const Four& a) {
  const I16 near = add_sat(a.w, a.n);
  return add_sat(add_sat(near, near), add_sat(a.nw, a.ne));
}

/// Values of mantissas in units of another exponent: shifted up by at most 6, down by at most 12.
GICODEC_INLINE I16 in_units_of(I16 value, I16 from, I16 to) {
  const I16 zero = set(0), by = sub(from, to);
  const I16 up = min_s(max_s(by, zero), set(6));
  const I16 down = min_s(max_s(sub(zero, by), zero), set(12));
  const I16 raised = mul_lo(value, power_of_two(up));
  const I16 half = shift_right<1>(power_of_two(down));
  const I16 lowered = mul_high(add(value, half), power_of_two(sub(set(16), down)));
  return select(greater(down, zero), lowered, raised);
}
template <bool kFlat>
GICODEC_INLINE RowValues in_units_of(const RowStrip& s, const RowValues& value,
                                     const RowValues& from, I16 to) {
  RowValues a = value;
  a.now = {in_units_of(value.now.w, from.now.w, to), in_units_of(value.now.n, from.now.n, to),
           in_units_of(value.now.nw, from.now.nw, to), in_units_of(value.now.ne, from.now.ne, to)};
  if (Beside<kFlat>::deep(s)) {
    a.z = in_units_of(value.z, from.z, to);
    a.zw = in_units_of(value.zw, from.zw, to);
    a.zn = in_units_of(value.zn, from.zn, to);
  }
  if (Beside<kFlat>::update(s)) {
    a.past = in_units_of(value.past, from.past, to);
    a.past_w = in_units_of(value.past_w, from.past_w, to);
    a.past_n = in_units_of(value.past_n, from.past_n, to);
  }
  return a;
}

/// Between W and N, on the plane of W, N and NW.
GICODEC_INLINE I16 clamped_gradient(const Four& a) {
  const I16 low = min_u(a.w, a.n), high = max_u(a.w, a.n);
  I16 g = sub(add(a.w, a.n), a.nw);
  g = select(equal(max_u(a.nw, high), a.nw), low, g);
  return select(equal(min_u(a.nw, low), a.nw), high, g);
}
/// W and half of what the row above grows by.
GICODEC_INLINE I16 west_and_slope(const Four& a, I16 largest) {
  const I16 ne = shift_right<1>(a.ne), nw = shift_right<1>(a.nw);
  return add_signed(a.w, sub_sat(ne, nw), sub_sat(nw, ne), largest);
}

/// `from`, changed as `now` differs from `before`.
GICODEC_INLINE I16 changed_by(I16 from, I16 now, I16 before, I16 largest) {
  return add_signed(from, sub_sat(now, before), sub_sat(before, now), largest);
}
/// The past, and half of what W and N changed by.
GICODEC_INLINE I16 past_and_changes(const RowValues& a, I16 largest) {
  const auto half = [](I16 x, I16 y) { return shift_right<1>(sub_sat(x, y)); };
  return add_signed(a.past, add(half(a.now.w, a.past_w), half(a.now.n, a.past_n)),
                    add(half(a.past_w, a.now.w), half(a.past_n, a.now.n)), largest);
}
/// Of docs/native/rows.md, "Guesses".
template <bool kFlat>
GICODEC_INLINE void make_guesses(const RowStrip& s, const RowValues& a, I16 largest,
                                 I16 (&guess)[kRowGuesses]) {
  I16* next = guess;
  if (Beside<kFlat>::update(s)) {
    *next++ = a.past;
    *next++ = past_and_changes(a, largest);
  }
  *next++ = clamped_gradient(a.now);
  *next++ = west_and_slope(a.now, largest);
  if (!Beside<kFlat>::deep(s)) return;
  *next++ = a.z;
  if (Beside<kFlat>::update(s)) return;
  *next++ = changed_by(a.z, a.now.w, a.zw, largest);
  *next++ = changed_by(a.z, a.now.n, a.zn, largest);
}
/// The same of low halves. All is modulo 2^16: what the high halves carry does not matter.
template <bool kFlat>
GICODEC_INLINE void make_low_guesses(const RowStrip& s, const RowValues& a,
                                     I16 (&guess)[kRowGuesses]) {
  I16* next = guess;
  if (Beside<kFlat>::update(s)) {
    *next++ = a.past;
    *next++ = sub(add(a.past, a.now.w), a.past_w);
  }
  *next++ = sub(add(a.now.w, a.now.n), a.now.nw);
  *next++ = a.now.w;
  if (!Beside<kFlat>::deep(s)) return;
  *next++ = a.z;
  if (Beside<kFlat>::update(s)) return;
  *next++ = sub(add(a.z, a.now.w), a.zw);
  *next++ = sub(add(a.z, a.now.n), a.zn);
}
