// A strip of rows (docs/native/rows.md), one step after the other.

/// Table entries of every lane.
GICODEC_INLINE I16 entries(const std::uint16_t* table, I16 index) {
  alignas(64) std::uint16_t v[kLanes];
  store(v, index);
  for (unsigned l = 0; l < kLanes; ++l) v[l] = table[v[l]];
  return load(v);
}

/// Residuals that came before in the texel, of the lead and the channel after it.
struct Leads {
  I16 first, second;
};

/// What residuals around say, and that of the slice before.
template <bool kFlat>
GICODEC_INLINE LocalContext local_context(const RowStrip& s, const RowPlace& p, unsigned k,
                                          const Four& residuals) {
  LocalContext local = local_context(residuals);
  if (!Beside<kFlat>::deep(s)) return local;
  const I16 z = magnitude(load(s.channel[k].z_residuals + p.values));
  const I16 most = sub(local.energy, shift_right<2>(local.energy));
  local.energy = add_sat(most, add_sat(z, shift_right<1>(z)));
  return local;
}

/// The context of a residual by those around and before.
struct RowContext {
  I16 context, flip;
};
GICODEC_INLINE RowContext row_context(const RowStrip& s, unsigned k, const Four& residuals,
                                      const LocalContext& local, const Leads& leads) {
  const MagnitudeTables& magnitudes =
      is_wide(s.channel[k].bits) ? kWideMagnitudes : kNarrowMagnitudes;
  if (k <= s.lead) {
    const I16 size = magnitude_class(local.energy, magnitudes);
    const int kind = k < s.lead || s.lead == 0 ? 0 : static_cast<int>(kRowClass);
    return {add(add(local.sign, size), set(kind)), local.flip};
  }
  I16 beside = magnitude(leads.first), votes = sign_of(leads.first);
  if (k > s.lead + 1) {
    beside = shift_right<1>(add_sat(add_sat(beside, magnitude(leads.second)), set(1)));
    votes = add(votes, sign_of(leads.second));
  } else {
    votes = add(votes, votes);
  }
  const I16 energy = sub(local.energy, shift_right<2>(local.energy));
  const I16 size = magnitude_class(add_sat(energy, add_sat(beside, beside)), magnitudes);
  const M16 none = equal(votes, set(0));
  const M16 balanced = equal(add(residuals.w, residuals.n), set(0));
  const I16 agreed =
      add(shift_left<5>(sub(magnitude(votes), set(1))), select(balanced, set(0), set(kSignStep)));
  const I16 sign = select(none, local.sign, add(agreed, set(kRowClass)));
  const int kind = k > s.lead + 1 ? 2 * static_cast<int>(kRowClass) : 0;
  return {add(add(sign, size), set(kind)), select(none, local.flip, votes)};
}

/// Of low halves, which are little but noise: how much, and whether the high half was as predicted.
GICODEC_INLINE RowContext low_context(const LocalContext& local, I16 high) {
  const I16 size = magnitude_class(local.energy, kWideMagnitudes);
  const I16 other = select(equal(high, set(0)), set(0), set(kRowClass));
  return {add(add(local.sign, size), other), local.flip};
}

