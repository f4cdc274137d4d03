// Entropy coding of a step: rANS in lockstep, one state per lane, one word stream.

/// After reading: whether the input was long enough.
GICODEC_INLINE bool in_bounds(const Input& in) { return in.next <= in.end; }

/// States of all lanes, as the words that they consist of.
struct States {
  I16 high, low;
};
GICODEC_INLINE States load_states(const Input& in) { return {load(in.high), load(in.low)}; }
GICODEC_INLINE void store_states(const States& x, Input& in) {
  store(in.high, x.high);
  store(in.low, x.low);
}
GICODEC_INLINE I16 slot_of(const States& x) {
  return bit_and(x.low, set(static_cast<int>(kProbabilityScale) - 1));
}
/// frequency·(x >> 12) + offset, and words for the lanes that ran short.
GICODEC_INLINE void advance(States& x, I16 frequency, I16 offset, std::uint32_t active, Input& in) {
  const I16 rest = bit_or(shift_left<4>(x.high), shift_right<12>(x.low));  // of x >> 12
  const I16 product = mul_lo(frequency, rest);
  const I16 low = add(product, offset);
  const M16 fits = equal(min_u(low, offset), offset);
  const I16 carried = add(mul_high(frequency, rest), keep(fits, set(-1)));
  const I16 high = add(add(carried, set(1)), mul_lo(frequency, shift_right<12>(x.high)));
  if (active == 0xFFFFFFFFU) {
    x = {high, low};
  } else {
    const M16 taking = from_bits(active);
    x = {select(taking, high, x.high), select(taking, low, x.low)};
  }
  refill(x.high, x.low, active, in.next);
}

/// 2^n modulo 2^16, n ≤ 16, by its bytes.
inline constexpr std::uint8_t kPowerLow[16] = {1, 2, 4, 8, 16, 32, 64, 128};
inline constexpr std::uint8_t kPowerHigh[16] = {0, 0, 0, 0, 0,  0,  0,  0,
                                                1, 2, 4, 8, 16, 32, 64, 128};
GICODEC_INLINE I16 power_of_two(I16 n) {
  const B8 index = bytes(bit_and(n, set(15)));
  const I16 power =
      bit_or(words(lookup16(kPowerLow, index)), shift_left<8>(words(lookup16(kPowerHigh, index))));
  return keep(greater(set(16), n), power);
}

