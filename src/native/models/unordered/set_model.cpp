#include "native/models/unordered/set_model.h"

#include "base/binary_coder.h"
#include "native/models/numbers.h"
#include "native/models/unordered/set_contexts.h"

#include <cstring>

namespace gicodec::native {
namespace {

// Mixers of flags.
constexpr unsigned kOrderedMixer = 0, kZerosMixer = 1, kSharedMixer = 16, kRecentMixer = 64,
                   kBitMixer = 128, kEqualMixer = 160;

constexpr unsigned kMaxRanks = 4, kFirstBits = 3, kCountDigits = 6;
/// Bits of a component that are contexts of others: of the same record, of the next one.
constexpr unsigned kOtherBits = 12, kFewBits = 4, kBeforeBits = 9;
/// Components of more bits have a flag for what the record before had: others cost less without.
constexpr unsigned kNarrow = 16;

/// The bits of a place that are known; `known` below 32.
std::uint32_t mask(unsigned known) { return known == 0 ? 0 : ~std::uint32_t{0} << (32 - known); }

unsigned size_class(std::uint32_t count) {
  return count < 8 ? count : 8 + std::min(7U, static_cast<unsigned>(std::bit_width(count)) - 4);
}

}  // namespace

void SetModel::Recent::use(std::uint32_t coordinate) {
  unsigned at = 0;
  while (at < count && value[at] != coordinate) ++at;
  if (at == count) {
    if (count < kMax) ++count;
    at = count - 1;
  }
  for (; at > 0; --at) value[at] = value[at - 1];
  value[0] = coordinate;
}

void SetModel::reset(ValueModel& values) {
  values_ = &values;
  values_->reset();
  counts_.assign(64 * 16, {});
  recent_ = {};
  last_ = {};
  before_ = before_that_ = {};
}

void SetModel::encode(BinaryEncoder& coder, const Record& record,
                      std::span<const std::byte> records) {
  record_ = &record;
  in_ = records.data();
  const SetPlace place(record);
  const auto count = static_cast<std::uint32_t>(records.size() / record.bytes);
  places_.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) places_[i] = place(in_ + std::size_t{i} * record.bytes);
  code(coder, place, count);
}

bool SetModel::decode(BinaryDecoder& coder, const Record& record, std::span<std::byte> records) {
  record_ = &record;
  out_ = records.data();
  std::memset(out_, 0, records.size());
  const SetPlace place(record);
  return code(coder, place, static_cast<std::uint32_t>(records.size() / record.bytes));
}

template <typename Coder>
bool SetModel::code(Coder& coder, const SetPlace& place, std::uint32_t count) {
  if (count == 0) return true;
  const std::size_t size = record_->bytes;
  std::uint32_t zeros = 0;
  bool ordered = true;
  if constexpr (!Coder::kDecodes) {
    while (zeros < count && is_zero({in_ + (count - 1 - zeros) * size, size})) ++zeros;
    for (std::uint32_t i = 0; i < count - zeros && ordered; ++i) {
      ordered = !is_zero({in_ + i * size, size}) &&
                (i == 0 || !SetPlace::before(places_[i], places_[i - 1]));
    }
  }
  ordered = values_->flag(coder, kOrderedMixer, kOrdered, ordered);
  if (!ordered) {
    for (std::uint32_t i = 0; i < count; ++i) code_values(coder, i, 0, 0, 0);
    return true;
  }
  if (values_->flag(coder, kZerosMixer, kZeros, zeros > 0)) {
    zeros = coder.bypass(16, zeros);
    if (zeros == 0 || zeros > count) return false;
  } else {
    zeros = 0;
  }
  return code_ordered(coder, place, count - zeros);
}

