// Which of the blocks that a client lacks go into its next packets.
#pragma once

#include <gicodec/texture.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace gicodec {

struct Candidate {
  std::uint32_t bundle = 0;  ///< whose packets it would go into
  std::uint32_t block = 0;
  std::uint32_t age = 0;    ///< updates since it is pending
  float weight = 0;         ///< how much of it changed, 0 to 1; or its rank
  std::uint32_t order = 0;  ///< block_order(), among equals
  bool ranked = false;
  std::uint32_t blocks = 1;  ///< that it counts as: one in each texture of the bundle
};

[[nodiscard]] std::size_t blocks_of(std::span<const Candidate> candidates) noexcept;

/// An order in which any first part of a grid's blocks is spread over it, and neighbours are apart:
/// a codec that predicts from neighbours can code such blocks side by side.
[[nodiscard]] std::uint32_t spread_order(const Grid& grid, std::uint32_t block) noexcept;
/// By block what comes before others: stratified_order() of vertices, spread_order() of all else.
/// Throws std::bad_alloc.
[[nodiscard]] std::vector<std::uint32_t> block_order(const TextureDesc& desc);

inline constexpr float kMinWeight = 1.0F / 64;

/// Keeps the `limit` that are pending longest, and those that are ranked: what is worth a look at
/// how much it changed or matters.
void keep_oldest(std::vector<Candidate>& candidates, std::size_t limit);

/// What has to be chosen before a candidate, which none of it lacks in turn; null: nothing.
using Missing = std::function<std::vector<Candidate>(const Candidate&)>;

/// Keeps candidates of at most `limit` blocks, or a single one, in order of bundle and block. Half
/// of the places, rounded up, go to those pending longest, so that no block waits for more than
/// 2·⌈n / limit⌉ updates while n blocks compete, unless some are ranked; the others to the largest
/// weight, which rises with age, then to the longest pending. The least weight counts as
/// kMinWeight of the largest, so that everything comes in the end. In a candidate's place goes
/// what it lacks, whether it is among the candidates or not, and itself if there is room then.
void choose(std::vector<Candidate>& candidates, std::size_t limit, const Missing& missing = {});

}  // namespace gicodec
