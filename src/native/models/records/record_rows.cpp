// What the record model does in blocks of one row, which know no rows above: by kin and by copies.
#include "base/binary_coder.h"
#include "native/models/records/record_model.h"
#include "native/record_numbers.h"

namespace gicodec::native {
namespace {

// What a context is for, the first number of its hash; those of components are added. Others than
// those of record_model.cpp.
enum Role : std::uint32_t {
  kChanged = 4,
  kChanged2 = 5,
  kChanged3 = 6,
  kCopy2 = 10,
  kCopy3 = 11,
  kHigh = 208,
  kHighKin = 224,
  kHighPast = 240,
  kHighLast = 256,
  kHighBoth = 272,
  kDown = 400,
  kDownPast = 416,
  kDownKin = 432,
  kLow = 448,
  kLowPlace = 464,
  kLowHalf = 480,
  kCopy = 496,
};
constexpr unsigned kChangedMixer = 0, kDownMixer = 80, kLowMixer = 96, kCopyMixer = 208;
constexpr unsigned kWays = static_cast<unsigned>(kMaxComponents);  ///< of components, from here on
constexpr unsigned kTopBits = 4, kHighBits = 4, kLowNodes = 7;

}  // namespace

template <typename Coder>
bool RecordModel::code_changed_in_row(Coder& coder, const Seen& here, std::uint32_t index,
                                      bool changed) {
  constexpr std::uint32_t kFew = 7, kMany = 15;
  const Record& record = desc_.record;
  const unsigned last = record.count - 1U;
  const Kin& kin = kin_.of(here.past);
  // A block is listed because something changed: that is the last known record, or one before it.
  const bool must = changes_ == 0 && left_ == 0;
  const std::uint32_t known = here.known ? 1 : 0;
  std::uint32_t did = 0;
  if (here.known && kin.seen && !must) {
    did = kin.changed ? 2 + std::min(kFew, width_of(kin.residual[last])) : 1;
  }
  const std::uint32_t was = top_bits(here.past[last], record.components[last].bits, kTopBits);
  return values_->flag(coder, kChangedMixer + known,
                       {{{hashed(kChanged, known, did, must ? 1U : 0U), must ? 0 : was},
                         {hashed(kChanged2, known, std::min(left_, kFew), must ? 0 : history_ & 3),
                          std::min(changes_, kMany)},
                         {hashed(kChanged3, known, must ? 64U : std::min(index, 63U)), did}}},
                       changed);
}

/// Of the record that changed last; of components before it, or their opposite, as in matrices that
/// turn.
template <typename Coder>
bool RecordModel::code_copy(Coder& coder, unsigned place, Seen& here, std::uint32_t value) {
  const unsigned c = order_[place];
  const Component& component = desc_.record.components[c];
  std::array<std::uint32_t, 2 * kMaxComponents> passed{here.past[c]};
  std::size_t count = 1;
  const auto is = [&](std::uint32_t candidate, std::uint32_t from, unsigned of) {
    const auto end = passed.begin() + count;
    if (std::find(passed.begin(), end, candidate) != end) return false;
    passed[count++] = candidate;
    const bool same = values_->flag(coder, kCopyMixer + c,
                                    {{{hashed(kCopy + c, from, of), 0},
                                      {hashed(kCopy2, from, twin_), 0},
                                      {hashed(kCopy3, from, twin_), copies_ & 3}}},
                                    value == candidate);
    copies_ = copies_ << 1 | (same ? 1U : 0U);
    if (from == 0) twin_ = same ? 1 : 2;
    if (same) here.now[c] = candidate;
    return same;
  };
  if (last_.exists && is(last_.now[c], 0, c)) return true;
  for (unsigned before = place; before-- > 0;) {
    const unsigned d = order_[before];
    if (here.now[d] == here.past[d] || desc_.record.components[d].bits != component.bits) continue;
    if (is(here.now[d], 1, d)) return true;
    if (component.kind != ComponentKind::sfloat) continue;
    if (is(here.now[d] ^ 1U << (component.bits - 1U), 2, d)) return true;
  }
  return false;
}

/// By its difference to the past: whether that is negative, how large, less 1 if it is.
template <typename Coder>
std::uint32_t RecordModel::code_difference(Coder& coder, unsigned c, const Seen& here,
                                           unsigned column, std::uint32_t value) {
  const unsigned bits = desc_.record.components[c].bits;
  const std::uint32_t past = here.past[c], told = folded(value - past, bits);
  const Kin& kin = kin_.of(here.past);
  const std::int32_t kin_by = kin.residual[c], last_by = last_.residual[c];
  const std::uint32_t way = kin.seen ? 1 + sign_of(kin_by) : 0;
  const std::int32_t above = static_cast<std::int32_t>(past) - kin.past[c];
  const std::uint32_t gap =
      kin.seen ? 1 + (above < 0 ? 0U : 4U) + std::min(3U, width_of(above) / 2) : 0;
  const bool down = values_->flag(
      coder, kDownMixer + c,
      {{{hashed(kDown + c, way), sign_of(last_by) * 4 + sign_of(w(column).residual[c])},
        {hashed(kDownPast + c, top_bits(past, bits, kTopBits)), way},
        {hashed(kDownKin + c, way, gap), std::min(7U, width_of(kin_by))}}},
      (told & 1) != 0);
  const std::uint32_t sign = down ? 1 : 0;

  // By how much others moved this way.
  const auto size = [down](std::int32_t by, unsigned unit) {
    return by != 0 && (by < 0) == down ? 1 + static_cast<std::uint32_t>(std::abs(by)) / unit : 0U;
  };
  constexpr std::uint32_t kStill = 100, kOpposed = 101, kNone = 102;
  const std::uint32_t kin_size = !kin.seen              ? kNone
                                 : kin_by == 0          ? kStill
                                 : size(kin_by, 4) == 0 ? kOpposed
                                                        : size(kin_by, 4);
  const unsigned high_bits = std::min(kHighBits, bits - 1), low_bits = bits - 1 - high_bits;
  const std::uint32_t high = values_->value(
      coder, kWays + c,
      {hashed(kHigh + c, size(kin.before[c], 8), sign), hashed(kHighKin + c, kin_size, gap, sign),
       hashed(kHighPast + c, past >> 2, sign),
       hashed(kHighLast + c, kin_size >> 1, size(last_by, 8) >> 1, sign),
       hashed(kHighBoth + c, past >> 5, kin_size >> 1, sign)},
      high_bits, told >> 1 >> low_bits);

  // By where that leads to, since often few values occur there.
  const std::uint32_t by = high << low_bits;
  const std::uint32_t at = ((down ? past - by : past + by) & largest(bits)) >> low_bits;
  std::uint32_t node = 1;
  for (unsigned left = low_bits; left-- > 0;) {
    const bool bit = values_->flag(coder, kLowMixer + kLowNodes * c + node - 1,
                                   {{{hashed(kLow + c, high, past & 3, sign), node},
                                     {hashed(kLowPlace + c, at, past & 3, sign), node},
                                     {hashed(kLowHalf + c, at >> 4, past & 3, sign), node}}},
                                   (told >> 1 >> left & 1) != 0);
    node = node << 1 | (bit ? 1U : 0U);
  }
  const std::uint32_t size_told = by | (node - (1U << low_bits));
  return (past + unfolded(size_told << 1 | sign, bits)) & largest(bits);
}

template bool RecordModel::code_changed_in_row(BinaryEncoder&, const Seen&, std::uint32_t, bool);
template bool RecordModel::code_changed_in_row(BinaryDecoder&, const Seen&, std::uint32_t, bool);
template bool RecordModel::code_copy(BinaryEncoder&, unsigned, Seen&, std::uint32_t);
template bool RecordModel::code_copy(BinaryDecoder&, unsigned, Seen&, std::uint32_t);
template std::uint32_t RecordModel::code_difference(BinaryEncoder&, unsigned, const Seen&, unsigned,
                                                    std::uint32_t);
template std::uint32_t RecordModel::code_difference(BinaryDecoder&, unsigned, const Seen&, unsigned,
                                                    std::uint32_t);

}  // namespace gicodec::native
