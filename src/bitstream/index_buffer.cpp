#include "bitstream/index_buffer.h"

#include "base/bits.h"
#include "base/learned_bit.h"

#include <algorithm>
#include <array>
#include <bit>

namespace gicodec {
namespace {

constexpr unsigned kParameterBits = 5;
constexpr unsigned kMaxParameter = 24;

/// Visits the gaps: distances to the previous block, less one.
template <typename Visit>
void for_each_gap(std::span<const std::uint32_t> blocks, Visit&& visit) {
  std::uint32_t next = 0;
  for (const auto block : blocks) {
    visit(block - next);
    next = block + 1;
  }
}

/// Visits (blocks skipped, blocks taken less one) of each run. Only the first skip can be 0.
template <typename Visit>
void for_each_run(std::span<const std::uint32_t> blocks, Visit&& visit) {
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < blocks.size();) {
    std::size_t end = i + 1;
    while (end < blocks.size() && blocks[end] == blocks[end - 1] + 1) ++end;
    visit(blocks[i] - next, static_cast<std::uint32_t>(end - i - 1));
    next = blocks[end - 1] + 1;
    i = end;
  }
}

/// The exact cost of Rice coding values, for all parameters at once.
class RiceCost {
 public:
  void add(std::uint32_t value) {
    ++count_;
    for (unsigned k = 0; k <= kMaxParameter && value >> k != 0; ++k) quotients_[k] += value >> k;
  }
  [[nodiscard]] unsigned best_parameter() const {
    unsigned best = 0;
    for (unsigned k = 1; k <= kMaxParameter; ++k) {
      if (bits(k) < bits(best)) best = k;
    }
    return best;
  }
  [[nodiscard]] std::uint64_t bits(unsigned k) const { return quotients_[k] + count_ * (k + 1); }

 private:
  std::uint64_t quotients_[kMaxParameter + 1] = {};
  std::uint64_t count_ = 0;
};

/// Writes the quotient in unary, as ones and a zero, then the k low bits.
void write_rice(BitWriter& writer, std::uint32_t value, unsigned k) {
  for (std::uint32_t quotient = value >> k; quotient > 0;) {
    const auto ones = std::min(quotient, 32U);
    writer.bits(0xFFFFFFFFU, ones);
    quotient -= ones;
  }
  writer.bits(0, 1);
  writer.bits(value, k);
}

/// Returns max + 1 for any value above `max`.
std::uint32_t read_rice(BitReader& reader, unsigned k, std::uint32_t max) {
  std::uint64_t quotient = 0;
  while (reader.bits(1) != 0) {
    if ((++quotient << k) > max) return max + 1;
  }
  const std::uint64_t value = quotient << k | reader.bits(k);
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(value, std::uint64_t{max} + 1));
}

/// Adaptive model of skips and lengths of runs: each bit's probability follows its past.
class RunModel {
 public:
  RunModel(std::size_t count, std::uint32_t block_count) {
    // Initial probabilities expect skips of average length.
    const auto usual = static_cast<unsigned>(std::bit_width(block_count / count));
    for (auto& of_distance : wider_[kSkip]) {
      for (unsigned width = 1; width + 1 < usual; ++width) of_distance[width] = {kLikely, 1};
    }
  }

  /// Codes the number of blocks skipped before a run; more() codes the run's length less one.
  template <typename Coder>
  std::uint32_t skip(Coder& coder, std::uint32_t value = 0) {
    const std::uint32_t skipped = number(coder, kSkip, value);
    far_ = skipped + 1 >= kFar;
    return skipped;
  }
  template <typename Coder>
  std::uint32_t more(Coder& coder, std::uint32_t value = 0) {
    return number(coder, kMore, value);
  }

 private:
  static constexpr unsigned kSkip = 0, kMore = 1, kMaxWidth = 25, kDigits = 2;
  static constexpr std::uint32_t kLikely = 58982, kFar = 16;

  template <typename Coder>
  std::uint32_t number(Coder& coder, unsigned kind, std::uint32_t value) {
    const auto value_width = static_cast<unsigned>(std::bit_width(value + 1));
    unsigned width = 1;
    while (width < kMaxWidth && wider_[kind][far_][width].code(coder, value_width > width)) ++width;
    std::uint32_t read = 1;
    unsigned left = width - 1;
    for (unsigned digit = 0; digit < kDigits && left > 0; ++digit) {
      --left;
      LearnedBit& learned = digit_[kind][width][read];
      read = read << 1 | (learned.code(coder, ((value + 1) >> left & 1) != 0) ? 1U : 0U);
    }
    if (left > 0) read = read << left | coder.bypass(left, (value + 1) & ((1U << left) - 1));
    return read - 1;
  }

  std::array<std::array<std::array<LearnedBit, kMaxWidth>, 2>, 2> wider_;
  std::array<std::array<std::array<LearnedBit, 1U << kDigits>, kMaxWidth + 1>, 2> digit_;
  bool far_ = false;  ///< the last skip was long
};

/// Appends fewer than `most` bytes; else returns false and leaves `out` unspecified.
bool write_runs(std::span<const std::uint32_t> blocks, std::uint32_t block_count, std::size_t most,
                std::vector<std::byte>& out) {
  const std::size_t start = out.size();
  RunModel model(blocks.size(), block_count);
  BinaryEncoder coder(out);
  bool first = true;
  for_each_run(blocks, [&](std::uint32_t skip, std::uint32_t more) {
    if (out.size() - start >= most) return;
    model.skip(coder, first ? skip : skip - 1);
    model.more(coder, more);
    first = false;
  });
  coder.finish();
  return out.size() - start < most;
}

