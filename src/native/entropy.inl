// Entropy coding of a step: rANS in lockstep, one state per lane, one word stream.

/// After reading: whether the input was long enough.
GICODEC_INLINE bool sound(const Input& in) { return in.next <= in.end; }

/// One token step and the raw bits it asks for. Values of inactive lanes are unspecified.
GICODEC_INLINE I16 decode_tokens(I16 context, std::uint32_t active, const Tables& tables,
                                 Input& in) {
  U32 x = load(in.state);
  const U32 slot = bit_and(x, set32(kProbabilityScale - 1));
  const U32 low = set32(kProbabilityScale - 1);
  const U32 entry = find_slots(tables, context, slot);
  const U32 token = shift_right<24>(entry);
  const U32 frequency = bit_and(shift_right<12>(entry), low);
  const U32 offset = sub(slot, bit_and(entry, low));
  x = select(active, add(mul_lo(frequency, shift_right<12>(x)), offset), x);
  x = refill(x, active, in.next);
  I16 value = narrow(token);
  const std::uint32_t large = to_bits(greater(value, set(static_cast<int>(kDirect) - 1))) & active;
  if (large != 0) {
    const U32 over = sub(token, set32(kDirect));
    // Lanes without raw bits compute with 0 bits.
    const U32 bits = select(large, add(shift_right<1>(over), set32(3)), set32(0));
    const U32 lead = select(large, add(bit_and(over, set32(1)), set32(2)), token);
    const U32 raw = bit_and(x, sub(shift_left(set32(1), bits), set32(1)));
    value = narrow(add(shift_left(lead, bits), raw));
    x = refill(shift_right(x, bits), large, in.next);
  }
  store(in.state, x);
  return value;
}

/// Lanes of `active` whose values need raw bits.
GICODEC_INLINE std::uint32_t large_values(I16 value, std::uint32_t active) {
  return ~to_bits(equal(value, bit_and(value, set(static_cast<int>(kDirect) - 1)))) & active;
}
/// A large value in parts; other lanes hold their value and no bits.
struct Parts {
  U32 token, bits, raw;
};
GICODEC_INLINE Parts take_apart(I16 value, std::uint32_t large) {
  const U32 all = widen(value);
  const U32 v = select(large, all, set32(kDirect));
  const U32 top = log2_floor(v);
  const U32 bits = select(large, sub(top, set32(1)), set32(0));
  const U32 lead = bit_and(shift_right(v, bits), set32(1));
  const U32 token = add(add(shift_left<1>(sub(top, set32(4))), lead), set32(kDirect));
  return {select(large, token, all), bits, bit_and(v, sub(shift_left(set32(1), bits), set32(1)))};
}
/// Tokens of a step in memory: its values where they are small. Inactive lanes hold anything.
struct StepTokens {
  alignas(64) std::uint16_t room[kLanes];
  const std::uint16_t* token;

  GICODEC_INLINE explicit StepTokens(const Step& step) : token(step.value) {}
  GICODEC_INLINE void replace(I16 tokens) {
    store(room, bit_and(tokens, set(63)));
    token = room;
  }
};

/// The inverse: raw bits first, since states run backwards.
GICODEC_INLINE void encode_tokens(const Step& step, const Tables& tables, Output& out) {
  U32 x = load(out.state);
  const I16 value = load(step.value);
  const std::uint32_t large = large_values(value, step.active);
  StepTokens tokens(step);
  if (large != 0) {
    const Parts parts = take_apart(value, large);
    tokens.replace(narrow(parts.token));
    const U32 limit = shift_left(set32(kStateLow), sub(set32(16), parts.bits));
    x = spill(x, limit, large, out.next);
    x = select(large, add(shift_left(x, parts.bits), parts.raw), x);
  } else if (step.active != 0xFFFFFFFFU) {
    tokens.replace(value);
  }
  const U32 entry = find_by_token<&Distribution::codes>(tables, step.context, tokens.token);
  const U32 low = set32(kProbabilityScale - 1);
  const U32 frequency = select(step.active, bit_and(shift_right<12>(entry), low), set32(1));
  const U32 start = bit_and(entry, low);
  x = spill(x, shift_left<19>(frequency), step.active, out.next);
  const U32 q = quotient(x, frequency);
  const U32 r = sub(x, mul_lo(q, frequency));
  store(out.state, select(step.active, add(add(shift_left<12>(q), r), start), x));
}

