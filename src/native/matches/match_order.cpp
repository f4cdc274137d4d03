#include "native/matches/match_order.h"

#include "native/matches/quick_parser.h"

#include <algorithm>
#include <limits>

namespace gicodec::native {
namespace {

/// Of all bytes but the first, by how often each occurs after each.
Price entropy_after(std::span<const std::uint8_t> bytes, Vector<std::uint32_t>& count) {
  constexpr std::size_t kFewBytes = 4096;  // whose trees would learn little
  if (bytes.size() < kFewBytes) return std::numeric_limits<Price>::max();
  std::array<std::uint32_t, 256> all{};
  count.assign(std::size_t{256} * 256, 0);
  for (std::size_t i = 1; i < bytes.size(); ++i) {
    ++count[std::size_t{256} * bytes[i - 1] + bytes[i]];
    ++all[bytes[i - 1]];
  }
  Price price = 0;
  for (std::size_t i = 0; i < count.size(); ++i) {
    if (count[i] != 0)
      price += kPriceOfSymbol + count[i] * (log2_of(all[i / 256]) - log2_of(count[i]));
  }
  return price;
}

}  // namespace

void read_bytes(const Update& u, std::span<const std::uint32_t> positions, const BlockTable& texels,
                ByteOrder order, Vector<std::uint8_t>& bytes) {
  ByteWalk walk(u, positions, texels, order);
  bytes.resize(walk.size());
  for (auto& byte : bytes) {
    byte = walk.difference();
    walk.step();
  }
}

Price price_of_literal(std::span<const std::uint8_t> bytes) {
  ByteCounts counts{};
  for (const auto byte : bytes) ++counts[byte];
  return std::max(kBit, entropy(counts, bytes.size()) / static_cast<Price>(bytes.size()));
}

QuickLook look_quickly(ByteOrder order, const Distances& distances, std::size_t record,
                       unsigned sparse, MatchMemory& memory) {
  const std::span<const std::uint8_t> bytes = memory.bytes;
  const std::size_t records = bytes.size() / record;
  std::array<ByteCounts, kByteContexts> counts{};
  std::array<std::uint64_t, kByteContexts> all{};
  MatchCounts matches;
  parse_quickly(
      bytes, distances, price_of_literal(bytes), sparse, memory.first,
      [&](std::size_t at, std::size_t count) {
        for (const std::size_t end = at + count; at < end; ++at) {
          const std::size_t byte = order.planes ? at / records : at % record;
          const std::size_t context = std::min(byte, kByteContexts - 1);
          ++counts[context][bytes[at]];
          ++all[context];
        }
      },
      [&](std::size_t before, unsigned way, std::size_t length, std::size_t distance) {
        matches.count(before, way, length, distance, distances.unit);
      });
  ByteCounts sum{};
  Price apart = 0;
  std::uint64_t literals = 0;
  for (std::size_t c = 0; c < std::min(record, kByteContexts); ++c) {
    apart += entropy(counts[c], all[c]);
    literals += all[c];
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += counts[c][i];
  }
  const Price together = entropy(sum, literals), plain = static_cast<Price>(literals) * 8 * kBit;
  const Price least = std::min({plain, together, apart});
  return {matches.price() + least, plain == least      ? Literals::plain
                                   : together == least ? Literals::together
                                                       : Literals::apart};
}

void Orders::add(const One& one) {
  std::size_t at = 0;
  while (at < count && best[at].price <= one.price) ++at;
  if (at == kMax) return;
  count = std::min(count + 1, kMax);
  std::copy_backward(best.begin() + static_cast<std::ptrdiff_t>(at),
                     best.begin() + static_cast<std::ptrdiff_t>(count - 1),
                     best.begin() + static_cast<std::ptrdiff_t>(count));
  best[at] = one;
}

Orders find_orders(const Update& u, std::span<const std::uint32_t> positions,
                   const BlockTable& texels, std::size_t most, bool thorough, MatchMemory& memory) {
  // At some blocks in the middle. What is seen there is larger than what it becomes.
  constexpr std::size_t kLook = 1U << 16;
  constexpr unsigned kSparse = 4;
  const std::size_t blocks = std::clamp<std::size_t>(kLook / u.block_bytes(), 1, positions.size());
  const auto some = positions.subspan((positions.size() - blocks) / 2, blocks);
  const std::uint64_t hope = std::uint64_t{most + 64} * blocks / positions.size();
  const Price largest = static_cast<Price>(hope) * 8 * kBit * 4 / 3;
  const auto look = [&](ByteOrder order, std::size_t of) {
    return look_quickly(order, distances_of(u.desc, order, of), u.desc.record.bytes, kSparse,
                        memory)
        .price;
  };
  Orders orders;
  const auto look_at = [&](Difference difference) {
    for (const bool planes : {false, true}) {
      const ByteOrder order{difference, planes};
      read_bytes(u, some, texels, order, memory.bytes);
      Price price = look(order, blocks);
      if (thorough) price = std::min(price, entropy_after(memory.bytes, memory.counts));
      if (price <= largest) orders.add({price, order});
    }
  };
  if (u.update) look_at(Difference::past);
  // Where little differs from the past, nothing else is worth the time of fast.
  constexpr Price kLittle = 16;
  const Price plain = static_cast<Price>(blocks * u.block_bytes()) * 8 * kBit;
  if (!thorough && orders.count != 0 && kLittle * orders.best[0].price <= plain) return orders;
  for (const auto difference : {Difference::none, Difference::before, Difference::above})
    look_at(difference);
  if (blocks == positions.size()) return orders;
  // What repeats from afar shows in all records alone.
  read_bytes(u, positions, texels, {}, memory.bytes);
  const Price price = look({}, positions.size()) / static_cast<Price>(positions.size()) *
                      static_cast<Price>(blocks);
  if (price < (orders.count == 0 ? largest : orders.best[0].price)) orders.add({price, {}});
  return orders;
}

}  // namespace gicodec::native
