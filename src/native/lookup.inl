// What every lane looks up in tables, by its own context.

/// Codes by slot.
GICODEC_INLINE U32 find_slots(const Tables& tables, I16 context, U32 slot) {
  alignas(64) std::uint16_t contexts[kLanes];
  alignas(64) std::uint32_t at[kLanes];
  store(contexts, context);
  store(at, slot);
  return collect([&](unsigned l) {
    const Distribution& d = distribution(tables, contexts[l]);
    return d.codes[d.slots[at[l]]];
  });
}
/// Codes or prices by token.
template <std::uint32_t (Distribution::*kTable)[64]>
GICODEC_INLINE U32 find_by_token(const Tables& tables, const std::uint16_t* context,
                                 const std::uint16_t* token) {
  return collect([&](unsigned l) { return (distribution(tables, context[l]).*kTable)[token[l]]; });
}