/// Hit symbols 0, 1, 2 by comparing with the ends of the first two.
GICODEC_INLINE I16 decode_hits(I16 context, std::uint32_t active, const Tables& tables, Input& in) {
  U32 x = load(in.state);
  const I16 end0 = lookup64(tables.hits, context);
  const I16 end1 = lookup64(tables.hits + kHitContexts, context);
  const U32 slots = bit_and(x, set32(kProbabilityScale - 1));
  const I16 slot = narrow(slots);
  const M16 in0 = greater(end0, slot);
  const M16 in01 = greater(end1, slot);
  const I16 start = select(in0, set(0), select(in01, end0, end1));
  const I16 end = select(in0, end0, select(in01, end1, set(static_cast<int>(kProbabilityScale))));
  const U32 next = add(mul_lo(widen(sub(end, start)), shift_right<12>(x)), widen(sub(slot, start)));
  store(in.state, refill(select(active, next, x), active, in.next));
  return select(in0, set(0), select(in01, set(1), set(2)));
}

GICODEC_INLINE void encode_hits(const Step& step, const Tables& tables, Output& out) {
  U32 x = load(out.state);
  const I16 context = load(step.context);
  const I16 value = load(step.value);
  const I16 end0 = lookup64(tables.hits, context);
  const I16 end1 = lookup64(tables.hits + kHitContexts, context);
  const M16 is0 = equal(value, set(0));
  const M16 is1 = equal(value, set(1));
  const I16 start = select(is0, set(0), select(is1, end0, end1));
  const I16 end = select(is0, end0, select(is1, end1, set(static_cast<int>(kProbabilityScale))));
  const U32 frequency = select(step.active, widen(sub(end, start)), set32(1));
  x = spill(x, shift_left<19>(frequency), step.active, out.next);
  const U32 q = quotient(x, frequency);
  const U32 r = sub(x, mul_lo(q, frequency));
  store(out.state, select(step.active, add(add(shift_left<12>(q), r), widen(start)), x));
}

bool decode_values(std::uint32_t active, std::uint16_t context, const Tables& tables, Input& in,
                   std::uint16_t* values) {
  store(values, decode_tokens(set(context), active, tables, in));
  return sound(in);
}

void price_steps(const Step* begin, const Step* end, unsigned first, unsigned last,
                 const Tables& tables, std::uint32_t* cost) {
  U32 sum = load(cost);
  for (const Step* s = begin; s != end; ++s) {
    if (s->hit != 0 || s->active == 0) continue;
    const unsigned context =
        s->context[__builtin_ctz(s->active)];  // all lanes are in one kind of row
    if (context < first || context >= last) continue;
    const I16 value = load(s->value);
    const std::uint32_t large = large_values(value, s->active);
    StepTokens tokens(*s);
    if (large != 0) {
      tokens.replace(narrow(take_apart(value, large).token));
    } else if (s->active != 0xFFFFFFFFU) {
      tokens.replace(value);
    }
    const U32 price = find_by_token<&Distribution::prices>(tables, s->context, tokens.token);
    sum = add(sum, select(s->active, price, set32(0)));
  }
  store(cost, sum);
}

void encode_steps(const Step* begin, const Step* end, const Tables& tables, Output& out) {
  while (end != begin) {
    --end;
    if (end->hit != 0) {
      encode_hits(*end, tables, out);
    } else {
      encode_tokens(*end, tables, out);
    }
  }
}
