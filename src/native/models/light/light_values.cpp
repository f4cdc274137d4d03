// Directions and colours of one hemisphere (docs/native/hemispheres.md, docs/native/light.md).
#include "native/models/light/light_model.h"

#include "base/binary_coder.h"
#include "native/models/light/light_contexts.h"

#include <algorithm>

namespace gicodec::native {
namespace {

// Channels of numbers.
enum Channel : unsigned {
  kAcrossChannel = 0,
  kAlongChannel = 4,
  kExponentChannel = 5,
  kGreenChannel = 7,
  kOtherChannel = 9
};

/// Half octaves with a sign, −9 to 9, as 0 to 18.
std::uint32_t signed_octave(std::int64_t value) {
  constexpr int kMax = 9;
  const int size =
      std::min(static_cast<int>(half_octave(static_cast<std::uint64_t>(std::abs(value)))), kMax);
  return static_cast<std::uint32_t>(kMax + (value < 0 ? -size : size));
}
/// Modulo 2^32.
std::int64_t code_difference(std::int32_t code, std::int32_t predicted) {
  return signed_of(static_cast<std::uint32_t>(code) - static_cast<std::uint32_t>(predicted), 32);
}
std::uint32_t octave(std::int64_t value) {
  return half_octave(static_cast<std::uint64_t>(std::abs(value)));
}
/// In halves of 1/127.
std::int64_t half_codes(std::int64_t coordinate) {
  return (coordinate * 2 * kSnormCodes + kUnitLength / 2) >> 24;
}

}  // namespace

/// What is known of the hemisphere that is coded.
struct LightModel::Hemisphere {
  unsigned h = 0;
  std::size_t along = 0, first = 1, second = 2;  ///< coordinates: of the axis, across it
  bool negative = false;
  std::uint32_t closed = 0;       ///< 2 for the second of two that are not the first two, else 0
  Direction around{}, closing{};  ///< by predictors; by sums
  std::int64_t closing_sum = 0;   ///< of the colours, along `closing`
  std::uint32_t spread = 0, green_spread = 0, distance = 0;
  std::uint32_t share = 0;     ///< of what was coded beside what closes
  std::uint32_t residual = 0;  ///< octave of the direction's residuals
  HemisphereLight light;