/// What a texel may repeat: W or N; in updates its past or W.
template <bool kFlat>
GICODEC_INLINE I16 first_candidate(const RowStrip& s, const RowValues& a) {
  return Beside<kFlat>::update(s) ? a.past : a.now.w;
}
template <bool kFlat>
GICODEC_INLINE I16 second_candidate(const RowStrip& s, const RowValues& a) {
  return Beside<kFlat>::update(s) ? a.now.w : a.now.n;
}
/// Which it is: 0 the first, 1 the second, 2 neither.
template <bool kDecode, bool kFlat, typename Coder>
GICODEC_INLINE I16 code_row_repeat(const RowStrip& s, const RowPlace& p, const RowValues* values,
                                   Coder& coder) {
  M16 same = p.here, one = p.here, other = p.here, last = p.here;
  M16 is_first = p.here, is_second = p.here;
  const auto also = [](M16& all, I16 a, I16 b)
                        GICODEC_INLINE_LAMBDA { all = mask_and(all, equal(a, b)); };
  for (unsigned k = 0; k < s.channels; ++k) {
    const RowValues& a = values[k];
    const I16 first = first_candidate<kFlat>(s, a), second = second_candidate<kFlat>(s, a);
    also(same, first, second);
    if (Beside<kFlat>::update(s)) {
      also(one, a.now.w, a.past_w);
      also(other, a.now.n, a.past_n);
    } else {
      also(one, a.now.nw, a.now.n);
      also(other, a.now.nw, a.now.w);
      also(last, a.now.n, a.now.ne);
    }
    if constexpr (!kDecode) {
      const I16 value = load(s.channel[k].values + p.values);
      also(is_first, value, first);
      also(is_second, value, second);
    }
  }
  const auto worth = [](M16 mask, int n) { return keep(mask, set(n)); };
  I16 pattern = add(worth(one, 1), worth(other, 2));
  if (Beside<kFlat>::update(s)) {
    pattern = add(pattern, worth(same, 4));
  } else {
    pattern =
        select(same, add(worth(one, 1), worth(last, 2)), add(add(pattern, set(4)), worth(last, 3)));
  }
  const Four repeated = trail_around(trail_of_repeats(s), p);
  const I16 around = add(mul_lo(repeated.w, set(6)), add(repeated.n, repeated.n));
  const I16 third = Beside<kFlat>::deep(s) ? load(s.z_repeats + p.values) : repeated.ne;
  const I16 context = add(add(mul_lo(pattern, set(18)), around), min_s(third, set(1)));
  const I16 symbol = select(is_first, set(0), select(is_second, set(1), set(2)));
  return coder.row_repeat(context, p.active, symbol);
}

/// For later texels of the slice, and for the next slice.
template <bool kFlat>
GICODEC_INLINE void put_residual(const RowStrip& s, const RowPlace& p, unsigned k, I16 residual) {
  trail_of(s, k, kResidualTrail).put(p.step, residual);
  if (Beside<kFlat>::slices(s)) store(s.channel[k].z_residuals + p.values, residual);
}

/// Half of W's error, which a texel that repeats keeps.
GICODEC_INLINE I16 kept_error(const Trail& trail, const RowPlace& p) {
  return shift_right<1>(select(p.first_column, trail.n(p.step), trail.w(p.step)));
}

