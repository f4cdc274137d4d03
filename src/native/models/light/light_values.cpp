// Directions and colours of one hemisphere (docs/native.md, "Vertices").
#include "native/models/light/light_model.h"

#include "base/binary_coder.h"

#include <algorithm>

namespace gicodec::native {
namespace {

// What a context is for, the first number of its hash; what is added: 1 for the second of two
// numbers alike, 2 for the second of two opposite hemispheres.
enum Role : std::uint32_t {
  kAcross = 10,  // of a direction's coordinates across the axis: five
  kAlong = 30,   // five, and three of the sign
  kExponent = 40,
  kGreen = 60,
  kOther = 80,
  kAcrossSign = 200,
  kAlongSign = 212,
  kExponentSign = 216,
  kGreenSign = 222,
  kOtherSign = 228,
};
// Ways of numbers.
enum Way : unsigned {
  kAcrossWay = 0,
  kAlongWay = 4,
  kExponentWay = 5,
  kGreenWay = 7,
  kOtherWay = 9
};

/// Half octaves with a sign, −9 to 9, as 0 to 18.
std::uint32_t signed_octave(std::int64_t value) {
  constexpr int kMost = 9;
  const int size =
      std::min(static_cast<int>(half_octave(static_cast<std::uint64_t>(std::abs(value)))), kMost);
  return static_cast<std::uint32_t>(kMost + (value < 0 ? -size : size));
}
/// A difference of codes, modulo 2^32.
std::int64_t apart_from(std::int32_t code, std::int32_t predicted) {
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
  Direction around{}, closing{};  ///< by guesses; by sums
  std::int64_t closing_sum = 0;   ///< of the colours, along `closing`
  std::uint32_t spread = 0, green_spread = 0, distance = 0;
  std::uint32_t share = 0;  ///< of what was coded beside what closes
  std::uint32_t off = 0;    ///< octave of the direction's residuals
  HemisphereLight light;

  [[nodiscard]] bool closes() const { return closed != 0; }
  [[nodiscard]] const Direction& predicted() const { return closes() ? closing : around; }
};

template <typename Coder>
void LightModel::code_direction(Coder& coder, Hemisphere& here, LightCodes& now) {
  constexpr std::uint32_t kNothing = 20;
  const unsigned h = here.h;
  const Direction& predicted = here.predicted();
  const unsigned bits = form_.direction_bits();
  std::int64_t before = 0;
  for (unsigned g = 0; g < h; ++g) before += std::abs(off_[g][0]) + std::abs(off_[g][1]);
  const std::uint32_t mean_off = h != 0 ? octave(before * 2 / h) : kNothing;
  const auto along_code =
      static_cast<std::uint32_t>(std::abs(predicted[here.along]) * kSnormCodes >> 28);
  std::array<std::int64_t, 2>& off = off_[h];
  off = {};
  for (unsigned j = 0; j < 2; ++j) {
    const std::size_t axis = j == 0 ? here.first : here.second;
    const unsigned place = here.closed + j;
    const LightForm::Predicted code = form_.direction_code(predicted[axis]);
    const std::uint32_t apart =
        here.closes() ? signed_octave(half_codes(here.around[axis] - here.closing[axis])) : 0;
    const std::uint32_t first_off = j == 0 ? 0 : width_of(off[0]);
    const auto size = static_cast<std::uint32_t>(std::abs(predicted[axis]) * kSnormCodes >> 28);
    const std::uint32_t opposite = here.closes() ? here.share
                                   : h % 2 != 0  ? octave(off_[h - 1][j])
                                                 : kNothing;
    const std::int64_t told = apart_from(now.direction[axis], code.code);
    off[j] = values_->number(
        coder, kAcrossWay + place,
        {hashed(kAcross + place, here.spread, first_off),
         hashed(kAcross + 4 + place, opposite, first_off, h),
         hashed(kAcross + 8 + place, here.distance, size, along_code),
         hashed(kAcross + 12 + place, here.spread, opposite,
                std::min(static_cast<std::uint32_t>(guesses_.all().size()), 9U)),
         hashed(kAcross + 16 + place, here.closes() ? apart : mean_off, here.share, first_off)},
        {{{hashed(kAcrossSign + place, sign_of(off[0]) * 32 + apart), 0},
          {hashed(kAcrossSign + 4 + place, code.quarter), sign_of(off[0])},
          {hashed(kAcrossSign + 8 + place, h, apart), 0}}},
        told);
    now.direction[axis] =
        static_cast<std::int32_t>(signed_of(static_cast<std::uint32_t>(code.code + off[j]), bits));
    here.light.direction[axis] = form_.direction_of(now.direction[axis]);
  }
  here.off = octave(std::abs(off[0]) + std::abs(off[1]));

  // What is left to unit length.
  const std::int64_t u = here.light.direction[here.first], v = here.light.direction[here.second];
  const std::int64_t left = kUnitLength * kUnitLength - u * u - v * v;
  const std::int64_t length = left > 0 ? root_of(left) : 0;
  const LightForm::Predicted code = form_.direction_code(length);
  const auto mirrored = [&](std::int32_t c) {
    return !here.negative ? c : form_.shared() ? -c : ~c;
  };
  const auto steps = static_cast<std::uint32_t>((length * kSnormCodes + kUnitLength / 2) >> 24);
  const std::int64_t expected = here.negative ? -predicted[here.along] : predicted[here.along];
  const std::uint32_t apart = signed_octave(half_codes(expected - length) >> 1);
  const auto slope = static_cast<std::uint32_t>((std::abs(u) + std::abs(v)) /
                                                std::max(length, kUnitLength / kSnormCodes));
  const std::uint32_t few = std::min(steps, 40U);
  const std::int64_t told = apart_from(mirrored(now.direction[here.along]), code.code);
  const std::int64_t rest = values_->number(
      coder, kAlongWay,
      {hashed(kAlong, few), hashed(kAlong + 1, slope, code.quarter),
       hashed(kAlong + 2, steps / 4, code.quarter), hashed(kAlong + 3, std::min(slope, 4U), apart),
       hashed(kAlong + 4, few, apart)},
      {{{hashed(kAlongSign, code.quarter), 0},
        {hashed(kAlongSign + 1, apart), 0},
        {hashed(kAlongSign + 2, few, apart), 0}}},
      told);
  now.direction[here.along] = static_cast<std::int32_t>(signed_of(
      static_cast<std::uint32_t>(mirrored(static_cast<std::int32_t>(code.code + rest))), bits));
  here.light.direction[here.along] = form_.direction_of(now.direction[here.along]);
}

template <typename Coder>
void LightModel::code_colors(Coder& coder, Hemisphere& here, LightCodes& now) {
  constexpr std::uint32_t kNothing = 20;
  const unsigned h = here.h;
  const LightGuesses::Completion& completion = guesses_.completion(h);
  const bool completes = completion.siblings != 0;
  const std::uint32_t closes = here.closes() || completes ? 1 : 0;
  std::array<std::int64_t, LightGuesses::kMost> more{};
  for (unsigned i = 0; i < guesses_.all().size(); ++i) {
    more[i] = directions_apart(guesses_.all()[i].light[h].direction, here.light.direction);
  }
  guesses_.weigh(more, h + 1);
  const Color mean = guesses_.mean_color(h);
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
    sum = std::min((here.closing_sum >> 10) * ratio >> 18, 3 * kMostColor);
    const std::int64_t of_mean = mean[0] + mean[1] + mean[2];
    for (unsigned c = 0; c < 3; ++c) {
      color[c] = of_mean > 0 ? proportion(mean[c], sum, of_mean) : std::min(sum / 3, kMostColor);
    }
  }
  if (completes) color = completion.color;
  const std::uint32_t apart =
      completes       ? completion.siblings
      : here.closes() ? signed_octave(color[1] > 0 ? (mean[1] - color[1]) * 32 / color[1] : 0)
                      : 0;
  // How many of the record's steps the mean may be off.
  const auto rounding = [&](const LightCodes& codes) {
    const std::int64_t step = std::max<std::int64_t>(form_.color_step(codes, guesses_.top()), 1);
    return octave(std::min(4 * completion.siblings * completion.unit / step, kMostRatio));
  };
  std::int64_t before = 0;
  for (unsigned g = 0; g < h; ++g) before += std::abs(off_green_[g]);
  const std::uint32_t mean_off = h != 0 ? octave(before * 2 / h) : kNothing;
  const auto last_exponent = static_cast<std::uint32_t>(
      h != 0 ? std::clamp<std::int64_t>(off_exponent_[h - 1], -2, 2) + 2 : 0);
  std::uint32_t exponent_off = 2;

