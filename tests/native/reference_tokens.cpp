#include "native/reference_tokens.h"

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <utility>

namespace gicodec::reference {
namespace {

unsigned bit_of(std::span<const std::byte> bytes, std::size_t at) {
  return at / 8 < bytes.size() ? std::to_integer<unsigned>(bytes[at / 8]) >> at % 8 & 1 : 0;
}
/// Whether bytes end with so many bits, and zeros.
bool ends_with(std::span<const std::byte> bytes, std::size_t bits) {
  if ((bits + 7) / 8 != bytes.size()) return false;
  for (std::size_t at = bits; at < 8 * bytes.size(); ++at) {
    if (bit_of(bytes, at) != 0) return false;
  }
  return true;
}

std::optional<std::size_t> varint(Bytes& in) {
  std::uint64_t value = 0;
  for (unsigned shift = 0; shift < 35; shift += 7) {
    const std::uint64_t byte = in.u8();
    if (in.failed() || (byte == 0 && shift > 0)) return {};
    value |= (byte & 127) << shift;
    if (byte < 128) return value < std::uint64_t{1} << 32 ? std::optional(value) : std::nullopt;
  }
  return {};
}

}  // namespace

bool TokenReader::read(unsigned first, Bytes& in) {
  const unsigned k = first >> 3 & 7;
  continues_ = (first & 0x40) != 0;
  if (first >> 7 != 0 || (continues_ && (first & 4) != 0) || k > 4) return false;
  std::uint64_t coded = 0;
  for (std::size_t p = 0; p < planes_.size(); p += 8) coded |= std::uint64_t{in.u8()} << p;
  if (coded >> planes_.size() != 0 || (planes_.pairs() && coded != 3)) return false;
  std::vector<std::size_t> list;
  for (std::size_t p = 0; p < planes_.size(); ++p) {
    constant_.push_back((coded >> p & 1) != 0 ? -1 : static_cast<int>(in.u16()));
    if (constant_[p] >= 0 && constant_[p] >> planes_.all()[p].stored != 0) return false;
    if (constant_[p] < 0) list.push_back(p);
  }
  const auto is_low = [&](std::size_t plane) { return planes_.all()[plane].low; };
  std::stable_partition(list.begin(), list.end(), std::not_fn(is_low));
  for (std::size_t at = 0; at < list.size();) {
    const auto bits = [&](std::size_t i) { return planes_.all()[list[at + i]].stored; };
    const std::size_t left = list.size() - at;
    std::size_t n = left >= 2 && is_low(list[at]) == is_low(list[at + 1]) ? 2 : 1;
    if (left >= 3 && bits(0) <= 10 && bits(1) <= 10 && bits(2) <= 10) n = 3;
    Group group;
    for (std::size_t i = 0; i < n; ++i) {
      group.planes.push_back(list[at + i]);
      group.small *= 3;
      group.widest = std::max(group.widest, bits(i) + (i > 0 ? 1 : 0));
    }
    group.widest = std::clamp(group.widest, 2U, 16U);
    group.copies = planes_.pairs();
    if (!read_group(group, 4U << k, in)) return false;
    groups_.push_back(std::move(group));
    at += n;
  }
  return in.at_end();
}

bool TokenReader::read_group(Group& group, unsigned streams, Bytes& in) const {
  const unsigned head = in.u8();
  group.prediction = head & 3;
  group.follows = (head & 4) != 0;
  if (head > 15) return false;
  if (group.copies && (group.follows || group.prediction > 1)) return false;
  if (group.follows && group.planes.size() == 1) return false;
  for (const std::size_t plane : group.planes) {
    const bool other = planes_.all()[plane].stored != planes_.all()[group.planes[0]].stored;
    if (group.follows && other) return false;
  }
  std::vector<unsigned> lengths;
  for (unsigned t = 0; t < group.count(); t += 2) {
    const unsigned both = in.u8();
    lengths.push_back(both & 15);
    lengths.push_back(both >> 4);
  }
  if (group.count() % 2 != 0 && lengths.back() != 0) return false;
  lengths.resize(group.count());
  unsigned sum = 0;
  for (const unsigned length : lengths) {
    if (length < 1 || length > 11) return false;
    sum += 1U << (11 - length);
  }
  if (sum != 1U << 11) return false;
  if ((head & 8) != 0 && !read_map(in, group)) return false;
  std::vector<std::size_t> sizes;
  for (unsigned i = 0; i <= streams; ++i) {
    const auto size = varint(in);
    if (!size) return false;
    sizes.push_back(*size);
  }
  for (unsigned i = 0; i < streams; ++i) {
    const auto bytes = in.take(sizes[i]);
    if (in.failed() ||
        !read_stream(bytes, lengths, blocks_ * i / streams, blocks_ * (i + 1) / streams, group)) {
      return false;
    }
  }
  const auto raw = in.take(sizes[streams]);
  group.raw.assign(raw.begin(), raw.end());
  return !in.failed();
}

/// Which units have codes.
bool TokenReader::read_map(Bytes& in, Group& group) const {
  const auto size = varint(in);
  if (!size) return false;
  const auto bytes = in.take(*size);
  if (in.failed()) return false;
  const std::size_t units = blocks_ * units_of_block();
  std::size_t at = 0;
  std::vector<unsigned> map;
  while (map.size() < (units + 7) / 8) {
    if (at == bytes.size()) return false;
    const unsigned used = std::to_integer<unsigned>(bytes[at++]);
    for (unsigned i = 0; i < 8; ++i) {
      const bool has = (used >> i & 1) != 0;
      if (map.size() == (units + 7) / 8) {
        if (has) return false;
        continue;
      }
      if (has && (at == bytes.size() || bytes[at] == std::byte{0})) return false;
      map.push_back(has ? std::to_integer<unsigned>(bytes[at++]) : 0);
    }
  }
  if (at != bytes.size()) return false;
  for (std::size_t unit = 0; unit < 8 * map.size(); ++unit) {
    const bool coded = (map[unit / 8] >> unit % 8 & 1) != 0;
    if (unit < units) group.coded.push_back(coded);
    if (unit >= units && coded) return false;
  }
  return true;
}

/// Tokens of blocks from `begin` to before `end`.
bool TokenReader::read_stream(std::span<const std::byte> bytes,
                              const std::vector<unsigned>& lengths, std::size_t begin,
                              std::size_t end, Group& group) const {
  std::map<std::pair<unsigned, unsigned>, unsigned> codes;  // by length and code
  unsigned code = 0, before = 1;
  for (unsigned length = 1; length <= 11; ++length) {
    for (unsigned t = 0; t < lengths.size(); ++t) {
      if (lengths[t] != length) continue;
      code <<= length - before;
      before = length;
      codes[{length, code++}] = t;
    }
  }
  std::size_t at = 0;
  for (std::size_t i = begin * texels_; i < end * texels_; ++i) {
    const std::size_t unit = i / texels_ * units_of_block() + i % texels_ / 16;
    if (!group.coded.empty() && !group.coded[unit]) {
      group.tokens.push_back(0);
      continue;
    }
    unsigned read = 0, length = 0;
    do {
      if (length == 11) return false;
      read = read << 1 | bit_of(bytes, at++);
      ++length;
    } while (!codes.contains({length, read}));
    group.tokens.push_back(codes.at({length, read}));
  }
  return ends_with(bytes, at);
}

int TokenReader::raw_bits(Group& group, unsigned bits) {
  int value = 0;
  for (unsigned i = 0; i < bits; ++i) value |= static_cast<int>(bit_of(group.raw, group.at++)) << i;
  return value;
}

void TokenReader::read_block(Group& group, const TokenAround& around, Values& values) {
  const std::size_t n = group.planes.size();
  Values d(n, std::vector<int>(texels_));
  for (std::size_t t = 0; t < texels_; ++t) {
    const unsigned token = group.tokens[block_ * texels_ + t];
    if (group.copies && token >= group.small && token < group.small + 3) {
      const Values& copied = around.copies[token - group.small];
      for (std::size_t i = 0; i < n; ++i) d[i][t] = copied[i][t] - around.reference[i][t];
      continue;
    }
    std::vector<int> folded(n);
    if (token < group.small) {
      unsigned rest = token;
      for (std::size_t i = n; i-- > 0; rest /= 3) folded[i] = static_cast<int>(rest % 3);
    } else {
      const unsigned width = token - group.small - (group.copies ? 3 : 0) + 2;
      for (std::size_t i = 0; i < n; ++i)
        folded[i] = raw_bits(group, width == 16 || i == 0 ? width : width - 1);
    }
    for (std::size_t i = 0; i < n; ++i) {
      const int residual = folded[i] % 2 == 0 ? folded[i] / 2 : -(folded[i] + 1) / 2;
      const auto north = [&](std::size_t at) {
        if (at >= columns_) return d[i][at - columns_];
        if (!continues_ || around.above < 0) return 0;
        return group.last_row[static_cast<std::size_t>(around.above)][i][at];
      };
      int predicted = 0;
      if (group.prediction == 1 || (group.prediction > 1 && t % columns_ == 0)) {
        predicted = north(t);
      } else if (group.prediction > 1) {
        predicted = d[i][t - 1] + (group.prediction == 3 ? north(t) - north(t - 1) : 0);
      }
      d[i][t] = (residual + predicted) & 0xFFFF;
    }
  }
  Values& last_row = group.last_row.emplace_back(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto end = d[i].begin() + rows_ * columns_;
    last_row[i].assign(end - columns_, end);
    const std::size_t plane = group.planes[i];
    for (std::size_t t = 0; t < texels_; ++t) {
      const int follow = group.follows && i > 0 ? d[0][t] : 0;
      const int value = around.reference[plane][t] + d[i][t] + follow;
      values[plane][t] = value & ((1 << planes_.all()[plane].stored) - 1);
    }
  }
}

Values TokenReader::next(const TokenAround& around) {
  Values values(planes_.size(), std::vector<int>(texels_));
  for (std::size_t p = 0; p < planes_.size(); ++p) {
    if (constant_[p] >= 0) std::ranges::fill(values[p], constant_[p]);
  }
  for (Group& group : groups_) read_block(group, around, values);
  ++block_;
  return values;
}

bool TokenReader::finished() const {
  return std::ranges::all_of(groups_,
                             [](const Group& group) { return ends_with(group.raw, group.at); });
}

}  // namespace gicodec::reference
