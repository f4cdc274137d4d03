// What every lane finds in its tables by its own context, on machines with shuffles of bytes.

/// The symbol of every lane's slot.
struct Found {
  I16 start, frequency;  ///< slots
  I16 base, raw_bits;
};

/// Among the ends of the symbols of every lane's distribution, those of quarters first.
GICODEC_INLINE Found search(const RoleTables& t, I16 context, I16 slot) {
  const B8 distribution = lookup256(t.map, bytes(context));
  const I16 units = shift_right<4>(mul_lo(slot, words(lookup16(t.per16, distribution))));
  const B8 s = bytes(min_u(units, set(255)));
  const B8 none = set8(0);
  B8 low = none, high = set8(255), quarter = none;
  M8 passed[3];
  GICODEC_UNROLL
  for (unsigned k = 0; k < 3; ++k) {
    const B8 end = lookup16(t.quarter[k], distribution);
    passed[k] = at_most(end, s);
    low = select(passed[k], end, low);
    high = select(passed[k], high, min_u(high, end));
    quarter = add_where(passed[k], quarter, 1);
  }
  B8 symbol = add(quarter, quarter);
  symbol = add(symbol, symbol);
  GICODEC_UNROLL
  for (unsigned k = 0; k < 3; ++k) {
    const B8 end =
        lookup_quarter(t.inner[k], distribution, quarter, passed[0], passed[1], passed[2]);
    const M8 here = at_most(end, s);
    low = select(here, end, low);
    high = select(here, high, min_u(high, end));
    symbol = add_where(here, symbol, 1);
  }
  const I16 unit = words(lookup16(t.unit, distribution));
  const M16 zero = equal(words(symbol), set(static_cast<int>(kZero)));
  Found f;
  f.start = mul_lo(words(low), unit);
  f.frequency = select(zero, sub(set(static_cast<int>(kProbabilityScale)), f.start),
                       mul_lo(words(sub(high, low)), unit));
  f.base = mul_lo(words(lookup16(kBase, symbol)), words(lookup16(t.scale, distribution)));
  f.raw_bits =
      words(min_u(add(lookup16(kRawBits, symbol), lookup16(t.shift, distribution)), set8(16)));
  return f;
}