  if (form_.shared()) {
    const std::int64_t brightest = std::max({color[0], color[1], color[2], std::int64_t{1}});
    const int predicted = form_.exponent_of(brightest, guesses_.top());
    const auto mantissa =
        static_cast<std::uint32_t>(form_.color_code(brightest, predicted, guesses_.top())) / 32;
    if (completes) here.share = rounding({{}, predicted, 0, {}});
    const unsigned place = kExponent + closes;
    const std::int64_t off = values_->number(
        coder, kExponentWay + closes,
        {hashed(place, mantissa, here.green_spread), hashed(place + 2, mantissa, here.distance),
         hashed(place + 4, mantissa, here.off),
         hashed(place + 6, mantissa, closes != 0 ? here.share : last_exponent),
         hashed(place + 8, mantissa, apart, h)},
        {{{hashed(kExponentSign + closes, mantissa), 0},
          {hashed(kExponentSign + 2 + closes, last_exponent, mantissa), 0},
          {hashed(kExponentSign + 4 + closes, apart, mantissa), 0}}},
        now.exponent - predicted);
    now.exponent = static_cast<std::int32_t>(predicted + off) & 31;
    off_exponent_[h] = now.exponent - predicted;
    exponent_off = static_cast<std::uint32_t>(std::clamp(now.exponent - predicted, -2, 2) + 2);
  }

