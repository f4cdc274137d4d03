#include "native/models/continuous/texel_residuals.h"

#include "base/binary_coder.h"
#include "native/models/continuous/light_scale.h"
#include "native/models/continuous/raster_contexts.h"
#include "native/models/numbers.h"

#include <algorithm>

namespace gicodec::native {
namespace {

constexpr std::uint32_t kBucket = CounterTable::kBucket;
constexpr std::int64_t kNear = 31;  ///< differences to neighbours that contexts tell apart
constexpr std::uint32_t kSignKey = 100, kDigitsKey = 110;

std::uint64_t magnitude_of(std::int64_t value) {
  return static_cast<std::uint64_t>(value < 0 ? -value : value);
}
std::uint32_t near(std::int64_t difference) {
  return static_cast<std::uint32_t>(std::clamp(difference, -kNear, kNear) + kNear);
}
std::uint32_t signs(std::int64_t one, std::int64_t other) {
  return 3 * sign_of(one) + sign_of(other);
}

}  // namespace

struct TexelResiduals::Around {
  std::int64_t place;          ///< of the prediction
  ValueContexts context;       ///< of the width
  std::uint32_t energy;        ///< in half octaves
  std::uint32_t fraction;      ///< where the prediction lies between two ordinals
  std::uint32_t guess_signs;   ///< on which sides of the prediction three guesses lie
  std::uint32_t around_signs;  ///< of residuals around
  std::uint32_t value_signs;   ///< on which sides values around lie
};

void TexelResiduals::reset(const Raster& raster, const ChannelForms& forms) {
  const auto coded = forms.coded();
  for (unsigned k = 0; k < coded.size(); ++k) {
    const Channel& channel = raster.channels().channel[coded[k]];
    channel_[k] = coded[k];
    in_units_[k] = channel.in_units;
    large_ordinal_[k] = 1U << (channel.bits() - 1U);
    nearest_[k].clear();
    const auto& palette = forms[coded[k]].palette;
    if (forms.has_palette_of_mantissas(coded[k])) {
      find_nearest(channel, palette, nearest_[k]);
    }
  }
  const std::size_t widths = coded.size() * kWidths;
  widths_.assign(widths, {});
  signs_.assign(widths, {});
  digits_.assign(widths * kDigits, {});
  widths_by_energy_.assign(std::size_t{kEnergies} * kWidths, {});
  signs_by_fraction_.assign(kFractions, {});
  digits_by_width_.assign(std::size_t{kWidths} * kDigits, {});
}

std::int64_t TexelResiduals::place_of_prediction(unsigned k, std::int64_t prediction) const {
  const std::int64_t ordinal = rounded(prediction);
  if (nearest_[k].empty()) return ordinal;
  return nearest_[k][static_cast<std::size_t>(
      std::clamp<std::int64_t>(ordinal, 0, static_cast<std::int64_t>(nearest_[k].size()) - 1))];
}

TexelResiduals::Around TexelResiduals::around(const ChannelForms& forms,
                                              const TexelPredictor& predictor, const Place& p,
                                              unsigned k, const Prediction& prediction) const {
  const unsigned c = channel_[k];
  Around a{};
  a.place = place_of_prediction(k, prediction.mean);
  const std::int64_t ordinal =
      nearest_[k].empty() ? a.place
                          : std::int64_t{forms[c].palette[static_cast<std::size_t>(a.place)]};
  const std::int64_t above = prediction.mean - (ordinal << kFraction);
  a.fraction = above < -4 ? 0 : above < 0 ? 1 : above < 4 ? 2 : 3;

  const auto residual = [&](std::size_t texel) -> std::int64_t {
    return predictor.residual(texel, k);
  };
  std::uint64_t energy = 2 * (magnitude_of(residual(p.w)) + magnitude_of(residual(p.n))) +
                         magnitude_of(residual(p.nw)) + magnitude_of(residual(p.ne));
  if (p.deep) energy = (2 * energy + 6 * magnitude_of(residual(p.z))) / 3;
  a.energy = half_octave(energy);
  std::uint64_t spread = 0;
  for (const std::int64_t guess : prediction.guess) {
    spread += nearest_[k].empty()
                  ? magnitude_of(guess - (a.place << kFraction))
                  : magnitude_of(place_of_prediction(k, guess) - a.place) << kFraction;
  }
  spread >>= kFraction;
  const std::int64_t w = place_of_prediction(k, prediction.w) - a.place,
                     n = place_of_prediction(k, prediction.n) - a.place;
  const std::uint32_t units = in_units_[k] ? (large_ ? 1 : 2) : 0;
  const std::uint32_t before = half_octave(magnitude_of(residual_));
  a.context = {hashed(kNeighbours, c, near(w), near(n)),
               hashed(kPrediction, c, static_cast<std::uint32_t>(a.place)),
               hashed(kEnergy, c, 4 * a.energy + units),
               hashed(kSpread, c, half_octave(spread), a.energy >> 1),
               hashed(kGradient, c, half_octave(magnitude_of(prediction.gradient)), before,
                      sign_of(residual_))};
  const auto& g = prediction.guess;
  const auto side = [&](unsigned i) { return sign_of(g[i] - prediction.mean); };
  a.guess_signs = (3 * side(0) + side(1)) * 3 + side(2);
  a.around_signs = signs(residual(p.w), residual(p.n));
  a.value_signs = signs(w, n);
  return a;
}

template <typename Coder>
bool TexelResiduals::code(Coder& coder, CounterTable& counters, Raster& raster,
                          const ChannelForms& forms, const TexelPredictor& predictor,
                          const Place& p, unsigned k, const Prediction& prediction,
                          std::int64_t& residual) {
  const unsigned c = channel_[k];
  const bool places = !nearest_[k].empty();
  const auto& palette = forms[c].palette;
  const std::int64_t most =
      places ? static_cast<std::int64_t>(palette.size()) - 1 : predictor.largest(k);
  const Around a = around(forms, predictor, p, k, prediction);
  std::int64_t place = 0;
  if constexpr (!Coder::kDecodes) {
    const std::uint32_t ordinal = raster.now(p.here)[c];
    place = places ? nearest_[k][ordinal] : std::int64_t{ordinal};
  }
  const std::int64_t actual = place - a.place;
  const auto magnitude = static_cast<std::uint32_t>(magnitude_of(actual));
  const std::uint32_t width = code_width(coder, counters, a, k, width_of(most), width_of(actual));
  residual = 0;
  if (width > 0) {
    const bool negative = code_sign(coder, counters, a, k, width, actual < 0);
    residual = code_digits(coder, counters, a, k, width, negative, magnitude);
    if (negative) residual = -residual;
  }
  place = a.place + residual;
  if (place < 0 || place > most) return false;
  const std::uint32_t ordinal =
      places ? palette[static_cast<std::size_t>(place)] : static_cast<std::uint32_t>(place);
  if constexpr (Coder::kDecodes) raster.now(p.here)[c] = ordinal;
  large_ = large_ || (in_units_[k] && ordinal >= large_ordinal_[k]);
  residual_before_ = residual_;
  residual_ = residual;
  return true;
}

template <typename Coder>
std::uint32_t TexelResiduals::code_width(Coder& coder, CounterTable& counters, const Around& a,
                                         unsigned k, std::uint32_t most, std::uint32_t width) {
  BitCounters counter{};
  for (std::uint32_t j = 0; j < most; ++j) {
    if (j % kBucket == 0) {
      for (std::size_t i = 0; i < kValueContexts; ++i) {
        counter[i] = counters[hashed(a.context[i], j)];
      }
    }
    const bool more = code_bit(coder, counter, widths_[k * kWidths + j],
                               widths_by_energy_[a.energy * kWidths + j], width > j);
    if (!more) return j;
    for (auto& one : counter) ++one;
  }
  return most;
}

template <typename Coder>
bool TexelResiduals::code_sign(Coder& coder, CounterTable& counters, const Around& a, unsigned k,
                               std::uint32_t width, bool negative) {
  const std::uint32_t c = channel_[k], w = std::min(width, 4U);
  const ValueContexts hash{
      hashed(a.context[0], kSignKey + w), hashed(a.context[1], kSignKey + w),
      hashed(kSignAround, c, 4 * a.around_signs + a.fraction, w),
      hashed(kSignBefore, c, signs(residual_, residual_before_) + 9 * a.guess_signs, w),
      hashed(kSignNeighbours, c, a.value_signs + 9 * (half_octave(magnitude_of(residual_)) >> 1),
             w)};
  return code_bit(coder, counters_of(counters, hash), signs_[k * kWidths + width - 1],
                  signs_by_fraction_[a.fraction], negative);
}

/// The bits below the first: three are mixed, the others are bypass bits.
template <typename Coder>
std::uint32_t TexelResiduals::code_digits(Coder& coder, CounterTable& counters, const Around& a,
                                          unsigned k, std::uint32_t width, bool negative,
                                          std::uint32_t magnitude) {
  const std::uint32_t sign = negative ? 1 : 0, key = kDigitsKey + sign;
  std::uint32_t read = 1, left = width - 1;
  for (unsigned digit = 0; digit < kDigits && left > 0; ++digit) {
    --left;
    const ValueContexts hash{hashed(kDigit, channel_[k], sign, width),
                             hashed(a.context[0], key, width), hashed(a.context[1], key, width),
                             hashed(a.context[2], key, width), hashed(a.context[3], key, width)};
    BitCounters counter;
    for (std::size_t i = 0; i < kValueContexts; ++i) counter[i] = counters[hash[i]] + read;
    const bool bit =
        code_bit(coder, counter, digits_[(k * kWidths + width - 1) * kDigits + digit],
                 digits_by_width_[(width - 1) * kDigits + digit], (magnitude >> left & 1) != 0);
    read = read << 1 | (bit ? 1U : 0U);
  }
  if (left == 0) return read;
  return static_cast<std::uint32_t>(std::uint64_t{read} << left) |
         coder.bypass(left, magnitude & ((1U << left) - 1));
}

template bool TexelResiduals::code(BinaryEncoder&, CounterTable&, Raster&, const ChannelForms&,
                                   const TexelPredictor&, const Place&, unsigned, const Prediction&,
                                   std::int64_t&);
template bool TexelResiduals::code(BinaryDecoder&, CounterTable&, Raster&, const ChannelForms&,
                                   const TexelPredictor&, const Place&, unsigned, const Prediction&,
                                   std::int64_t&);

}  // namespace gicodec::native
