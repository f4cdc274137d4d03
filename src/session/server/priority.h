// Priority: which pending blocks go into a client's next packets.
#pragma once

#include <gicodec/texture.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace gicodec {

struct Candidate {
  std::uint32_t bundle = 0;  ///< whose packets would have it
  std::uint32_t block = 0;
  std::uint32_t age = 0;    ///< updates since it became pending
  float weight = 0;         ///< share of it that changed, 0 to 1; or its rank
  std::uint32_t order = 0;  ///< from block_order(), decides among equals
  bool ranked = false;
  std::uint32_t blocks = 1;  ///< blocks that it counts as: one per texture of the bundle
};

[[nodiscard]] std::size_t blocks_of(std::span<const Candidate> candidates) noexcept;

/// The place of a block in an order whose every prefix is spread over the grid and has neighbours
/// far apart: a codec that predicts from neighbours can code such blocks side by side.
[[nodiscard]] std::uint32_t spread_order(const Grid& grid, std::uint32_t block) noexcept;
/// The place of each block in the order of sending: stratified_order() for vertices, spread_order()
/// for all else. Throws std::bad_alloc.
[[nodiscard]] std::vector<std::uint32_t> block_order(const TextureDesc& desc);

inline constexpr float kMinWeight = 1.0F / 64;

/// Keeps the `limit` candidates that are pending longest, and the ranked ones. Only these are worth
/// weighing.
void keep_oldest(std::vector<Candidate>& candidates, std::size_t limit);

/// The blocks that a candidate depends on and the client lacks, for choose(); null: none.
using Missing = std::function<std::vector<Candidate>(const Candidate&)>;

/// Keeps candidates of at most `limit` blocks, or a single one, in order of bundle and block. Half
/// of the places, rounded up, go to the longest pending, so that without ranks no block waits for
/// more than 2·⌈n / limit⌉ updates while n blocks compete. The other places go to the largest
/// weights, which rise with age, then to the longest pending. A weight counts as kMinWeight of the
/// largest at least, so that every block comes in the end. The blocks that a candidate lacks come
/// before it, candidates or not; the candidate follows if there is room.
void choose(std::vector<Candidate>& candidates, std::size_t limit, const Missing& missing = {});

}  // namespace gicodec