/// One channel of the texels that repeat nothing.
template <bool kDecode, bool kFlat, typename Coder>
GICODEC_INLINE void code_row_channel(const RowStrip& s, const RowPlace& p, unsigned k,
                                     const RowValues* values, I16 exponent, M16 repeats_second,
                                     std::uint32_t open, Leads& leads, Coder& coder) {
  const RowChannel& channel = s.channel[k];
  const I16 largest = set(channel.largest);
  const M16 coded = from_bits(open);
  const RowValues a =
      channel.in_units ? in_units_of<kFlat>(s, values[k], values[0], exponent) : values[k];
  const unsigned guesses = Beside<kFlat>::guesses(s), parts = parts_of(s, k);
  I16 w_error[kRowTrail];
  const auto errors_around = [&](unsigned kind) GICODEC_INLINE_LAMBDA {
    const Four errors = trail_around(trail_of(s, k, kind), p);
    w_error[kind] = errors.w;
    return sum_around(errors);
  };
  I16 guess[kRowGuesses];
  if (channel.low) {
    make_low_guesses<kFlat>(s, a, guess);
  } else {
    make_guesses<kFlat>(s, a, largest, guess);
  }
  I16 base = guess[0], least = errors_around(kGuessTrail);
  least = sub(least, shift_right<2>(least));
  for (unsigned i = 1; i < guesses; ++i) {
    const I16 errors = errors_around(kGuessTrail + i);
    const M16 better = greater(least, errors);
    least = select(better, errors, least);
    base = select(better, guess[i], base);
  }
  base = min_u(base, largest);
  I16 part[kRowParts];
  I16 prediction = base;
  if (parts != 0) {
    const I16 lead = max_s(leads.first, set(-32767)), zero = set(0);
    const I16 up = max_s(lead, zero), down = max_s(sub(zero, lead), zero);
    part[0] = base;
    part[1] = add_signed(base, shift_right<1>(up), shift_right<1>(down), largest);
    part[2] = add_signed(base, up, down, largest);
    part[3] = add_signed(base, add(up, up), add(down, down), largest);
    least = errors_around(kPartTrail);
    for (unsigned i = 1; i < kRowParts; ++i) {
      const I16 errors = errors_around(kPartTrail + i);
      const M16 better = greater(least, errors);
      least = select(better, errors, least);
      prediction = select(better, part[i], prediction);
    }
  }
  const Four residuals = trail_around(trail_of(s, k, kResidualTrail), p);
  const LocalContext local = local_context<kFlat>(s, p, k, residuals);
  const RowContext context =
      channel.low
          ? low_context(local, load(trail_of(s, channel.high, kResidualTrail).step(p.step) + 1))
          : row_context(s, k, residuals, local, leads);

  const I16 place = channel.nearest == nullptr ? prediction : entries(channel.nearest, prediction);
  std::uint16_t* const current = channel.values + p.values;
  I16 residual = set(0), value = set(0);
  if constexpr (!kDecode) {
    value = load(current);
    const I16 at = channel.nearest == nullptr ? value : entries(channel.nearest, value);
    residual = wrap(sub(at, place), channel.bits);
  }
  const unsigned role = k <= s.lead ? 0 : channel.low ? 2 : 1;
  residual = coder.token(role, k, context.context, open, context.flip, residual);
  if constexpr (kDecode) {
    residual = wrap(residual, channel.bits);
    value = bit_and(add(place, residual), set((1 << channel.bits) - 1));
    if (channel.nearest == nullptr) {
      value = min_u(value, largest);
    } else {
      value = entries(channel.palette, min_u(value, set(channel.last_place)));
    }
  }
  const I16 repeated = select(repeats_second, second_candidate<kFlat>(s, values[k]),
                              first_candidate<kFlat>(s, values[k]));
  value = keep(p.here, select(coded, value, repeated));
  residual = keep(coded, residual);
  if constexpr (kDecode) store(current, value);
  trail_of(s, k, kValueTrail).put(p.step, value);
  put_residual<kFlat>(s, p, k, residual);
  if (k == s.lead) leads.first = residual;
  if (k == s.lead + 1) leads.second = residual;
  const auto keep_error = [&](unsigned kind, I16 by) GICODEC_INLINE_LAMBDA {
    const Trail trail = trail_of(s, k, kind);
    const I16 off = channel.low ? magnitude(sub(value, by)) : distance(value, by);
    const I16 error = min_u(off, set(kMostError));
    const I16 kept = shift_right<1>(w_error[kind]);  // as of a texel that repeats
    trail.put(p.step, keep(p.here, select(coded, error, kept)));
  };
  for (unsigned i = 0; i < guesses; ++i) keep_error(kGuessTrail + i, guess[i]);
  for (unsigned i = 0; i < parts; ++i) keep_error(kPartTrail + i, part[i]);
}