GICODEC_INLINE void take_word(std::uint32_t& x, Input& in) {
  if (x >= kStateLow) return;
  std::uint16_t word;
  std::memcpy(&word, in.next, 2);
  x = x << 16 | word;
  in.next += 2;
}
/// As below, lane by lane and from larger tables.
GICODEC_INLINE I16 decode_token_lanes(const RoleTables& tables, I16 contexts, std::uint32_t active,
                                      Input& in) {
  alignas(64) std::uint16_t value[kLanes];
  std::uint8_t bits[kLanes];
  store(value, contexts);
  std::uint32_t asking = 0;
  for (std::uint32_t rest = active; rest != 0; rest &= rest - 1) {
    const int l = lowest_bit(rest);
    const unsigned distribution = tables.map[value[l]];
    std::uint32_t x = in.low[l] | static_cast<std::uint32_t>(in.high[l]) << 16;
    const std::uint32_t slot = x % kProbabilityScale;
    const std::uint32_t units = slot * tables.per16[distribution] >> 4;
    const unsigned symbol = tables.symbol[distribution][units < 255 ? units : 255];
    const std::uint32_t code = tables.by_symbol[distribution][symbol];
    x = (code >> 12 & 0xFFF) * (x >> kProbabilityBits) + slot - (code & 0xFFF);
    value[l] = tables.base[distribution][symbol];
    bits[l] = static_cast<std::uint8_t>(code >> 24);
    asking |= static_cast<std::uint32_t>(bits[l] != 0) << l;
    take_word(x, in);
    in.low[l] = static_cast<std::uint16_t>(x);
    in.high[l] = static_cast<std::uint16_t>(x >> 16);
  }
  for (; asking != 0; asking &= asking - 1) {
    const int l = lowest_bit(asking);
    std::uint32_t x = in.low[l] | static_cast<std::uint32_t>(in.high[l]) << 16;
    value[l] = static_cast<std::uint16_t>(value[l] + (x & ((1U << bits[l]) - 1)));
    x >>= bits[l];
    take_word(x, in);
    in.low[l] = static_cast<std::uint16_t>(x);
    in.high[l] = static_cast<std::uint16_t>(x >> 16);
  }
  return load(value);
}
/// One token step and its raw bits. Values of inactive lanes are unspecified.
GICODEC_STEP I16 decode_tokens(const RoleTables& tables, I16 context, std::uint32_t active,
                               Input& in) {
  if constexpr (!kByteLookups) return decode_token_lanes(tables, context, active, in);
  States x = load_states(in);
  const I16 slot = slot_of(x);
  const Found found = search(tables, context, slot);
  advance(x, found.frequency, sub(slot, found.start), active, in);
  I16 value = found.base;
  const std::uint32_t asking = to_bits(greater(found.raw_bits, set(0))) & active;
  if (asking != 0) {
    const I16 up = power_of_two(found.raw_bits);
    const I16 down =
        power_of_two(sub(set(16), found.raw_bits));  // x >> n is the high half of x·this
    const M16 open = from_bits(asking);
    const I16 rest = mul_high(x.low, down);
    const I16 raw = sub(x.low, mul_lo(rest, up));
    value = add(value, keep(open, raw));
    x.low = select(open, bit_or(rest, mul_lo(x.high, down)), x.low);
    x.high = select(open, mul_high(x.high, down), x.high);
    refill(x.high, x.low, asking, in.next);
  }
  store_states(x, in);
  return value;
}

/// Codes of all values of a step.
GICODEC_INLINE U32 find_codes(const RoleTables& t, const Step& step) {
  return collect([&](unsigned l) {
    return t.by_bin[t.map[step.context[l] & (kContexts - 1)]][find_bin(step.value[l])];
  });
}
GICODEC_INLINE U32 put(U32 x, U32 frequency, U32 start, std::uint32_t active, Output& out) {
  x = spill(x, shift_left<20>(frequency), active, out.next);
  const U32 q = quotient(x, frequency);
  const U32 r = sub(x, mul_lo(q, frequency));
  return select(active, add(add(shift_left<12>(q), r), start), x);
}
/// The inverse: raw bits first, since states run backwards.
GICODEC_INLINE void encode_tokens(const Step& step, const RoleTables& tables, Output& out) {
  U32 x = load(out.state);
  const U32 code = find_codes(tables, step);
  const U32 bits = shift_right<24>(code);
  const std::uint32_t asking = to_bits(greater(narrow(bits), set(0))) & step.active;
  if (asking != 0) {
    // Nothing leaves where the limit would be 2^32.
    const U32 power = shift_left(set32(1), bits);
    const U32 limit = shift_left(set32(kStateLow), sub(set32(16), bits));
    x = spill(x, limit, asking, out.next);
    const U32 raw = bit_and(widen(load(step.value)), sub(power, set32(1)));
    x = select(asking, add(mul_lo(x, power), raw), x);
  }
  const U32 low = set32(kProbabilityScale - 1);
  const U32 frequency = bit_and(shift_right<12>(code), low);
  store(out.state, put(x, frequency, bit_and(code, low), step.active, out));
}

struct RepeatEnds {
  I16 end0, end1;
};
GICODEC_INLINE RepeatEnds find_ends(const RepeatTables& t, I16 context) {
  if constexpr (!kByteLookups) {
    alignas(64) std::uint16_t contexts[kLanes], end[2][kLanes];
    store(contexts, context);
    for (unsigned l = 0; l < kLanes; ++l) {
      for (unsigned k = 0; k < 2; ++k) {
        end[k][l] = static_cast<std::uint16_t>(t.end(k, contexts[l] % kRepeatContexts));
      }
    }
    return {load(end[0]), load(end[1])};
  }
  const B8 distribution = lookup64(t.map, bytes(context));
  const auto end = [&](unsigned k) {
    return bit_or(words(lookup16(t.low[k], distribution)),
                  shift_left<8>(words(lookup16(t.high[k], distribution))));
  };
  return {end(0), end(1)};
}