template <typename Coder>
bool SetModel::code_ordered(Coder& coder, const SetPlace& place, std::uint32_t count) {
  // Every node on the stack has one more known bit than the one before.
  std::array<Node, 32 * SetPlace::kMaxAxes + 2> waiting;
  unsigned depth = 0;
  if (count > 0) waiting[depth++] = {0, count, {}, {}, 0, 0, 0};
  while (depth > 0) {
    if constexpr (Coder::kDecodes) {
      if (coder.overrun()) return false;
    }
    Node node = waiting[--depth];
    unsigned axis = SetPlace::kMaxAxes;
    for (unsigned i = 0; i < place.axes() && axis == SetPlace::kMaxAxes; ++i) {
      const unsigned a = (node.axis + i) % place.axes();
      if ((node.shared >> a & 1) == 0 && node.known[a] < place.bits(a)) axis = a;
    }
    if (node.count == 1 || axis == SetPlace::kMaxAxes) {
      if (!code_leaf(coder, place, node)) return false;
      continue;
    }
    if (code_shared(coder, node, axis)) {
      if constexpr (!Coder::kDecodes) node.place[axis] = places_[node.first][axis];
      if (!code_rest(coder, place, node, axis)) recent_[axis].use(node.place[axis]);
      node.shared = static_cast<std::uint8_t>(node.shared | 1U << axis);
      waiting[depth++] = node;
      continue;
    }
    const std::uint32_t left = code_left(coder, node, axis);
    if (left > node.count) return false;
    const unsigned kind = left == 0 ? 1 : left == node.count ? 2 : 3;
    Node low = node;
    ++low.known[axis];
    low.axis = static_cast<std::uint8_t>((axis + 1) % place.axes());
    low.history = static_cast<std::uint8_t>((node.history << 2 | kind) & 63);
    Node high = low;
    low.count = left;
    high.first += left;
    high.count -= left;
    high.place[axis] |= 1U << (31 - node.known[axis]);
    if (high.count > 0) waiting[depth++] = high;
    if (low.count > 0) waiting[depth++] = low;
  }
  return true;
}

std::uint32_t SetModel::side(unsigned last, unsigned axis, std::uint32_t low, unsigned bit) const {
  const std::uint32_t at = last_[last][axis];
  if (at < low) return 0;
  const std::uint32_t half = (at - low) >> bit;
  return half == 0 ? 1 : half == 1 ? 2 : 3;
}

template <typename Coder>
bool SetModel::code_shared(Coder& coder, const Node& node, unsigned axis) {
  const unsigned known = node.known[axis], size = size_class(node.count);
  bool match = false;
  for (unsigned i = 0; i < recent_[axis].count; ++i) {
    match = match || ((recent_[axis].value[i] ^ node.place[axis]) & mask(known)) == 0;
  }
  bool shared = true;
  if constexpr (!Coder::kDecodes) {
    for (std::uint32_t i = 1; i < node.count && shared; ++i) {
      shared = places_[node.first + i][axis] == places_[node.first][axis];
    }
  }
  const std::uint32_t matches = match ? 1 : 0;
  return values_->flag(coder, kSharedMixer + axis * 16 + size,
                       {{{hashed(kShared + axis, known), size},
                         {hashed(kShared2 + axis, node.shared * 2U + matches), size},
                         {hashed(kShared3 + axis, node.history), matches}}},
                       shared);
}

/// The bits of an axis that are not known, of all records of a node; encoders have set them. True
/// if it is a coordinate of before.
template <typename Coder>
bool SetModel::code_rest(Coder& coder, const SetPlace& place, Node& node, unsigned axis) {
  const std::uint32_t actual = node.place[axis];
  const unsigned known = node.known[axis], bits = place.bits(axis);
  const bool leaf = node.count == 1;
  std::uint32_t low = actual & mask(known);
  unsigned rank = 0;
  for (unsigned i = 0; i < recent_[axis].count && rank < kMaxRanks; ++i) {
    const std::uint32_t candidate = recent_[axis].value[i];
    if (((candidate ^ low) & mask(known)) != 0) continue;
    const bool recent =
        values_->flag(coder, kRecentMixer + (leaf ? 16 : 0) + rank * 4 + axis,
                      {{{hashed((leaf ? kRecentLeaf : kRecent) + axis, 0U), rank},
                        {hashed((leaf ? kRecent2Leaf : kRecent2) + axis, bits - known), rank},
                        {hashed((leaf ? kRecent3Leaf : kRecent3) + axis, i, node.shared), rank}}},
                      candidate == actual);
    if (recent) {
      node.place[axis] = candidate;
      recent_[axis].use(candidate);
      return true;
    }
    ++rank;
  }
  unsigned at = known;
  if (leaf) {
    for (unsigned b = 0; b < kFirstBits && at < bits; ++b, ++at) {
      const unsigned bit = 31 - at;
      const std::uint32_t s0 = side(0, axis, low, bit), s1 = side(1, axis, low, bit),
                          s2 = side(2, axis, low, bit);
      const bool one = values_->flag(coder, kBitMixer + axis * 8 + b,
                                     {{{hashed(kBit + axis, b, node.shared), s0 * 4 + s1},
                                       {hashed(kBit2 + axis, b, s0), s1 * 4 + s2},
                                       {hashed(kBit3 + axis, b, at), s0}}},
                                     (actual >> bit & 1) != 0);
      if (one) low |= 1U << bit;
    }
  }
  if (at < bits) {
    const unsigned shift = 32 - bits;
    low |= coder.bypass(bits - at, (actual & ~mask(at)) >> shift) << shift;
  }
  node.place[axis] = low;
  return false;
}