void write_bitmap(std::span<const std::uint32_t> blocks, std::uint32_t block_count,
                  std::vector<std::byte>& out) {
  const std::size_t start = out.size();
  out.resize(start + index_buffer_bound(block_count));
  for (const auto block : blocks) {
    out[start + block / 8] |= static_cast<std::byte>(1U << block % 8);
  }
}

/// Calls take(first, count) for each run of blocks. False unless there are `count` blocks in all.
template <typename Take>
bool read_bitmap(std::span<const std::byte> bytes, std::uint32_t count, std::uint32_t block_count,
                 Take&& take) {
  if (bytes.size() != index_buffer_bound(block_count)) return false;
  std::uint32_t found = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    for (auto bits = std::to_integer<unsigned>(bytes[i]); bits != 0; bits &= bits - 1) {
      const std::size_t block = 8 * i + static_cast<unsigned>(std::countr_zero(bits));
      if (block >= block_count || found == count) return false;
      take(static_cast<std::uint32_t>(block), 1U);
      ++found;
    }
  }
  return found == count;
}

template <typename Take>
bool read_gaps(BitReader& reader, std::uint32_t count, std::uint32_t block_count, Take&& take) {
  const unsigned k = reader.bits(kParameterBits);
  if (k > kMaxParameter) return false;
  std::uint32_t next = 0;
  for (std::uint32_t found = 0; found < count; ++found) {
    const std::uint32_t left = block_count - next;
    const std::uint32_t gap = read_rice(reader, k, left);
    if (gap >= left || reader.overrun()) return false;
    take(next + gap, 1U);
    next += gap + 1;
  }
  return true;
}

template <typename Take>
bool read_runs(std::span<const std::byte> bytes, std::uint32_t count, std::uint32_t block_count,
               Take&& take) {
  RunModel model(count, block_count);
  BinaryDecoder coder(bytes);
  std::uint32_t next = 0;
  for (std::uint32_t found = 0; found < count;) {
    const std::uint32_t left = block_count - next;
    const std::uint32_t skip = model.skip(coder) + (found == 0 ? 0 : 1);
    if (skip >= left) return false;
    const std::uint32_t more = model.more(coder);
    if (more >= std::min(left - skip, count - found) || coder.overrun()) return false;
    take(next + skip, more + 1);
    found += more + 1;
    next += skip + more + 1;
  }
  return coder.ended();
}

template <typename Take>
Status read_index_buffer(IndexMode mode, std::uint32_t count, std::uint32_t block_count,
                         std::span<const std::byte> bytes, Take&& take) {
  if (count > block_count || bytes.size() > index_buffer_bound(block_count)) return Status::corrupt;
  if (mode == IndexMode::all) {
    if (count != block_count || !bytes.empty()) return Status::corrupt;
    take(0U, count);
    return Status::ok;
  }
  if (count == 0) {
    return mode == IndexMode::gaps && bytes.empty() ? Status::ok : Status::corrupt;
  }
  if (mode == IndexMode::bitmap) {
    return read_bitmap(bytes, count, block_count, take) ? Status::ok : Status::corrupt;
  }
  if (mode == IndexMode::runs) {
    return read_runs(bytes, count, block_count, take) ? Status::ok : Status::corrupt;
  }
  BitReader reader(bytes);
  const bool sound = read_gaps(reader, count, block_count, take) && !reader.overrun() &&
                     reader.consumed() == bytes.size() && reader.padding_is_zero();
  return sound ? Status::ok : Status::corrupt;
}

}  // namespace

IndexMode encode_index_buffer(std::span<const std::uint32_t> blocks, std::uint32_t block_count,
                              std::vector<std::byte>& out) {
  if (blocks.size() == block_count) return IndexMode::all;
  if (blocks.empty()) return IndexMode::gaps;

  RiceCost gaps;
  for_each_gap(blocks, [&](std::uint32_t gap) { gaps.add(gap); });
  const unsigned k = gaps.best_parameter();
  const std::uint64_t gap_bytes = (kParameterBits + gaps.bits(k) + 7) / 8;

  const std::size_t start = out.size();
  // Fits a size_t, since the bound does.
  const auto least =
      static_cast<std::size_t>(std::min<std::uint64_t>(gap_bytes, index_buffer_bound(block_count)));
  if (write_runs(blocks, block_count, least, out)) return IndexMode::runs;
  out.resize(start);
  if (index_buffer_bound(block_count) <= gap_bytes) {
    write_bitmap(blocks, block_count, out);
    return IndexMode::bitmap;
  }
  BitWriter writer(out);
  writer.bits(k, kParameterBits);
  for_each_gap(blocks, [&](std::uint32_t gap) { write_rice(writer, gap, k); });
  writer.finish();
  return IndexMode::gaps;
}

Status check_index_buffer(IndexMode mode, std::uint32_t count, std::uint32_t block_count,
                          std::span<const std::byte> bytes) noexcept {
  return read_index_buffer(mode, count, block_count, bytes, [](std::uint32_t, std::uint32_t) {});
}

Status decode_index_buffer(IndexMode mode, std::uint32_t count, std::uint32_t block_count,
                           std::span<const std::byte> bytes, Vector<std::uint32_t>& blocks) {
  blocks.clear();
  const Status status = check_index_buffer(mode, count, block_count, bytes);
  if (status != Status::ok) return status;
  blocks.reserve(count);
  return read_index_buffer(mode, count, block_count, bytes,
                           [&](std::uint32_t first, std::uint32_t number) {
                             for (std::uint32_t i = 0; i < number; ++i) blocks.push_back(first + i);
                           });
}

}  // namespace gicodec
