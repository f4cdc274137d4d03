#include "native/matches/match_look.h"

#include "native/matches/byte_order.h"
#include "native/matches/match_prices.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace gicodec::native {
namespace {

constexpr std::size_t kMaxLooks = 1024;
constexpr std::size_t kMaxBytes = 16;  ///< of a record that are counted
constexpr std::size_t kWord = sizeof(std::uint64_t);
constexpr unsigned kFewCounted = 64, kMaxCounted = 255;  ///< records whose bytes are counted

/// What all bytes of a value save when one more is counted, n·log(n) in sum; but for Miller and
/// Madow's term, since few samples show too little.
constexpr auto kSaved = [] {
  std::array<Price, kMaxCounted> saved{};
  const auto sum = [](std::uint64_t n) { return n == 0 ? 0 : static_cast<Price>(n) * log2_of(n); };
  for (unsigned n = 0; n < kMaxCounted; ++n) saved[n] = sum(n + 1) - sum(n);
  saved[0] -= kBit * 72 / 100;
  return saved;
}();

/// Looks at some records, spread over all. Fresh ones are not that before, that above or the past.
class Look {
 public:
  /// Precondition: 1 to kMaxLooks looks, at most those that there are.
  Look(const EncodeJob& job, std::size_t looks, LookMemory& memory)
      : job_(job), looks_(looks), memory_(memory) {
    const std::size_t records = per_block_ * job.blocks.size();
    const auto bits = static_cast<unsigned>(std::bit_width(2 * looks_));
    memory.seen.assign(std::size_t{1} << bits, {});
    memory.times.assign(kDifferences * bytes_ * kValues, 0);
    const std::uint64_t stride = (std::uint64_t{records} << 16) / looks_;
    std::uint32_t noise = 1;
    for (std::size_t i = 0; i < looks_; ++i) {
      noise = noise * 1664525 + 1013904223;
      const auto record =
          static_cast<std::size_t>((stride * i + (stride * (noise >> 16) >> 16)) >> 16);
      const std::uint64_t word = see(record);
      if (word == kNear) continue;
      const std::uint64_t hash = word * 0x9E3779B97F4A7C15U;
      LookMemory::Seen& seen = memory.seen[static_cast<std::size_t>(hash >> (64 - bits))];
      if (seen.word == word) {
        ++again_;
        if (record + 2 < records && word_of(record + 1) == word_of(seen.record + 1) &&
            word_of(record + 2) == word_of(seen.record + 2))
          ++long_;
      }
      seen = {word, record};
    }
  }
  [[nodiscard]] std::uint64_t looks() const noexcept { return looks_; }
  [[nodiscard]] std::uint64_t fresh() const noexcept { return fresh_; }
  /// Fresh ones that were seen before, and those of them that are not alone in that.
  [[nodiscard]] std::uint64_t again() const noexcept { return again_; }
  [[nodiscard]] std::uint64_t in_long() const noexcept { return long_; }
  /// Of the bytes of fresh ones: the least that a byte takes as a difference, about.
  [[nodiscard]] Price literal() const noexcept {
    if (counted_ < kFewCounted) return 7 * kBit;
    Price least = 8 * kBit;
    for (const auto& of_byte : sums_) {
      Price price = 0;
      for (std::size_t k = 0; k < bytes_; ++k) price += of_byte[k].price(counted_);
      least = std::min(least, price / static_cast<Price>(bytes_));
    }
    return least;
  }

 private:
  static constexpr std::uint64_t kNear = 0;
  static constexpr std::size_t kValues = 256;