  [[nodiscard]] bool closes() const { return closed != 0; }
  [[nodiscard]] const Direction& predicted() const { return closes() ? closing : around; }
};

template <typename Coder>
void LightModel::code_direction(Coder& coder, Hemisphere& here, LightCodes& now) {
  constexpr std::uint32_t kNone = 20;
  const unsigned h = here.h;
  const Direction& predicted = here.predicted();
  const unsigned bits = encoding_.direction_bits();
  std::int64_t before = 0;
  for (unsigned g = 0; g < h; ++g)
    before += std::abs(direction_residual_[g][0]) + std::abs(direction_residual_[g][1]);
  const std::uint32_t mean_residual = h != 0 ? octave(before * 2 / h) : kNone;
  const auto along_code =
      static_cast<std::uint32_t>(std::abs(predicted[here.along]) * kSnormCodes >> 28);
  std::array<std::int64_t, 2>& residual = direction_residual_[h];
  residual = {};
  for (unsigned j = 0; j < 2; ++j) {
    const std::size_t axis = j == 0 ? here.first : here.second;
    const unsigned place = here.closed + j;
    const LightEncoding::Predicted code = encoding_.direction_code(predicted[axis]);
    const std::uint32_t deviation =
        here.closes() ? signed_octave(half_codes(here.around[axis] - here.closing[axis])) : 0;
    const std::uint32_t first_width = j == 0 ? 0 : width_of(residual[0]);
    const auto size = static_cast<std::uint32_t>(std::abs(predicted[axis]) * kSnormCodes >> 28);
    const std::uint32_t opposite = here.closes() ? here.share
                                   : h % 2 != 0  ? octave(direction_residual_[h - 1][j])
                                                 : kNone;
    const std::int64_t difference = code_difference(now.direction[axis], code.code);
    residual[j] =
        values_->number(coder, kAcrossChannel + place,
                        {hashed(kAcross + place, here.spread, first_width),
                         hashed(kAcross + 4 + place, opposite, first_width, h),
                         hashed(kAcross + 8 + place, here.distance, size, along_code),
                         hashed(kAcross + 12 + place, here.spread, opposite,
                                std::min(static_cast<std::uint32_t>(predictors_.all().size()), 9U)),
                         hashed(kAcross + 16 + place, here.closes() ? deviation : mean_residual,
                                here.share, first_width)},
                        {{{hashed(kAcrossSign + place, sign_of(residual[0]) * 32 + deviation), 0},
                          {hashed(kAcrossSign + 4 + place, code.quarter), sign_of(residual[0])},
                          {hashed(kAcrossSign + 8 + place, h, deviation), 0}}},
                        difference);
    now.direction[axis] = static_cast<std::int32_t>(
        signed_of(static_cast<std::uint32_t>(code.code + residual[j]), bits));
    here.light.direction[axis] = encoding_.direction_of(now.direction[axis]);
  }
  here.residual = octave(std::abs(residual[0]) + std::abs(residual[1]));

  // The rest to unit length.
  const std::int64_t u = here.light.direction[here.first], v = here.light.direction[here.second];
  const std::int64_t left = kUnitLength * kUnitLength - u * u - v * v;
  const std::int64_t length = left > 0 ? root_of(left) : 0;
  const LightEncoding::Predicted code = encoding_.direction_code(length);
  const auto mirrored = [&](std::int32_t c) {
    return !here.negative ? c : encoding_.shared() ? -c : ~c;
  };
  const auto steps = static_cast<std::uint32_t>((length * kSnormCodes + kUnitLength / 2) >> 24);
  const std::int64_t expected = here.negative ? -predicted[here.along] : predicted[here.along];
  const std::uint32_t deviation = signed_octave(half_codes(expected - length) >> 1);
  const auto slope = static_cast<std::uint32_t>((std::abs(u) + std::abs(v)) /
                                                std::max(length, kUnitLength / kSnormCodes));
  const std::uint32_t few = std::min(steps, 40U);
  const std::int64_t difference = code_difference(mirrored(now.direction[here.along]), code.code);
  const std::int64_t rest = values_->number(
      coder, kAlongChannel,
      {hashed(kAlong, few), hashed(kAlong + 1, slope, code.quarter),
       hashed(kAlong + 2, steps / 4, code.quarter),
       hashed(kAlong + 3, std::min(slope, 4U), deviation), hashed(kAlong + 4, few, deviation)},
      {{{hashed(kAlongSign, code.quarter), 0},
        {hashed(kAlongSign + 1, deviation), 0},
        {hashed(kAlongSign + 2, few, deviation), 0}}},
      difference);
  now.direction[here.along] = static_cast<std::int32_t>(signed_of(
      static_cast<std::uint32_t>(mirrored(static_cast<std::int32_t>(code.code + rest))), bits));
  here.light.direction[here.along] = encoding_.direction_of(now.direction[here.along]);
}

template <typename Coder>
void LightModel::code_colors(Coder& coder, Hemisphere& here, LightCodes& now) {
  constexpr std::uint32_t kNone = 20;
  const unsigned h = here.h;
  const LightPredictors::Completion& completion = predictors_.completion(h);
  const bool completes = completion.siblings != 0;
  const std::uint32_t closes = here.closes() || completes ? 1 : 0;
  std::array<std::int64_t, LightPredictors::kMax> more{};
  for (unsigned i = 0; i < predictors_.all().size(); ++i) {
    more[i] = direction_distance(predictors_.all()[i].light[h].direction, here.light.direction);
  }
  predictors_.weigh(more, h + 1);
  const Color mean = predictors_.mean_color(h);
  Color color = mean;
  std::int64_t sum = 0;
  if (here.closes()) {
    std::int64_t along = 0, squared = 0;
    for (unsigned i = 0; i < 3; ++i) {
      along += here.closing[i] * here.light.direction[i];
      squared += here.light.direction[i] * here.light.direction[i];
    }
    const std::int64_t ratio =
        along > 0 ? std::min((along << 8) / std::max<std::int64_t>(squared >> 20, 1),
                             std::int64_t{1} << 29)
                  : 0;
    sum = std::min((here.closing_sum >> 10) * ratio >> 18, 3 * kMaxColor);
    const std::int64_t of_mean = mean[0] + mean[1] + mean[2];
    for (unsigned c = 0; c < 3; ++c) {
      color[c] = of_mean > 0 ? proportion(mean[c], sum, of_mean) : std::min(sum / 3, kMaxColor);
    }
  }
  if (completes) color = completion.color;
  const std::uint32_t deviation =
      completes       ? completion.siblings
      : here.closes() ? signed_octave(color[1] > 0 ? (mean[1] - color[1]) * 32 / color[1] : 0)
                      : 0;
  // The error of the mean, at most, in steps of the record.
  const auto rounding = [&](const LightCodes& codes) {
    const std::int64_t step =
        std::max<std::int64_t>(encoding_.color_step(codes, predictors_.top()), 1);
    return octave(std::min(4 * completion.siblings * completion.unit / step, kMaxRatio));
  };
  std::int64_t before = 0;
  for (unsigned g = 0; g < h; ++g) before += std::abs(green_residual_[g]);
  const std::uint32_t mean_residual = h != 0 ? octave(before * 2 / h) : kNone;
  const auto last_exponent = static_cast<std::uint32_t>(
      h != 0 ? std::clamp<std::int64_t>(exponent_residual_[h - 1], -2, 2) + 2 : 0);
  std::uint32_t exponent_class = 2;

  if (encoding_.shared()) {
    const std::int64_t brightest = std::max({color[0], color[1], color[2], std::int64_t{1}});
    const int predicted = encoding_.exponent_of(brightest, predictors_.top());
    const auto mantissa =
        static_cast<std::uint32_t>(encoding_.color_code(brightest, predicted, predictors_.top())) /
        32;
    if (completes) here.share = rounding({{}, predicted, 0, {}});
    const unsigned place = kExponent + closes;
    const std::int64_t residual = values_->number(
        coder, kExponentChannel + closes,
        {hashed(place, mantissa, here.green_spread), hashed(place + 2, mantissa, here.distance),
         hashed(place + 4, mantissa, here.residual),
         hashed(place + 6, mantissa, closes != 0 ? here.share : last_exponent),
         hashed(place + 8, mantissa, deviation, h)},
        {{{hashed(kExponentSign + closes, mantissa), 0},
          {hashed(kExponentSign + 2 + closes, last_exponent, mantissa), 0},
          {hashed(kExponentSign + 4 + closes, deviation, mantissa), 0}}},
        now.exponent - predicted);
    now.exponent = static_cast<std::int32_t>(predicted + residual) & 31;
    exponent_residual_[h] = now.exponent - predicted;
    exponent_class = static_cast<std::uint32_t>(std::clamp(now.exponent - predicted, -2, 2) + 2);
  }

  const auto code_of = [&](std::int64_t c) {
    return encoding_.color_code(c, now.exponent, predictors_.top());
  };
  const auto code = [&](unsigned c, unsigned channel, std::int32_t predicted,
                        const ValueContexts& by,
                        const std::array<FlagContext, kFlagContexts>& signs) {
    const std::int64_t difference = code_difference(now.color[c], predicted);
    const std::int64_t residual = values_->number(coder, channel, by, signs, difference);
    const std::int64_t value = predicted + residual;
    now.color[c] = encoding_.color_of_bits(value);
    here.light.color[c] = encoding_.color_of(now.color[c], now.exponent, predictors_.top());
    return residual;
  };
  const std::int32_t green = code_of(color[1]);
  if (completes) here.share = rounding({{0, green, 0}, now.exponent, 0, {}});
  const std::uint32_t size = octave(green);
  const unsigned place = kGreen + closes;
  const std::uint32_t last_residual = h != 0 ? octave(green_residual_[h - 1]) : kNone;
  const std::uint32_t last_sign = h != 0 ? sign_of(green_residual_[h - 1]) : 1;
  const std::int64_t residual =
      code(1, kGreenChannel + closes, green,
           {hashed(place, size, here.green_spread),
            hashed(place + 2, size, here.distance, exponent_class),
            hashed(place + 4, size, here.residual, mean_residual),
            hashed(place + 6, closes != 0 ? here.share : last_residual, size, exponent_class),
            hashed(place + 8, closes != 0 ? deviation : mean_residual, size, h)},
           {{{hashed(kGreenSign + closes, exponent_class, last_exponent), last_sign},
             {hashed(kGreenSign + 2 + closes, size, exponent_class), 0},
             {hashed(kGreenSign + 4 + closes, deviation, h), 0}}});
  green_residual_[h] = residual;

  for (unsigned i = 0; i < predictors_.all().size(); ++i) {
    more[i] += color_distance(Color{predictors_.all()[i].light[h].color[1], 0, 0},
                              Color{here.light.color[1], 0, 0});
  }
  predictors_.weigh(more, h + 1);
  const Color by_green = predictors_.mean_color(h);
  std::int64_t red_residual = 0;
  for (unsigned j = 0; j < 2; ++j) {
    const unsigned c = 2 * j;
    const std::int64_t in_ratio = by_green[1] > 0 && !completes
                                      ? proportion(by_green[c], here.light.color[1], by_green[1])
                                      : color[c];
    const std::int64_t rest =
        std::max<std::int64_t>(sum - here.light.color[1] - here.light.color[0], 0);
    const bool by_sum = here.closes() && j == 1;
    const std::int32_t predicted = code_of(by_sum ? std::min(rest, kMaxColor) : in_ratio);
    const std::uint32_t bright = octave(predicted), green_size = octave(residual),
                        red_size = octave(red_residual),
                        noise = octave(predictors_.ratio_spread(h, c, by_green));
    const std::uint32_t sum_deviation =
        by_sum ? signed_octave(std::int64_t{code_of(in_ratio)} - predicted) : 0;
    const unsigned at = kOther + 2 * closes + j, sign = kOtherSign + 2 * closes + j;
    const std::int64_t other =
        code(c, kOtherChannel + 2 * closes + j, predicted,
             {hashed(at, bright, noise), hashed(at + 4, bright, green_size, here.share),
              hashed(at + 8, red_size, noise, std::min(green_size, 8U)),
              hashed(at + 12, closes != 0 ? here.share : here.distance, bright, red_size),
              hashed(at + 16, bright, closes != 0 ? sum_deviation : mean_residual, here.residual)},
             {{{hashed(sign, sign_of(residual) * 3 + sign_of(red_residual), sum_deviation), 0},
               {hashed(sign + 4, bright, sign_of(red_residual)), 0},
               {hashed(sign + 8, sign_of(residual), green_size), 0}}});
    if (j == 0) red_residual = other;
  }
}

template <typename Coder>
void LightModel::code_hemisphere(Coder& coder, unsigned h, LightCodes& now) {
  Hemisphere here;
  here.h = h;
  here.along = h / 2;
  here.first = (here.along + 1) % 3;
  here.second = (here.along + 2) % 3;
  here.negative = h % 2 != 0;
  here.distance = std::min(predictors_.all().empty() ? 9U : predictors_.all()[0].distance, 9U);

  predictors_.weigh(std::array<std::int64_t, LightPredictors::kMax>{}, h);
  here.green_spread = octave(predictors_.green_spread(h));
  if (encoding_.directed()) {
    const LightPredictors::Around around = predictors_.around(h);
    here.around = around.direction;
    here.spread = octave(around.spread);
    here.closed = h == 3 || h == 5 ? 2 : 0;
  }

  // By what the pairs before sum up to.
  if (here.closes()) {
    constexpr int kSumCut = 8;
    Direction total{}, open{};
    std::int64_t coded = 0;
    for (unsigned g = 0; g < h; ++g) {
      coded += light_[g].sum();
      const std::int64_t bright = light_[g].sum() >> kSumCut;
      for (unsigned a = 0; a < 3; ++a) {
        const std::int64_t part = light_[g].direction[a] * bright;
        (g + 1 < h ? total : open)[a] += part;
      }
    }
    for (unsigned a = 0; a < 3; ++a) total[a] = (h == 5 ? total[a] >> 1 : total[a]) - open[a];
    std::int64_t length = 0;
    here.closing = normalised(total, here.along, here.negative, length);
    here.closing_sum = std::min(length >> (24 - kSumCut), 3 * kMaxColor);
    here.share = octave(here.closing_sum > 0 ? std::min(coded * 4 / here.closing_sum, kMaxRatio)
                                             : kMaxRatio);
  }
  if (encoding_.directed()) code_direction(coder, here, now);
  code_colors(coder, here, now);
  learn(h, here.light);
}

template void LightModel::code_hemisphere(BinaryEncoder&, unsigned, LightCodes&);
template void LightModel::code_hemisphere(BinaryDecoder&, unsigned, LightCodes&);

}  // namespace gicodec::native