  const auto code_of = [&](std::int64_t c) {
    return form_.color_code(c, now.exponent, guesses_.top());
  };
  const auto code = [&](unsigned c, unsigned way, std::int32_t predicted, const ValueContexts& by,
                        const std::array<FlagContext, kFlagContexts>& signs) {
    const std::int64_t told = apart_from(now.color[c], predicted);
    const std::int64_t off = values_->number(coder, way, by, signs, told);
    const std::int64_t value = predicted + off;
    now.color[c] = form_.color_of_bits(value);
    here.light.color[c] = form_.color_of(now.color[c], now.exponent, guesses_.top());
    return off;
  };
  const std::int32_t green = code_of(color[1]);
  if (completes) here.share = rounding({{0, green, 0}, now.exponent, 0, {}});
  const std::uint32_t size = octave(green);
  const unsigned place = kGreen + closes;
  const std::uint32_t last_off = h != 0 ? octave(off_green_[h - 1]) : kNothing;
  const std::uint32_t last_sign = h != 0 ? sign_of(off_green_[h - 1]) : 1;
  const std::int64_t off = code(
      1, kGreenWay + closes, green,
      {hashed(place, size, here.green_spread), hashed(place + 2, size, here.distance, exponent_off),
       hashed(place + 4, size, here.off, mean_off),
       hashed(place + 6, closes != 0 ? here.share : last_off, size, exponent_off),
       hashed(place + 8, closes != 0 ? apart : mean_off, size, h)},
      {{{hashed(kGreenSign + closes, exponent_off, last_exponent), last_sign},
        {hashed(kGreenSign + 2 + closes, size, exponent_off), 0},
        {hashed(kGreenSign + 4 + closes, apart, h), 0}}});
  off_green_[h] = off;

  for (unsigned i = 0; i < guesses_.all().size(); ++i) {
    more[i] += colors_apart(Color{guesses_.all()[i].light[h].color[1], 0, 0},
                            Color{here.light.color[1], 0, 0});
  }
  guesses_.weigh(more, h + 1);
  const Color alike = guesses_.mean_color(h);
  std::int64_t red_off = 0;
  for (unsigned j = 0; j < 2; ++j) {
    const unsigned c = 2 * j;
    const std::int64_t in_ratio =
        alike[1] > 0 && !completes ? proportion(alike[c], here.light.color[1], alike[1]) : color[c];
    const std::int64_t rest =
        std::max<std::int64_t>(sum - here.light.color[1] - here.light.color[0], 0);
    const bool by_sum = here.closes() && j == 1;
    const std::int32_t predicted = code_of(by_sum ? std::min(rest, kMostColor) : in_ratio);
    const std::uint32_t bright = octave(predicted), green_size = octave(off),
                        red_size = octave(red_off),
                        noise = octave(guesses_.ratio_spread(h, c, alike));
    const std::uint32_t sum_apart =
        by_sum ? signed_octave(std::int64_t{code_of(in_ratio)} - predicted) : 0;
    const unsigned at = kOther + 2 * closes + j, sign = kOtherSign + 2 * closes + j;
    const std::int64_t other =
        code(c, kOtherWay + 2 * closes + j, predicted,
             {hashed(at, bright, noise), hashed(at + 4, bright, green_size, here.share),
              hashed(at + 8, red_size, noise, std::min(green_size, 8U)),
              hashed(at + 12, closes != 0 ? here.share : here.distance, bright, red_size),
              hashed(at + 16, bright, closes != 0 ? sum_apart : mean_off, here.off)},
             {{{hashed(sign, sign_of(off) * 3 + sign_of(red_off), sum_apart), 0},
               {hashed(sign + 4, bright, sign_of(red_off)), 0},
               {hashed(sign + 8, sign_of(off), green_size), 0}}});
    if (j == 0) red_off = other;
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
  here.distance = std::min(guesses_.all().empty() ? 9U : guesses_.all()[0].distance, 9U);

  guesses_.weigh(std::array<std::int64_t, LightGuesses::kMost>{}, h);
  here.green_spread = octave(guesses_.green_spread(h));
  if (form_.directed()) {
    const LightGuesses::Around around = guesses_.around(h);
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
    here.closing_sum = std::min(length >> (24 - kSumCut), 3 * kMostColor);
    here.share = octave(here.closing_sum > 0 ? std::min(coded * 4 / here.closing_sum, kMostRatio)
                                             : kMostRatio);
  }
  if (form_.directed()) code_direction(coder, here, now);
  code_colors(coder, here, now);
  learn(h, here.light);
}

template void LightModel::code_hemisphere(BinaryEncoder&, unsigned, LightCodes&);
template void LightModel::code_hemisphere(BinaryDecoder&, unsigned, LightCodes&);

}  // namespace gicodec::native
