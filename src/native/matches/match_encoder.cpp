#include "native/matches/byte_order.h"
#include "native/matches/match_chunk.h"
#include "native/matches/match_model.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <utility>

namespace gicodec::native {
namespace {

/// Prices are whole numbers, the same on every machine: of 1/256 bits.
using Price = std::int64_t;
constexpr Price kBit = 256;

/// Of a match at one of the last distances, and of one at a new distance but for its size.
constexpr Price kPriceOfLast = 10 * kBit, kPriceOfNew = 12 * kBit;
/// Of what a tree learns about a symbol.
constexpr Price kPriceOfSymbol = 6 * kBit;

/// Logarithm to base 2, by straight lines between powers of two.
constexpr Price log2_of(std::uint64_t n) {
  const auto whole = static_cast<unsigned>(std::bit_width(n)) - 1;
  const std::uint64_t rest = whole > 8 ? n >> (whole - 8) : n << (8 - whole);
  return whole * kBit + static_cast<Price>(rest) - kBit;
}

/// Of all bytes, by how often each occurs.
Price entropy(std::span<const std::uint8_t> bytes) {
  std::array<std::uint32_t, 256> count{};
  for (const auto byte : bytes) ++count[byte];
  Price price = 0;
  for (const auto n : count) {
    if (n != 0) price += kPriceOfSymbol + n * (log2_of(bytes.size()) - log2_of(n));
  }
  return price;
}

/// Of all bytes but the first, by how often each occurs after each.
Price entropy_after(std::span<const std::uint8_t> bytes, std::vector<std::uint32_t>& count) {
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

void read_bytes(const Update& u, std::span<const std::uint32_t> positions, const BlockTable& texels,
                ByteOrder order, std::vector<std::uint8_t>& bytes) {
  ByteWalk walk(u, positions, texels, order);
  bytes.resize(walk.size());
  for (auto& byte : bytes) {
    byte = walk.difference();
    walk.step();
  }
}

std::uint32_t word_at(const std::uint8_t* bytes) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes, sizeof word);
  return word;
}
std::size_t length_at(std::span<const std::uint8_t> bytes, std::size_t from, std::size_t at) {
  std::size_t length = 0;
  while (at + length < bytes.size() && bytes[from + length] == bytes[at + length]) ++length;
  return length;
}

Price price_of_literal(std::span<const std::uint8_t> bytes) {
  return std::max(kBit, entropy(bytes) / static_cast<Price>(bytes.size()));
}

/// What matches leave, about; in little time.
Price quick_look(const Distances& distances, MatchMemory& memory) {
  constexpr unsigned kHashBits = 15, kFewMisses = 6;
  const std::span<const std::uint8_t> bytes = memory.bytes;
  const Price literal = price_of_literal(bytes);
  auto& before = memory.first;
  before.assign(std::size_t{1} << kHashBits, UINT32_MAX);
  LastDistances last(distances);
  auto& literals = memory.literals;
  literals.clear();
  Price price = 0;
  std::size_t at = 0, missed = 0;
  while (at + 4 <= bytes.size()) {
    auto& place = before[word_at(&bytes[at]) * 0x9E3779B1U >> (32 - kHashBits)];
    Price saved = 0, paid = 0;
    std::size_t length = 0, distance = 0;
    const auto offer = [&](std::size_t from, Price cost) {
      const std::size_t here = length_at(bytes, from, at);
      const Price saves = static_cast<Price>(here) * literal - cost;
      if (saves <= saved) return;
      saved = saves;
      paid = cost;
      length = here;
      distance = at - from;
    };
    for (unsigned i = 0; i < kLastDistances; ++i) {
      if (last[i] <= at) offer(static_cast<std::size_t>(at - last[i]), kPriceOfLast);
    }
    if (place != UINT32_MAX) offer(place, kPriceOfNew + log2_of(at - place));
    place = static_cast<std::uint32_t>(at);
    if (length == 0) {
      // Where nothing repeats there are longer and longer steps.
      const std::size_t step = std::min(1 + (missed++ >> kFewMisses), bytes.size() - at);
      literals.insert(literals.end(), &bytes[at], &bytes[at] + step);
      at += step;
      continue;
    }
    missed = 0;
    price += paid;
    last.use(distance);
    at += length;
  }
  literals.insert(literals.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at), bytes.end());
  return price + entropy(literals);
}