/// Where all lanes repeat.
template <bool kDecode, bool kFlat>
GICODEC_INLINE void repeat_row_channel(const RowStrip& s, const RowPlace& p, unsigned k,
                                       const RowValues& values, M16 repeats_second) {
  const I16 value = keep(p.here, select(repeats_second, second_candidate<kFlat>(s, values),
                                        first_candidate<kFlat>(s, values)));
  if constexpr (kDecode) store(s.channel[k].values + p.values, value);
  trail_of(s, k, kValueTrail).put(p.step, value);
  put_residual<kFlat>(s, p, k, set(0));
  const auto keep_error = [&](unsigned kind) GICODEC_INLINE_LAMBDA {
    const Trail trail = trail_of(s, k, kind);
    trail.put(p.step, keep(p.here, kept_error(trail, p)));
  };
  const unsigned guesses = Beside<kFlat>::guesses(s);
  for (unsigned i = 0; i < guesses; ++i) keep_error(kGuessTrail + i);
  for (unsigned i = 0; i < parts_of(s, k); ++i) keep_error(kPartTrail + i);
}

template <bool kDecode, bool kFlat, typename Coder>
[[gnu::noinline]] bool code_rows(const RowStrip& s, Coder& coder) {
  std::memset(s.trail, 0, trail_size(s.channels) * sizeof(std::uint16_t));
  // The row above, as if its lane were one before the first.
  for_each_trail<kFlat>(s, [&](const Trail& trail, const std::uint16_t* above) {
    trail.step(kTrailSteps - 2)[0] = above[0];
    trail.step(kTrailSteps - 1)[0] = s.columns > 1 ? above[1] : std::uint16_t{0};
  });
  RowValues values[kMaxComponents];
  const std::size_t steps = s.columns + std::size_t{kRowDelay} * (s.rows - 1);
  const bool shared = s.lead > 0;
  for (std::size_t t = 0; t < steps; ++t) {
    const RowPlace p = place_of(s, t);
    for (unsigned k = 0; k < s.channels; ++k) {
      values[k] = values_around<kFlat>(s, k, p);
    }
    const I16 symbol = code_row_repeat<kDecode, kFlat>(s, p, values, coder);
    const M16 repeats_second = equal(symbol, set(1));
    const std::uint32_t open = to_bits(equal(symbol, set(2))) & p.active;
    if (open == 0) {
      for (unsigned k = 0; k < s.channels; ++k) {
        repeat_row_channel<kDecode, kFlat>(s, p, k, values[k], repeats_second);
      }
    } else {
      Leads leads{set(0), set(0)};
      for (unsigned k = 0; k < s.channels; ++k) {
        const I16 exponent =
            shared && k > 0 ? load(trail_of(s, 0, kValueTrail).step(p.step) + 1) : set(0);
        code_row_channel<kDecode, kFlat>(s, p, k, values, exponent, repeats_second, open, leads,
                                         coder);
      }
    }
    const M16 coded = from_bits(open);
    const I16 source = keep(mask_andnot(p.here, coded), add(symbol, set(1)));  // 1 or 2
    trail_of_repeats(s).put(p.step, source);
    if (Beside<kFlat>::slices(s)) store(s.z_repeats + p.values, source);
    // What the row above has two columns ahead, and what this strip's last row leaves.
    const std::size_t ahead = t + kRowDelay, left = t - std::size_t{kRowDelay} * (kLanes - 1);
    for_each_trail<kFlat>(s, [&](const Trail& trail, std::uint16_t* above) {
      std::uint16_t* const now = trail.step(p.step);
      now[0] = ahead < s.columns ? above[ahead] : std::uint16_t{0};
      if (t >= kRowDelay * (kLanes - 1)) above[left] = now[kLanes];
    });
    if (!coder.ok()) return false;
  }
  return true;
}

Step* model_rows(const RowStrip& s, Step* steps) {
  Modeller modeller{steps};
  if (Beside<false>::slices(s) || s.update) {
    code_rows<false, false>(s, modeller);
  } else {
    code_rows<false, true>(s, modeller);
  }
  return modeller.next;
}
bool decode_rows(const RowStrip& s, const Tables& tables, Input& in) {
  Reader reader{tables, in};
  if (Beside<false>::slices(s) || s.update) return code_rows<true, false>(s, reader);
  return code_rows<true, true>(s, reader);
}
