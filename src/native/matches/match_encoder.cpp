#include "native/matches/match_chunk.h"
#include "native/matches/match_model.h"
#include "native/matches/match_order.h"
#include "native/matches/match_parser.h"
#include "native/matches/quick_parser.h"

#include <algorithm>

namespace gicodec::native {
namespace {

/// Writes a chunk of `memory.bytes`: literals and matches, in turn.
class Writer {
 public:
  Writer(ByteOrder order, Literals literals, const Distances& distances, std::size_t record,
         MatchMemory& memory, std::vector<std::byte>& out)
      : bytes_(memory.bytes),
        planes_(order.planes),
        record_(record),
        coder_(out),
        model_(literals, distances, memory.trees) {
    coder_.bypass(2, static_cast<std::uint32_t>(order.difference));
    coder_.bypass(1, order.planes ? 1 : 0);
    coder_.bypass(2, static_cast<std::uint32_t>(literals));
  }
  void literals(std::size_t count) {
    for (const std::size_t end = at_ + count; at_ < end; ++at_) {
      model_.match(coder_, byte(), {});
      model_.literal(coder_, byte(), at_ > 0 ? bytes_[at_ - 1] : std::uint8_t{0}, bytes_[at_]);
    }
  }
  void match(std::size_t length, std::size_t distance) {
    model_.match(coder_, byte(), {static_cast<std::uint32_t>(length), distance});
    at_ += length;
  }
  void finish() {
    literals(bytes_.size() - at_);
    coder_.finish();
  }

 private:
  [[nodiscard]] std::size_t byte() const {
    return planes_ ? at_ / (bytes_.size() / record_) : at_ % record_;
  }

  std::span<const std::uint8_t> bytes_;
  bool planes_;
  std::size_t record_, at_ = 0;
  BinaryEncoder coder_;
  MatchModel model_;
};

}  // namespace

bool encode_matches(const Update& u, std::span<const std::uint32_t> positions,
                    const BlockTable& texels, std::size_t most, bool thorough, MatchMemory& memory,
                    std::vector<std::byte>& out) {
  constexpr std::size_t kMaxBytes = 1U << 30;  // numbers, and places
  constexpr std::size_t kLittle = 1U << 17;    // which takes little time to parse well
  if (!takes_matches(u.desc) || positions.size() * u.block_bytes() > kMaxBytes) return false;
  const Orders orders = find_orders(u, positions, texels, most, thorough, memory);
  const std::size_t begin = out.size();
  std::size_t smallest = most + 1;
  ByteOrder order;
  Distances distances{};
  const auto try_as = [&](Literals literals, const auto& parse) {
    const std::size_t end = out.size();
    out.push_back(std::byte{kMatchChunk});
    Writer writer(order, literals, distances, u.desc.record.bytes, memory, out);
    parse(writer);
    writer.finish();
    const bool smaller = out.size() - end < smallest;
    if (smaller) smallest = out.size() - end;
    const auto place = [&](std::size_t i) { return out.begin() + static_cast<std::ptrdiff_t>(i); };
    out.erase(place(smaller ? begin : end), smaller ? place(end) : out.end());
  };
  constexpr unsigned kSparse = 2;
  const auto write_quickly = [&](Writer& writer) {
    parse_quickly(
        memory.bytes, distances, price_of_literal(memory.bytes), kSparse, memory.first,
        [&](std::size_t, std::size_t count) { writer.literals(count); },
        [&](std::size_t, unsigned, std::size_t length, std::size_t distance) {
          writer.match(length, distance);
        });
  };
  const auto write_parts = [&](Writer& writer) {
    for (const auto& [count, match] : memory.parts) {
      writer.literals(count);
      writer.match(match.length, match.distance);
    }
  };
  const auto try_thoroughly = [&] {
    constexpr unsigned kLooks = 64;
    parse_bytes(distances, kLooks, memory);
    for (unsigned l = 0; l < kLiterals; ++l) {
      const auto literals = static_cast<Literals>(l);
      try_as(literals, write_parts);
      if (l != 0) try_as(literals, [](Writer&) {});
    }
  };
  const std::size_t size = positions.size() * u.block_bytes();
  const bool little = size <= kLittle;
  const auto try_quickly = [&](Literals literals) {
    constexpr unsigned kLooks = 16;
    if (!little) return try_as(literals, write_quickly);
    parse_bytes(distances, kLooks, memory);
    try_as(literals, write_parts);
  };
  const std::size_t tries = thorough ? orders.count : little ? 2 : 1;
  for (std::size_t i = 0; i < std::min(tries, orders.count); ++i) {
    order = orders.best[i].order;
    distances = distances_of(u.desc, order, positions.size());
    read_bytes(u, positions, texels, order, memory.bytes);
    // A thorough parse takes little less.
    const auto look = look_quickly(order, distances, u.desc.record.bytes, kSparse, memory);
    if (look.price > static_cast<Price>(smallest) * 9 * kBit) continue;
    thorough ? try_thoroughly() : try_quickly(look.literals);
  }
  return out.size() != begin;
}

}  // namespace gicodec::native