/// How many records are on the lower side.
template <typename Coder>
std::uint32_t SetModel::code_left(Coder& coder, const Node& node, unsigned axis) {
  const unsigned known = node.known[axis], bit = 31 - known;
  std::uint32_t left = 0;
  if constexpr (!Coder::kDecodes) {
    while (left < node.count && (places_[node.first + left][axis] >> bit & 1) == 0) ++left;
  }
  const auto width = static_cast<unsigned>(std::bit_width(node.count));
  const unsigned low = width > kCountDigits ? width - kCountDigits : 0;
  const std::uint32_t top = node.count >> low;
  const std::uint32_t sides =
      side(0, axis, node.place[axis], bit) * 4 + side(1, axis, node.place[axis], bit);
  const std::uint32_t by[] = {hashed(kLeft, low, top, sides),
                              hashed(kLeft2, low, top, std::min(known, 8U)),
                              hashed(kLeft3, low, top, node.history)};
  std::uint32_t digits = 1;
  for (unsigned b = width; b-- > low;) {
    std::array<FlagContext, kFlagContexts> context;
    for (std::size_t i = 0; i < kFlagContexts; ++i) {
      context[i] = {hashed(by[i], digits >> 4), digits & 15};
    }
    Mixer<kFlagContexts>& mixer =
        counts_[(low > 0 ? 63 : top) * 16 + std::min<std::uint32_t>(digits, 15)];
    const bool one = values_->flag(coder, mixer, context, (left >> b & 1) != 0);
    digits = digits << 1 | (one ? 1U : 0U);
  }
  const std::uint32_t high = digits ^ 1U << (width - low);
  return low == 0 ? high : high << low | coder.bypass(low, left & ((1U << low) - 1));
}

template <typename Coder>
bool SetModel::code_leaf(Coder& coder, const SetPlace& place, Node& node) {
  for (unsigned a = 0; a < place.axes(); ++a) {
    if ((node.shared >> a & 1) != 0 || node.known[a] == place.bits(a)) continue;
    if constexpr (!Coder::kDecodes) node.place[a] = places_[node.first][a];
    if (code_rest(coder, place, node, a)) {
      node.shared = static_cast<std::uint8_t>(node.shared | 1U << a);
    }
  }
  std::uint32_t plane = 0, cell = 0;
  for (unsigned a = 0; a < place.axes(); ++a) {
    if ((node.shared >> a & 1) != 0) plane = hashed(plane, a, node.place[a]);
    cell = cell << 3 | node.place[a] >> 29;
  }
  last_ = {node.place, last_[0], last_[1]};
  for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
    if constexpr (Coder::kDecodes) {
      if (coder.overrun()) return false;
      for (unsigned a = 0; a < place.axes(); ++a) {
        set_code(out_ + std::size_t{i} * record_->bytes, record_->components[a], record_->bytes,
                 node.place[a] >> (32 - place.bits(a)));
      }
    }
    code_values(coder, i, place.axes(), plane, cell);
  }
  return true;
}

template <typename Coder>
void SetModel::code_values(Coder& coder, std::uint32_t index, unsigned first, std::uint32_t plane,
                           std::uint32_t cell) {
  const std::size_t size = record_->bytes, at = index * size;
  std::uint32_t other = 0, other2 = 0, few = 0;  // of the last component, and the one before that
  for (unsigned c = first; c < record_->count; ++c) {
    const Component& component = record_->components[c];
    const unsigned bits = component.bits;
    std::uint32_t value = 0;
    if constexpr (!Coder::kDecodes) value = code_of(in_ + at, component, size);
    const std::uint32_t before = before_[c];
    const bool steady = before == before_that_[c];
    if (bits > kNarrow && values_->flag(coder, kEqualMixer + c,
                                        {{{kEqual + c, steady ? 1U : 0U},
                                          {hashed(kEqual2 + c, few), 0},
                                          {hashed(kEqual3 + c, plane), 0}}},
                                        value == before)) {
      value = before;
    } else {
      value = values_->value(coder, c,
                             {hashed(kValue + c, 0U), hashed(kAfterOthers + c, other, other2),
                              hashed(kNearBefore + c, top_bits(before, bits, kBeforeBits)),
                              hashed(kOnPlane + c, plane, few), hashed(kInCell + c, cell, few)},
                             bits, value);
    }
    other2 = other;
    other = top_bits(value, bits, kOtherBits);
    few = top_bits(value, bits, kFewBits);
    before_that_[c] = before;
    before_[c] = value;
    if constexpr (Coder::kDecodes) set_code(out_ + at, component, size, value);
  }
}

}  // namespace gicodec::native
