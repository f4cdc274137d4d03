// Counters of bits that five hashes stand for (docs/native/continuous.md, "Bits").
#pragma once

#include "native/mixed/value_model.h"

namespace gicodec::native {

using BitMixer = Mixer<kValueContexts>;
using BitCounters = std::array<Counter*, kValueContexts>;

/// One of each bucket, by the hash.
inline BitCounters counters_of(CounterTable& counters, const ValueContexts& hash) {
  BitCounters found;
  for (std::size_t i = 0; i < kValueContexts; ++i) found[i] = counters[hash[i]] + (hash[i] & 15);
  return found;
}

}  // namespace gicodec::native
