#include "native/matches/match_parser.h"

#include "native/matches/match_model.h"
#include "native/matches/match_order.h"
#include "native/matches/quick_parser.h"

#include <utility>

namespace gicodec::native {
namespace {

/// Where the same bytes were before, the nearest first.
class MatchFinder {
 public:
  MatchFinder(unsigned looks, MatchMemory& memory)
      : most_looks_(looks), bytes_(memory.bytes), first_(memory.first), before_(memory.before) {
    first_.assign(std::size_t{1} << hash_bits_, kEnd);
    before_.assign(bytes_.size(), kEnd);
  }

  /// body(place) for each until it says no, at most `looks`.
  template <typename Body>
  void for_each_before(std::size_t at, const Body& body) const {
    if (at + kMinMatch >= bytes_.size()) return;
    unsigned looks = 0;
    for (auto place = first_[hash(at)]; place != kEnd && looks < most_looks_; ++looks) {
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
  static constexpr unsigned kMaxHashBits = 22;
  [[nodiscard]] std::size_t hash(std::size_t at) const {
    return (word_at(&bytes_[at]) & 0xFFFFFF) * 0x9E3779B1U >> (32 - hash_bits_);
  }

  unsigned most_looks_;
  std::span<const std::uint8_t> bytes_;
  Vector<std::uint32_t>&first_, &before_;
  unsigned hash_bits_ =
      std::min(static_cast<unsigned>(std::bit_width(bytes_.size())), kMaxHashBits);
};

/// Literals and matches of the bytes. Takes what saves most bits, and looks one byte ahead.
class Parser {
 public:
  Parser(const Distances& distances, unsigned looks, MatchMemory& memory)
      : bytes_(memory.bytes),
        unit_(distances.unit),
        finder_(looks, memory),
        last_(distances),
        of_literal_(price_of_literal(bytes_)) {}

  void parse(Vector<MatchPart>& parts) {
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
      prices_.count(literals, now.way);
      parts.push_back({std::exchange(literals, 0U), now.match});
      if (now.match.distance != 0) last_.use(now.match.distance);
      at += now.match.length;
      if (at < bytes_.size()) now = best(at);
    }
  }

 private:
  static constexpr std::size_t kEnough = 192;  // longer ones are taken at once
  struct Choice {
    Match match;
    Price saved = 0;
    unsigned way = 0;
  };

  Choice best(std::size_t at) {
    while (added_ < at) finder_.add(added_++);
    Choice best;
    const auto take = [&](unsigned way, std::size_t length, std::size_t distance, Price price) {
      const Price saved = static_cast<Price>(length) * of_literal_ - price;
      const Price least = best.saved + (length == best.match.length ? kHabit : 0);
      if (length == 0 || saved <= least) return;
      best = {
          {static_cast<std::uint32_t>(length), static_cast<std::uint32_t>(distance)}, saved, way};
    };
    take(kZeros, zeros_at(bytes_, at), 0, prices_.of(kZeros));
    for (unsigned i = 0; i < kLastDistances; ++i) {
      if (last_[i] > at) continue;
      const std::size_t from = at - static_cast<std::size_t>(last_[i]);
      take(i, length_at(bytes_, from, at), at - from, prices_.of(i));
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
      take(kNewDistance, length, distance, prices_.of(distance, unit_));
      return true;
    });
    return best;
  }

  std::span<const std::uint8_t> bytes_;
  std::uint64_t unit_;
  MatchFinder finder_;
  std::size_t added_ = 0;  // to the finder
  LastDistances last_;
  MatchPrices prices_;
  Price of_literal_;
};

}  // namespace

void parse_bytes(const Distances& distances, unsigned looks, MatchMemory& memory) {
  Parser(distances, looks, memory).parse(memory.parts);
}

}  // namespace gicodec::native
