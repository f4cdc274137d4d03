#include "bitstream/index_buffer.h"

#include "base/bits.h"

#include <algorithm>
#include <bit>

namespace gicodec {
namespace {

constexpr unsigned kParameterBits = 5;
constexpr unsigned kMaxParameter = 24;

/// Visits the gaps: distance to the previous block less one.
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

/// Exact cost of Rice coding a set of values for every parameter at once.
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

/// Quotient as that many ones and a zero, then k low bits.
void write_rice(BitWriter& writer, std::uint32_t value, unsigned k) {
  for (std::uint32_t quotient = value >> k; quotient > 0;) {
    const auto ones = std::min(quotient, 32U);
    writer.bits(0xFFFFFFFFU, ones);
    quotient -= ones;
  }
  writer.bits(0, 1);
  writer.bits(value, k);
}

/// Anything above `max` is returned as max + 1.
std::uint32_t read_rice(BitReader& reader, unsigned k, std::uint32_t max) {
  std::uint64_t quotient = 0;
  while (reader.bits(1) != 0) {
    if ((++quotient << k) > max) return max + 1;
  }
  const std::uint64_t value = quotient << k | reader.bits(k);
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(value, std::uint64_t{max} + 1));
}

void write_bitmap(std::span<const std::uint32_t> blocks, std::uint32_t block_count,
                  std::vector<std::byte>& out) {
  const std::size_t start = out.size();
  out.resize(start + index_buffer_bound(block_count));
  for (const auto block : blocks) {
    out[start + block / 8] |= static_cast<std::byte>(1U << block % 8);
  }
}

/// Calls take(first, count) for runs of blocks, of which there are `count` in all.
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
bool read_runs(BitReader& reader, std::uint32_t count, std::uint32_t block_count, Take&& take) {
  const unsigned skip_k = reader.bits(kParameterBits);
  const unsigned run_k = reader.bits(kParameterBits);
  if (skip_k > kMaxParameter || run_k > kMaxParameter) return false;
  std::uint32_t next = 0;
  for (std::uint32_t found = 0; found < count;) {
    const std::uint32_t left = block_count - next;
    const std::uint32_t skip = read_rice(reader, skip_k, left);
    if (skip >= left || (skip == 0 && next != 0)) return false;
    const std::uint32_t room = std::min(left - skip, count - found);
    const std::uint32_t more = read_rice(reader, run_k, room);
    if (more >= room || reader.overrun()) return false;
    take(next + skip, more + 1);
    found += more + 1;
    next += skip + more + 1;
  }
  return true;
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
  BitReader reader(bytes);
  const bool read = mode == IndexMode::gaps ? read_gaps(reader, count, block_count, take)
                                            : read_runs(reader, count, block_count, take);
  const bool sound =
      read && !reader.overrun() && reader.consumed() == bytes.size() && reader.padding_is_zero();
  return sound ? Status::ok : Status::corrupt;
}

}  // namespace

IndexMode encode_index_buffer(std::span<const std::uint32_t> blocks, std::uint32_t block_count,
                              std::vector<std::byte>& out) {
  if (blocks.size() == block_count) return IndexMode::all;
  if (blocks.empty()) return IndexMode::gaps;

  RiceCost gaps, skips, runs;
  for_each_gap(blocks, [&](std::uint32_t gap) { gaps.add(gap); });
  for_each_run(blocks, [&](std::uint32_t skip, std::uint32_t more) {
    skips.add(skip);
    runs.add(more);
  });
  const unsigned gap_k = gaps.best_parameter();
  const unsigned skip_k = skips.best_parameter();
  const unsigned run_k = runs.best_parameter();
  const auto bytes = [](std::uint64_t bits) { return (bits + 7) / 8; };
  const std::uint64_t gap_bytes = bytes(kParameterBits + gaps.bits(gap_k));
  const std::uint64_t run_bytes =
      bytes(std::uint64_t{2} * kParameterBits + skips.bits(skip_k) + runs.bits(run_k));

  if (index_buffer_bound(block_count) <= std::min(gap_bytes, run_bytes)) {
    write_bitmap(blocks, block_count, out);
    return IndexMode::bitmap;
  }
  BitWriter writer(out);
  if (gap_bytes <= run_bytes) {
    writer.bits(gap_k, kParameterBits);
    for_each_gap(blocks, [&](std::uint32_t gap) { write_rice(writer, gap, gap_k); });
  } else {
    writer.bits(skip_k, kParameterBits);
    writer.bits(run_k, kParameterBits);
    for_each_run(blocks, [&](std::uint32_t skip, std::uint32_t more) {
      write_rice(writer, skip, skip_k);
      write_rice(writer, more, run_k);
    });
  }
  writer.finish();
  return gap_bytes <= run_bytes ? IndexMode::gaps : IndexMode::runs;
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
