// The record model in blocks of one row, which have no rows above: by similar records and copies.
#include "base/binary_coder.h"
#include "native/models/numbers.h"
#include "native/models/records/record_contexts.h"
#include "native/models/records/record_model.h"

namespace gicodec::native {
namespace {

constexpr unsigned kRowChangedMixer = 0, kDownMixer = 80, kLowMixer = 96, kCopyMixer = 208;
constexpr unsigned kChannels =
    static_cast<unsigned>(kMaxComponents);  ///< of components, from here on
constexpr unsigned kRowTopBits = 4, kHighBits = 4, kLowNodes = 7;

}  // namespace

template <typename Coder>
bool RecordModel::code_changed_in_row(Coder& coder, const Seen& here, std::uint32_t index,
                                      bool changed) {
  constexpr std::uint32_t kFew = 7, kMany = 15;
  const Record& record = desc_.record;
  const unsigned last = record.count - 1U;
  const SimilarRecord& similar = similar_.of(here.previous);
  // A listed block has a change: if none came before, the last known record has one.
  const bool must = changes_ == 0 && left_ == 0;
  const std::uint32_t known = here.known ? 1 : 0;
  std::uint32_t similar_change = 0;
  if (here.known && similar.seen && !must) {
    similar_change = similar.changed ? 2 + std::min(kFew, width_of(similar.residual[last])) : 1;
  }
  const std::uint32_t was =
      top_bits(here.previous[last], record.components[last].bits, kRowTopBits);
  return values_->flag(
      coder, kRowChangedMixer + known,
      {{{hashed(kRowChanged, known, similar_change, must ? 1U : 0U), must ? 0 : was},
        {hashed(kRowChanged2, known, std::min(left_, kFew), must ? 0 : history_ & 3),
         std::min(changes_, kMany)},
        {hashed(kRowChanged3, known, must ? 64U : std::min(index, 63U)), similar_change}}},
      changed);
}

/// Of the record that changed last; of components before it, or their negative, as in rotated
/// matrices.
template <typename Coder>
bool RecordModel::code_copy(Coder& coder, unsigned place, Seen& here, std::uint32_t value) {
  const unsigned c = order_[place];
  const Component& component = desc_.record.components[c];
  std::array<std::uint32_t, 2 * kMaxComponents> passed{here.previous[c]};
  std::size_t count = 1;
  const auto is = [&](std::uint32_t candidate, std::uint32_t from, unsigned of) {
    const auto end = passed.begin() + count;
    if (std::find(passed.begin(), end, candidate) != end) return false;
    passed[count++] = candidate;
    const bool same = values_->flag(coder, kCopyMixer + c,
                                    {{{hashed(kCopy + c, from, of), 0},
                                      {hashed(kCopy2, from, last_copied_), 0},
                                      {hashed(kCopy3, from, last_copied_), copy_history_ & 3}}},
                                    value == candidate);
    copy_history_ = copy_history_ << 1 | (same ? 1U : 0U);
    if (from == 0) last_copied_ = same ? 1 : 2;
    if (same) here.now[c] = candidate;
    return same;
  };
  if (last_.exists && is(last_.now[c], 0, c)) return true;
  for (unsigned before = place; before-- > 0;) {
    const unsigned d = order_[before];
    if (here.now[d] == here.previous[d] || desc_.record.components[d].bits != component.bits)
      continue;
    if (is(here.now[d], 1, d)) return true;
    if (component.type != ComponentType::sfloat) continue;
    if (is(here.now[d] ^ 1U << (component.bits - 1U), 2, d)) return true;
  }
  return false;
}

/// By its difference to the previous value: its sign, then its magnitude, less 1 if it is negative.
template <typename Coder>
std::uint32_t RecordModel::code_difference(Coder& coder, unsigned c, const Seen& here,
                                           unsigned column, std::uint32_t value) {
  const unsigned bits = desc_.record.components[c].bits;
  const std::uint32_t previous = here.previous[c], actual = folded(value - previous, bits);
  const SimilarRecord& similar = similar_.of(here.previous);
  const std::int32_t similar_residual = similar.residual[c], last_by = last_.residual[c];
  const std::uint32_t similar_sign = similar.seen ? 1 + sign_of(similar_residual) : 0;
  const std::int32_t above = static_cast<std::int32_t>(previous) - similar.previous[c];
  const std::uint32_t gap =
      similar.seen ? 1 + (above < 0 ? 0U : 4U) + std::min(3U, width_of(above) / 2) : 0;
  const bool down = values_->flag(
      coder, kDownMixer + c,
      {{{hashed(kDown + c, similar_sign), sign_of(last_by) * 4 + sign_of(w(column).residual[c])},
        {hashed(kDownPrevious + c, top_bits(previous, bits, kRowTopBits)), similar_sign},
        {hashed(kDownSimilar + c, similar_sign, gap), std::min(7U, width_of(similar_residual))}}},
      (actual & 1) != 0);
  const std::uint32_t sign = down ? 1 : 0;

  // How much others changed in this direction.
  const auto size = [down](std::int32_t by, unsigned unit) {
    return by != 0 && (by < 0) == down ? 1 + static_cast<std::uint32_t>(std::abs(by)) / unit : 0U;
  };
  constexpr std::uint32_t kStill = 100, kOpposed = 101, kNone = 102;
  const std::uint32_t similar_size = !similar.seen                    ? kNone
                                     : similar_residual == 0          ? kStill
                                     : size(similar_residual, 4) == 0 ? kOpposed
                                                                      : size(similar_residual, 4);
  const unsigned high_bits = std::min(kHighBits, bits - 1), low_bits = bits - 1 - high_bits;
  const std::uint32_t high =
      values_->value(coder, kChannels + c,
                     {hashed(kHigh + c, size(similar.before[c], 8), sign),
                      hashed(kHighSimilar + c, similar_size, gap, sign),
                      hashed(kHighPrevious + c, previous >> 2, sign),
                      hashed(kHighLast + c, similar_size >> 1, size(last_by, 8) >> 1, sign),
                      hashed(kHighBoth + c, previous >> 5, similar_size >> 1, sign)},
                     high_bits,
                     // NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult)
                     actual >> 1 >> low_bits);  // Components have a bit or more.

  // By the value that results, since often few values occur there.
  const std::uint32_t by = high << low_bits;
  const std::uint32_t at = ((down ? previous - by : previous + by) & largest(bits)) >> low_bits;
  std::uint32_t node = 1;
  for (unsigned left = low_bits; left-- > 0;) {
    const bool bit = values_->flag(coder, kLowMixer + kLowNodes * c + node - 1,
                                   {{{hashed(kLow + c, high, previous & 3, sign), node},
                                     {hashed(kLowPlace + c, at, previous & 3, sign), node},
                                     {hashed(kLowHalf + c, at >> 4, previous & 3, sign), node}}},
                                   (actual >> 1 >> left & 1) != 0);
    node = node << 1 | (bit ? 1U : 0U);
  }
  const std::uint32_t size_told = by | (node - (1U << low_bits));
  return (previous + unfolded(size_told << 1 | sign, bits)) & largest(bits);
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