/// Where the same bytes were before, the nearest first.
class MatchFinder {
 public:
  explicit MatchFinder(MatchMemory& memory)
      : bytes_(memory.bytes), first_(memory.first), before_(memory.before) {
    first_.assign(std::size_t{1} << kHashBits, kEnd);
    before_.assign(bytes_.size(), kEnd);
  }

  /// body(place) for each until it says no, at most kMostLooks.
  template <typename Body>
  void for_each_before(std::size_t at, const Body& body) const {
    if (at + kMinMatch >= bytes_.size()) return;
    unsigned looks = 0;
    for (auto place = first_[hash(at)]; place != kEnd && looks < kMostLooks; ++looks) {
      if (!body(std::size_t{place})) return;
      place = before_[place];
    }
  }
  void add(std::size_t at) {
    if (at + kMinMatch >= bytes_.size()) return;
    auto& first = first_[hash(at)];
    before_[at] = first;
    first = static_cast<std::uint32_t>(at);
  }

 private:
  static constexpr std::uint32_t kEnd = UINT32_MAX;
  static constexpr unsigned kHashBits = 17, kMostLooks = 64;
  [[nodiscard]] std::size_t hash(std::size_t at) const {
    return (word_at(&bytes_[at]) & 0xFFFFFF) * 0x9E3779B1U >> (32 - kHashBits);
  }

  std::span<const std::uint8_t> bytes_;
  std::vector<std::uint32_t>&first_, &before_;
};

/// Literals and matches of the bytes. Takes what saves most bits, and looks one byte ahead.
class Parser {
 public:
  Parser(const Distances& distances, MatchMemory& memory)
      : bytes_(memory.bytes),
        unit_(distances.unit),
        finder_(memory),
        last_(distances),
        of_literal_(price_of_literal(bytes_)) {}

  void parse(std::vector<MatchPart>& parts) {
    parts.clear();
    std::uint32_t literals = 0;
    Choice now = best(0);
    for (std::size_t at = 0; at < bytes_.size();) {
      const bool looks = now.match.length < kEnough && at + 1 < bytes_.size();
      const Choice next = looks ? best(at + 1) : Choice{};
      if (now.match.length == 0 || next.saved > now.saved + kBit) {
        ++literals;
        ++at;
        now = next;
        continue;
      }
      parts.push_back({std::exchange(literals, 0U), now.match});
      last_.use(now.match.distance);
      at += now.match.length;
      if (at < bytes_.size()) now = best(at);
    }
  }

 private:
  static constexpr std::size_t kEnough = 192;  // longer ones are taken at once
  struct Choice {
    Match match;
    Price saved = 0;
  };

  Choice best(std::size_t at) {
    while (added_ < at) finder_.add(added_++);
    Choice best;
    const auto offer = [&](std::size_t from, std::size_t length, Price price) {
      const Price saved = static_cast<Price>(length) * of_literal_ - price;
      if (length == 0 || saved <= best.saved) return;
      best = {{static_cast<std::uint32_t>(length), static_cast<std::uint32_t>(at - from)}, saved};
    };
    for (unsigned i = 0; i < kLastDistances; ++i) {
      if (last_[i] > at) continue;
      const std::size_t from = at - static_cast<std::size_t>(last_[i]);
      offer(from, length_at(bytes_, from, at), kPriceOfLast);
    }
    std::size_t longest = kMinMatch - 1;
    finder_.for_each_before(at, [&](std::size_t from) {
      if (best.match.length >= kEnough) return false;
      const std::size_t distance = at - from;
      if (longest > 0 && at + longest < bytes_.size() &&
          bytes_[from + longest] != bytes_[at + longest])
        return true;
      const std::size_t length = length_at(bytes_, from, at);
      if (length <= longest) return true;
      longest = length;
      const Price odd = distance % unit_ != 0 ? 3 * kBit : 0;
      offer(from, length, kPriceOfNew + odd + log2_of(distance / unit_ + 1));
      return true;
    });
    return best;
  }