  /// Up to eight bytes of a record, from byte `at` of the block on.
  [[nodiscard]] std::uint64_t word_at(const std::byte* block, std::size_t at) const noexcept {
    const std::size_t left = size_ - at % size_, room = std::min(block_, sizeof(std::uint64_t));
    const std::size_t from = std::min(at, block_ - room);
    std::uint64_t word = 0;
    std::memcpy(&word, block + from, room);
    word >>= 8 * (at - from);
    return left < sizeof word ? word & ((std::uint64_t{1} << 8 * left) - 1) : word;
  }
  [[nodiscard]] std::uint64_t word_of(std::size_t record) const noexcept {
    return word_at(job_.records[record / per_block_].data(), record % per_block_ * size_);
  }
  using Words = std::array<std::uint64_t, kDifferences>;
  /// What a word is a difference to, by Difference.
  [[nodiscard]] Words others(std::size_t index, const std::byte* now,
                             std::size_t at) const noexcept {
    Words words{};
    if (at >= size_) words[1] = word_at(now, at - size_);
    if (at >= row_) words[2] = word_at(now, at - row_);
    if (!job_.keyframe) words[3] = word_at(job_.mirror.blocks[job_.blocks[index]].data(), at);
    return words;
  }
  /// A word that stands for the record, or kNear.
  std::uint64_t see(std::size_t record) noexcept {
    const std::size_t index = record / per_block_, at = record % per_block_ * size_;
    const std::byte* const now = job_.records[index].data();
    const std::uint64_t word = word_at(now, at);
    const Words other = others(index, now, at);
    if (std::find(other.begin(), other.end(), word) != other.end()) return kNear;
    ++fresh_;
    if (counted_ >= kMaxCounted) return word;
    ++counted_;
    for (std::size_t k = 0; k < bytes_; k += kWord) {
      count(k, word_at(now, at + k), others(index, now, at + k));
    }
    return word;
  }
  /// Bytes of a word, the first of which is byte k of the record.
  void count(std::size_t k, std::uint64_t word, const Words& other) noexcept {
    for (const std::size_t end = std::min(bytes_, k + kWord); k < end; ++k, word >>= 8) {
      for (unsigned d = 0; d < kDifferences; ++d) {
        const std::uint64_t from = other[d] >> 8 * (k % kWord);
        auto& times = memory_.times[(d * bytes_ + k) * kValues + ((word - from) & 255)];
        sums_[d][k].equal += times;
        sums_[d][k].saved += kSaved[times++];
      }
    }
  }
  /// Of a byte. Two estimates that are too low: by how often each value occurs, and by how often
  /// two are equal.
  struct Sum {
    std::uint32_t equal = 0;
    Price saved = 0;
    [[nodiscard]] Price price(std::uint64_t counted) const noexcept {
      const Price shown = log2_of(counted) - saved / static_cast<Price>(counted);
      const Price pairs = log2_of(counted * (counted - 1) / 2);
      return std::min(8 * kBit, std::max(equal == 0 ? 8 * kBit : pairs - log2_of(equal), shown));
    }
  };
  const EncodeJob& job_;
  std::size_t size_ = job_.desc.record.bytes, per_block_ = record_count(job_.desc.block);
  std::size_t block_ = size_ * per_block_, row_ = size_ * job_.desc.block.x;
  std::size_t bytes_ = std::min(size_, kMaxBytes);
  std::size_t looks_;
  LookMemory& memory_;
  std::uint64_t fresh_ = 0, again_ = 0, long_ = 0;
  unsigned counted_ = 0;
  std::array<std::array<Sum, kMaxBytes>, kDifferences> sums_{};
};

}  // namespace

bool may_match(const EncodeJob& job, std::size_t size, bool thorough, LookMemory& memory) {
  if (size <= kTooFew) return false;
  const std::size_t records = record_count(job.desc.block) * job.blocks.size();
  const std::uint64_t all = std::uint64_t{records} * job.desc.record.bytes;
  const bool poor = 2 * size >= all;
  const std::size_t fewest = std::min<std::size_t>(records, poor ? 128 : 32);
  const Look look(job, std::clamp(records / (poor ? 8 : 32), fewest, kMaxLooks), memory);
  const std::uint64_t looks = look.looks(), fresh = look.fresh(), again = look.again();
  // Little is fresh: ordinary chunks have a head.
  if (32 * fresh <= looks && (job.keyframe || 2 * again >= fresh)) return true;
  // A sample shows few of the repeats from afar. They matter where all else is noise, and where
  // it takes more to say a record than where it was.
  constexpr std::uint64_t kFar = 16 * kBit, kLong = kBit / 4;
  const std::uint64_t literal = static_cast<std::uint64_t>(look.literal()) * job.desc.record.bytes;
  constexpr std::uint64_t kLittle = 1U << 14;
  // By the number of repeats among so few, records are one of about so many.
  const std::uint64_t others = again == 0 ? looks : looks * looks / (2 * again);
  const std::uint64_t one_of =
      static_cast<std::uint64_t>(log2_of(std::max<std::uint64_t>(others, 1)));
  const bool dear = 2 * look.in_long() >= again ||
                    (literal >= kFar && fresh * one_of * records / looks / (8 * kBit) <= size);
  const bool many = 16 * again >= looks && (all <= kLittle || (6 * size >= all && dear));
  // What ordinary chunks make very small may be smaller still, also where no record is seen again.
  constexpr std::uint64_t kSmall = 24, kQuick = 1U << 20;
  if (thorough && (2 * again >= looks || (kSmall * size <= all && (job.keyframe || all <= kQuick))))
    return true;
  if (again >= 3 && (many || 4 * size >= 3 * all)) return true;
  // The bytes of fresh records, or distances to where they were; and which are fresh.
  // Where few were not seen before, what is said is which of these.
  const std::uint64_t which = kBit * (2 * std::bit_width(fresh - again) + 1);
  const std::uint64_t far = std::min({kFar, which, literal});
  std::uint64_t bits = (fresh - again) * literal + look.in_long() * std::min(kLong, literal) +
                       (again - look.in_long()) * far;
  for (const std::uint64_t some : {fresh, looks - fresh}) {
    if (some != 0) bits += some * static_cast<std::uint64_t>(log2_of(looks) - log2_of(some));
  }
  // What a sample of noise shows is a little less than noise.
  const std::size_t more = thorough && again > 0 ? size / 8 : 0;
  const std::uint64_t most =
      std::min<std::uint64_t>(size + more + (size + more) / 32, all - all / 32);
  return bits * records / looks / (8 * kBit) <= most;
}

}  // namespace gicodec::native
