// The numbers of the record model: a component that changed is predicted in several ways, and its
// residual coded (docs/native/records.md, "Numbers").
#include "base/binary_coder.h"
#include "native/models/numbers.h"
#include "native/models/records/record_contexts.h"
#include "native/models/records/record_model.h"

#include <algorithm>

namespace gicodec::native {
namespace {

/// Of what a component is predicted.
enum class ValueScale { previous, codes, linear };
ValueScale scale_of(const Component& component, bool mantissa) {
  if (mantissa) return ValueScale::linear;
  if (component.bits > 16 || component.type == ComponentType::opaque ||
      component.type == ComponentType::exponent) {
    return ValueScale::previous;
  }
  return component.type == ComponentType::unorm || component.type == ComponentType::uint
             ? ValueScale::linear
             : ValueScale::codes;
}

}  // namespace

/// Predictions of a component: its previous value; by the change of the records around; that and
/// the error of the lead component's; by the lead component's change and the usual ratio of both.
std::array<std::uint64_t, RecordModel::kPredictors> RecordModel::predictions(
    unsigned c, const Seen& here, unsigned column) const {
  const ValueScale scale = scale_of(desc_.record.components[c], in_units(c));
  const std::uint64_t previous = scaled(c, here.previous);
  if (scale == ValueScale::previous) return {previous, previous, previous, previous};
  std::uint64_t now = 0, before = 0, weights = 0;
  const auto add = [&](const Seen& seen, std::uint64_t weight) {
    if (!seen.known) return;
    now += weight * scaled(c, seen.now);
    before += weight * scaled(c, seen.previous);
    weights += weight;
  };
  add(w(column), 2);
  add(n(column), 2);
  add(nw(column), 1);
  add(ne(column), 1);
  const auto moved = [](std::uint64_t from, std::int64_t by) {
    const std::int64_t to = static_cast<std::int64_t>(from) + by;
    return std::clamp<std::uint64_t>(to < 0 ? 0 : static_cast<std::uint64_t>(to), 0,
                                     kMaxPrediction);
  };
  std::array<std::uint64_t, kPredictors> prediction{previous, previous, previous, previous};
  if (scale == ValueScale::linear) {
    if (before + previous != 0)
      prediction[1] = in_proportion(previous, now + previous, before + previous);
  } else {
    const auto change = static_cast<std::int64_t>(now) - static_cast<std::int64_t>(before);
    prediction[1] = moved(previous, change / static_cast<std::int64_t>(weights + 1));
  }
  prediction[2] = prediction[1];
  if (lead_prediction_ == 0) return prediction;
  if (scale == ValueScale::linear) {
    prediction[2] = in_proportion(prediction[1], lead_now_, lead_prediction_);
  } else {
    prediction[2] = moved(prediction[1], static_cast<std::int64_t>(lead_now_) -
                                             static_cast<std::int64_t>(lead_prediction_));
  }
  if (moved_[lead_] != 0) {
    const auto size = static_cast<std::uint64_t>(std::abs(lead_change_));
    const auto by = static_cast<std::int64_t>(in_proportion(size, moved_[c], moved_[lead_]));
    prediction[3] = moved(previous, lead_change_ < 0 ? -by : by);
  }
  return prediction;
}

template <typename Coder>
std::uint32_t RecordModel::code_number(Coder& coder, unsigned place, Seen& here, unsigned column,
                                       std::uint32_t value) {
  const unsigned c = order_[place];
  const unsigned bits = desc_.record.components[c].bits;
  const std::uint32_t most = largest(bits);
  const unsigned unit = in_units(c) ? here.now[exponent_] : 0;
  const std::array<std::uint64_t, kPredictors> prediction = predictions(c, here, column);
  std::array<std::uint32_t, kPredictors> code;
  std::size_t best = 0;
  for (std::size_t i = 0; i < kPredictors; ++i) {
    const std::uint64_t rounded = (prediction[i] + ((std::uint64_t{1} << unit) >> 1)) >> unit;
    code[i] = static_cast<std::uint32_t>(std::min<std::uint64_t>(rounded, most));
    if (error_[c][i] < error_[c][best]) best = i;
  }
  const std::uint32_t predicted = code[best];

  const auto size = [c](const Seen& seen) {
    return static_cast<std::uint64_t>(std::abs(std::int64_t{seen.residual[c]}));
  };
  const Seen &left = w(column), &up = n(column);
  const std::uint64_t energy = 2 * (size(left) + size(up)) + size(nw(column)) + size(ne(column));
  const std::uint32_t known = (left.known ? 1U : 0U) + (up.known ? 2U : 0U);
  const std::uint32_t width = width_of(predicted);
  const std::uint32_t scale =
      width == 0 ? 0
                 : width * 4 +
                       static_cast<std::uint32_t>(std::uint64_t{predicted} << 2 >> (width - 1) & 3);
  const int shift =
      in_units(c)
          ? std::clamp(static_cast<int>(unit) - static_cast<int>(here.previous[exponent_]), -3, 3) +
                3
          : 0;
  const auto shifted = static_cast<std::uint32_t>(shift);
  const std::uint32_t r1 = width_of(residual_), r2 = width_of(residual_before_);
  const FlagContext sign{hashed(kSign + c, sign_of(left.residual[c]) * 3 + sign_of(up.residual[c])),
                         sign_of(last_.residual[c])};
  const FlagContext others{hashed(kSignOthers + c, shifted),
                           sign_of(residual_) * 3 + sign_of(residual_before_)};
  const std::int64_t actual = signed_of(value - predicted, bits);
  const std::int64_t residual = values_->number(
      coder, c,
      {hashed(kAround + c, half_octave(energy), known), hashed(kOthers + c, r1, r2, coded_),
       hashed(kBoth + c, half_octave(energy / 2), r1, std::min(place, 3U)),
       hashed(kSize + c, scale, shifted),
       hashed(kNoise + c, half_octave(static_cast<std::uint64_t>(noise_[c])),
              width_of(last_.residual[c]))},
      {{sign, others, {hashed(sign.hash, others.hash, sign.index), others.index}}}, actual);
  value = (predicted + static_cast<std::uint32_t>(residual)) & most;

  for (std::size_t i = 0; i < kPredictors; ++i) {
    const std::int64_t distance = std::abs(std::int64_t{code[i]} - std::int64_t{value});
    const auto error = static_cast<std::int32_t>(std::min<std::int64_t>(distance, 4095)) * 64;
    error_[c][i] += (error - error_[c][i]) >> 4;
  }
  const auto magnitude = static_cast<std::int32_t>(
      std::min<std::int64_t>(std::abs(residual), std::int64_t{1} << 20) * 16);
  noise_[c] += (magnitude - noise_[c]) >> 4;
  here.residual[c] = static_cast<std::int32_t>(signed_of(value - predicted, bits));
  here.now[c] = value;
  const auto change = static_cast<std::int64_t>(scaled(c, here.now)) -
                      static_cast<std::int64_t>(scaled(c, here.previous));
  moved_[c] += static_cast<std::uint64_t>(std::abs(change)) - (moved_[c] >> 4);
  if (lead_prediction_ == 0 &&
      scale_of(desc_.record.components[c], in_units(c)) != ValueScale::previous) {
    lead_ = c;
    lead_now_ = scaled(c, here.now);
    lead_prediction_ = std::max<std::uint64_t>(prediction[1], 1);
    lead_change_ = change;
  }
  ++coded_;
  residual_before_ = residual_;
  residual_ = here.residual[c];
  return value;
}

template std::uint32_t RecordModel::code_number(BinaryEncoder&, unsigned, Seen&, unsigned,
                                                std::uint32_t);
template std::uint32_t RecordModel::code_number(BinaryDecoder&, unsigned, Seen&, unsigned,
                                                std::uint32_t);

}  // namespace gicodec::native