  std::span<const std::uint8_t> bytes_;
  std::uint64_t unit_;
  MatchFinder finder_;
  std::size_t added_ = 0;  // to the finder
  LastDistances last_;
  Price of_literal_;
};

/// Literals, and matches if there are `parts`.
void write(std::span<const MatchPart> parts, ByteOrder order, Literals literals,
           const Distances& distances, std::size_t record, MatchMemory& memory,
           std::vector<std::byte>& out) {
  out.push_back(std::byte{kMatchChunk});
  BinaryEncoder coder(out);
  coder.bypass(2, static_cast<std::uint32_t>(order.difference));
  coder.bypass(1, order.planes ? 1 : 0);
  coder.bypass(2, static_cast<std::uint32_t>(literals));
  MatchModel model(literals, distances, memory.trees);
  const std::span<const std::uint8_t> bytes = memory.bytes;
  const std::size_t records = bytes.size() / record;
  std::size_t at = 0;
  const auto byte = [&] { return order.planes ? at / records : at % record; };
  const auto write_literals = [&](std::size_t end) {
    for (; at < end; ++at) {
      model.match(coder, byte(), {});
      model.literal(coder, byte(), at > 0 ? bytes[at - 1] : std::uint8_t{0}, bytes[at]);
    }
  };
  for (const auto& [count, match] : parts) {
    write_literals(at + count);
    model.match(coder, byte(), {match.length, match.distance});
    at += match.length;
  }
  write_literals(bytes.size());
  coder.finish();
}

}  // namespace

bool encode_matches(const Update& u, std::span<const std::uint32_t> positions,
                    const BlockTable& texels, std::size_t most, MatchMemory& memory,
                    std::vector<std::byte>& out) {
  constexpr std::size_t kMostBytes = 1U << 30;  // numbers, and places
  constexpr std::size_t kLook = 1U << 16;
  if (!takes_matches(u.desc) || positions.size() * u.block_bytes() > kMostBytes) return false;
  // A quick look at some blocks in the middle. What it sees is larger than what it becomes.
  const std::size_t blocks = std::clamp<std::size_t>(kLook / u.block_bytes(), 1, positions.size());
  const auto some = positions.subspan((positions.size() - blocks) / 2, blocks);
  const std::uint64_t hope = std::uint64_t{most + 64} * blocks / positions.size();
  Price least = static_cast<Price>(hope) * 8 * kBit * 4 / 3;
  ByteOrder order;
  bool found = false;
  for (unsigned d = 0; d < kDifferences; ++d) {
    const auto difference = static_cast<Difference>(d);
    if (difference == Difference::past && !u.update) continue;
    for (const bool planes : {false, true}) {
      const ByteOrder one{difference, planes};
      read_bytes(u, some, texels, one, memory.bytes);
      const Price price = std::min(quick_look(distances_of(u.desc, one, blocks), memory),
                                   entropy_after(memory.bytes, memory.counts));
      if (price >= least) continue;
      least = price;
      order = one;
      found = true;
    }
  }
  if (!found) return false;
  read_bytes(u, positions, texels, order, memory.bytes);
  const Distances distances = distances_of(u.desc, order, positions.size());
  const std::size_t begin = out.size();
  std::size_t smallest = most + 1;
  const auto try_as = [&](std::span<const MatchPart> parts, Literals literals) {
    const std::size_t end = out.size();
    write(parts, order, literals, distances, u.desc.record.bytes, memory, out);
    const bool smaller = out.size() - end < smallest;
    if (smaller) smallest = out.size() - end;
    const auto place = [&](std::size_t i) { return out.begin() + static_cast<std::ptrdiff_t>(i); };
    out.erase(place(smaller ? begin : end), smaller ? place(end) : out.end());
  };
  Parser(distances, memory).parse(memory.parts);
  for (unsigned l = 0; l < kLiterals; ++l) {
    try_as(memory.parts, static_cast<Literals>(l));
    if (l != 0) try_as({}, static_cast<Literals>(l));
  }
  return out.size() != begin;
}

}  // namespace gicodec::native
