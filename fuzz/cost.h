// What an input may cost, as a machine of any speed counts it: memory at a time, and work as bytes
// ever allocated. And what docs/guarantees.md allows decoders.
#pragma once

#include "input.h"

#include "allocation_counter.h"
#include "stream/decoder_memory.h"

namespace gicodec::fuzz {

struct Allowance {
  std::size_t memory = 0, work = 0;
};

inline void check_within(const char* what, const Allowance& spent, const Allowance& allowed) {
  const bool within = spent.memory <= allowed.memory && spent.work <= allowed.work;
  if (!within) {
    std::fprintf(stderr, "%zu bytes at a time of %zu, %zu in all of %zu\n", spent.memory,
                 allowed.memory, spent.work, allowed.work);
  }
  check(within, what);
}

/// What `body` needs beyond what is there already.
template <typename Body>
Allowance cost_of(const Body& body) {
  const std::size_t before = test::heap_total();
  const std::size_t memory = test::heap_peak_of(body);
  return {memory, test::heap_total() - before};
}

/// Runs `body`, which returns what it was allowed.
template <typename Body>
void check_cost(const char* what, const Body& body) {
  Allowance allowed;
  const Allowance spent = cost_of([&] { allowed = body(); });
  check_within(what, spent, allowed);
}

/// Contexts of zstd and LZ4, which a packet may need whatever it brings (tests/cost_test.cpp).
inline constexpr std::size_t kContexts = 200 * 1024;

/// For what its own bytes refuse: "time and memory of its own size". Tables of sizes and heads of
/// chunks take up to three times the bytes they are read from.
constexpr Allowance refusal(std::size_t size) {
  return {4 * size + kContexts, 8 * size + kContexts};
}

/// For a packet that is worked on: the decoder's bound, which counts its scratch as if nothing of
/// it were there yet. In all no more than twice as much, since what grows doubles.
inline Allowance decoding(const TextureDesc& desc, std::size_t size, unsigned threads = 1) {
  const auto memory = static_cast<std::size_t>(decoder_memory(desc, threads)) + size;
  return {memory + kContexts, 2 * memory + kContexts};
}

}  // namespace gicodec::fuzz
