// Which order of the bytes an encoder takes.
#pragma once

#include "native/matches/byte_order.h"
#include "native/matches/match_memory.h"
#include "native/matches/match_model.h"
#include "native/matches/match_prices.h"

#include <array>

namespace gicodec::native {

/// Into `bytes`: those of the records of blocks, in that order.
void read_bytes(const Update& u, std::span<const std::uint32_t> positions, const BlockTable& texels,
                ByteOrder order, Vector<std::uint8_t>& bytes);

/// Of a literal among those bytes, by how often each occurs; at least a bit.
[[nodiscard]] Price price_of_literal(std::span<const std::uint8_t> bytes);

/// What a quick parse makes of bytes, about.
struct QuickLook {
  Price price = 0;
  Literals literals = Literals::plain;  ///< those that suit it
};
/// At `memory.bytes`, of records of so many bytes. `sparse`: as parse_quickly().
[[nodiscard]] QuickLook look_quickly(ByteOrder order, const Distances& distances,
                                     std::size_t record, unsigned sparse, MatchMemory& memory);

/// Orders in which little is expected, the best first.
struct Orders {
  static constexpr std::size_t kMax = 3;
  struct One {
    Price price;
    ByteOrder order;
  };
  std::array<One, kMax> best;
  std::size_t count = 0;

  void add(const One& one);
};
/// Those that a quick look expects to have about that many bytes or fewer. `thorough`: literals may
/// be Literals::after, and all are looked at.
[[nodiscard]] Orders find_orders(const Update& u, std::span<const std::uint32_t> positions,
                                 const BlockTable& texels, std::size_t most, bool thorough,
                                 MatchMemory& memory);

}  // namespace gicodec::native