GICODEC_INLINE RepeatEnds find_ends(const RowRepeats& t, I16 context) {
  if constexpr (!kByteLookups) {
    alignas(64) std::uint16_t contexts[kLanes], end[2][kLanes];
    store(contexts, context);
    for (unsigned l = 0; l < kLanes; ++l) {
      for (unsigned k = 0; k < 2; ++k) {
        end[k][l] = static_cast<std::uint16_t>(t.end(k, contexts[l] & 255));
      }
    }
    return {load(end[0]), load(end[1])};
  }
  const B8 distribution = lookup256(t.map, bytes(context));
  const auto end = [&](unsigned k) {
    return bit_or(words(lookup16(t.low[k], distribution)),
                  shift_left<8>(words(lookup16(t.high[k], distribution))));
  };
  return {end(0), end(1)};
}

/// Repeat symbols 0, 1, 2 by comparing with the ends of the first two.
template <typename Repeats>
GICODEC_STEP I16 decode_repeats(const Repeats& tables, I16 context, std::uint32_t active,
                                Input& in) {
  States x = load_states(in);
  const RepeatEnds ends = find_ends(tables, context);
  const I16 slot = slot_of(x);
  const M16 in0 = greater(ends.end0, slot);
  const M16 in01 = greater(ends.end1, slot);
  const I16 start = select(in0, set(0), select(in01, ends.end0, ends.end1));
  const I16 end =
      select(in0, ends.end0, select(in01, ends.end1, set(static_cast<int>(kProbabilityScale))));
  advance(x, sub(end, start), sub(slot, start), active, in);
  store_states(x, in);
  return select(in0, set(0), select(in01, set(1), set(2)));
}

template <typename Repeats>
GICODEC_INLINE void encode_repeats(const Step& step, const Repeats& tables, Output& out) {
  const RepeatEnds ends = find_ends(tables, load(step.context));
  const I16 value = load(step.value);
  const M16 is0 = equal(value, set(0));
  const M16 is1 = equal(value, set(1));
  const I16 start = select(is0, set(0), select(is1, ends.end0, ends.end1));
  const I16 end =
      select(is0, ends.end0, select(is1, ends.end1, set(static_cast<int>(kProbabilityScale))));
  const U32 frequency = select(step.active, widen(sub(end, start)), set32(1));
  store(out.state, put(load(out.state), frequency, widen(start), step.active, out));
}

bool decode_values(const RoleTables& tables, std::uint32_t active, std::uint16_t context, Input& in,
                   std::uint16_t* values) {
  store(values, decode_tokens(tables, set(context), active, in));
  return in_bounds(in);
}

void price_steps(const Step* begin, const Step* end, unsigned place, const RoleTables& tables,
                 std::uint32_t* cost) {
  for (const Step* s = begin; s != end; ++s) {
    if (s->repeat != 0 || s->place != place) continue;
    for (std::uint32_t rest = s->active; rest != 0; rest &= rest - 1) {
      const int l = lowest_bit(rest);
      cost[l] += static_cast<std::uint32_t>(
          tables.price[tables.map[s->context[l]]][find_bin(s->value[l])]);
    }
  }
}

void encode_steps(const Step* begin, const Step* end, const Tables& tables, Output& out) {
  while (end != begin) {
    --end;
    if (end->repeat != 0 && tables.rows != nullptr) {
      encode_repeats(*end, *tables.rows, out);
    } else if (end->repeat != 0) {
      encode_repeats(*end, *tables.repeats, out);
    } else {
      encode_tokens(*end, *tables.role[end->place], out);
    }
  }
}
