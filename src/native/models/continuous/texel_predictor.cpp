#include "native/models/continuous/texel_predictor.h"

#include "native/models/continuous/light_scale.h"
#include "native/models/numbers.h"

#include <algorithm>
#include <bit>

namespace gicodec::native {
namespace {

constexpr int kMaxUnitsUp = 8, kMaxUnitsDown = 30;

/// The plane through three texels, between two of them.
std::int64_t plane(std::int64_t w, std::int64_t n, std::int64_t nw) {
  const auto [low, high] = std::minmax(w, n);
  return nw >= high ? low : nw <= low ? high : w + n - nw;
}

// Weights of predictions fall with the third power of their errors.
constexpr unsigned kWeightPower = 3, kOctave = 16, kMaxOctaves = 16, kErrorFloor = 12;
/// 65536·2^(−i/16), rounded.
constexpr std::array<std::uint32_t, kOctave> kPowers = {65536, 62757, 60097, 57549, 55109, 52773,
                                                        50535, 48393, 46341, 44376, 42495, 40693,
                                                        38968, 37316, 35734, 34219};
/// Sixteenths of an octave.
std::uint32_t logarithm(std::uint32_t value) {
  const auto width = static_cast<unsigned>(std::bit_width(value));
  const std::uint32_t digits = width <= 5 ? value << (5 - width) : value >> (width - 5);
  return width * kOctave + (digits & (kOctave - 1));
}

// The filter's weights are of 2^16.
constexpr unsigned kWeightBits = 16, kStepBits = 28, kInputBits = 20;
constexpr std::int64_t kFilterRate = 1000, kMaxFilterWeight = 1 << 19;
constexpr std::int64_t kLeastPower = 256;

std::int64_t clamped(std::int64_t value, std::int64_t most) {
  return std::clamp(value, -most, most);
}

}  // namespace

struct TexelPredictor::Around {
  std::int64_t w, n, nw, ne, ww, nn, z, zw, zn;
};

void TexelPredictor::reset(const Raster& raster, const ChannelForms& forms) {
  channels_ = raster.channels();
  coded_ = static_cast<unsigned>(forms.coded().size());
  std::copy(forms.coded().begin(), forms.coded().end(), channel_.begin());
  lead_ = coded_ > 0 && channels_.shared && channel_[0] == 0 ? 1 : 0;
  for (unsigned k = 0; k < coded_; ++k) {
    const Channel& channel = channels_.channel[channel_[k]];
    const auto& palette = forms[channel_[k]].palette;
    largest_[k] = forms.has_places(channel_[k]) ? static_cast<std::int64_t>(palette.size()) - 1
                                                : std::int64_t{channel.largest()};
  }
  const std::size_t row = raster.size().x, slice = row * raster.size().y;
  const std::size_t kept = (raster.size().z > 1 ? slice : row) + row + 2;
  ring_ = std::bit_ceil(kept) - 1;
  traces_.assign((ring_ + 1) * coded_, {});
  filter_.fill({});
  for (auto& filter : filter_) filter.weight[0] = filter.weight[1] = 1 << (kWeightBits - 1);
}

/// Of mantissas in units of the exponent `exponent`.
std::int64_t TexelPredictor::value(const std::uint32_t* ordinals, unsigned c,
                                   std::uint32_t exponent) const {
  const std::int64_t value = std::int64_t{ordinals[c]} << kFraction;
  if (!channels_.channel[c].in_units) return value;
  const int up = static_cast<int>(ordinals[0]) - static_cast<int>(exponent);
  if (up >= 0) return value << std::min(up, kMaxUnitsUp);
  const int down = std::min(-up, kMaxUnitsDown);
  return (value + (std::int64_t{1} << (down - 1))) >> down;
}

TexelPredictor::Around TexelPredictor::around(const Raster& raster, const Place& p,
                                              unsigned c) const {
  const std::uint32_t exponent = raster.now(p.here)[0];
  const auto at = [&](std::size_t texel) { return value(raster.now(texel), c, exponent); };
  Around a{at(p.w), at(p.n), at(p.nw), at(p.ne), at(p.ww), at(p.nn), 0, 0, 0};
  if (p.deep) {
    a.z = at(p.z);
    a.zw = at(p.zw);
    a.zn = at(p.zn);
  }
  return a;
}

/// Differences to a base of values around, then of channels before.
void TexelPredictor::find_inputs(const Raster& raster, const Place& p, unsigned k,
                                 const Around& own) {
  const bool past = raster.has_past();
  const std::uint32_t exponent = raster.now(p.here)[0];
  const auto now = [&](std::size_t texel, unsigned c) {
    return value(raster.now(texel), c, exponent);
  };
  const auto before = [&](std::size_t texel, unsigned c) {
    return value(raster.past(texel), c, exponent);
  };
  const unsigned c = channel_[k];
  const std::int64_t base = past ? before(p.here, c) : (own.w + own.n) >> 1;
  inputs_.count = 0;
  for (const std::int64_t v : {own.w, own.n, own.nw, own.ne, own.ww, own.nn}) inputs_.add(v - base);
  if (raster.size().z > 1) {
    for (const std::int64_t v : {own.z, own.zw, own.zn}) inputs_.add(p.deep ? v - base : 0);
  }
  if (past) {
    inputs_.add(before(p.w, c) - base);
    inputs_.add(before(p.n, c) - base);
  }
  for (unsigned lead = lead_; lead < std::min(k, lead_ + kMostLeads); ++lead) {
    const unsigned l = channel_[lead];
    const std::int64_t w = now(p.w, l), n = now(p.n, l);
    const std::int64_t lead_base = past ? before(p.here, l) : (w + n) >> 1;
    inputs_.add(now(p.here, l) - lead_base);
    inputs_.add(w - lead_base);
    inputs_.add((past ? n : now(p.nw, l)) - lead_base);
    if (lead == lead_) inputs_.add(now(p.ne, l) - lead_base);
  }
}

Prediction TexelPredictor::predict(const Raster& raster, const ChannelForms& forms, const Place& p,
                                   unsigned k) {
  const unsigned c = channel_[k];
  const Around a = around(raster, p, c);
  find_inputs(raster, p, k, a);
  const std::uint32_t exponent = raster.now(p.here)[0];
  const bool past = raster.has_past(), follows = k > lead_;
  std::int64_t sum = 0;
  for (unsigned i = 0; i < inputs_.count; ++i) sum += filter_[k].weight[i] * inputs_.value[i];
  sum >>= kWeightBits;

  Prediction result{};
  auto& g = result.guess;
  const std::int64_t mean = (a.w + a.n) >> 1, by_plane = plane(a.w, a.n, a.nw);
  result.w = a.w;
  result.n = a.n;
  g[0] = by_plane;
  g[1] = mean + sum;
  g[2] = a.w + a.ne - a.n;
  g[3] = p.deep ? a.z : a.w;
  g[4] = (a.w + ((a.ne - a.nw) >> 1) + a.n) >> 1;
  g[5] = (2 * a.w + 2 * a.n + a.nw + a.ne + a.ww + a.nn) >> 3;
  g[6] = (3 * a.w + 3 * a.n - 2 * a.nw) >> 2;
  g[7] = mean;
  if (p.deep) {
    g[5] = a.z + a.w - a.zw;
    g[6] = a.z + a.n - a.zn;
  }
  const auto difference = [](std::int64_t x, std::int64_t y) { return x > y ? x - y : y - x; };
  result.gradient =
      (difference(a.w, a.nw) + difference(a.n, a.nw) + difference(a.n, a.ne)) >> kFraction;
  if (follows) {
    const unsigned l = channel_[lead_];
    const auto lead = [&](std::size_t texel) { return value(raster.now(texel), l, exponent); };
    const std::int64_t now = lead(p.here), w = lead(p.w), n = lead(p.n);
    g[2] = by_plane + now - plane(w, n, lead(p.nw));
    g[7] = mean + now - ((w + n) >> 1);
  }
  if (past) {
    const auto before = [&](std::size_t texel, unsigned channel) {
      return value(raster.past(texel), channel, exponent);
    };
    const std::int64_t t = before(p.here, c), w = before(p.w, c), n = before(p.n, c);
    g[1] = t + sum;
    g[3] = t;
    g[4] = t + ((a.w - w + a.n - n) >> 1);
    g[7] = t + a.w - w;
    if (follows) {
      const unsigned l = channel_[lead_];
      g[7] = t + value(raster.now(p.here), l, exponent) - before(p.here, l);
    }
    result.gradient = (difference(a.w, w) + difference(a.n, n)) >> kFraction;
  }
  g[8] = g[9] = by_plane;
  if (follows) guess_by_light(raster, forms, p, k, result);
  result.mean = std::clamp<std::int64_t>(weighted(p, k, result), 0, largest_[k] << kFraction);
  return result;
}

std::int64_t TexelPredictor::light(const ChannelForms& forms, unsigned c,
                                   const std::uint32_t* ordinals, std::uint32_t exponent) const {
  const Channel& channel = channels_.channel[c];
  if (channel.in_units) return value(ordinals, c, exponent);
  const auto& palette = forms[c].palette;
  return light_of(channel, palette.empty() ? ordinals[c] : palette[ordinals[c]]);
}

std::int64_t TexelPredictor::guess_of_light(const ChannelForms& forms, unsigned c,
                                            std::int64_t light) const {
  const Channel& channel = channels_.channel[c];
  if (channel.in_units) return light;
  const std::int64_t ordinal = ordinal_of_light(channel, light);
  const auto& palette = forms[c].palette;
  if (palette.empty()) return ordinal;
  const auto at = std::lower_bound(palette.begin(), palette.end() - 1, rounded(ordinal));
  return static_cast<std::int64_t>(at - palette.begin()) << kFraction;
}

/// In proportion to the lead.
void TexelPredictor::guess_by_light(const Raster& raster, const ChannelForms& forms, const Place& p,
                                    unsigned k, Prediction& prediction) const {
  const unsigned c = channel_[k], l = channel_[lead_];
  if (channels_.channel[c].scale == Scale::none || channels_.channel[l].scale == Scale::none)
    return;
  const std::uint32_t exponent = raster.now(p.here)[0];
  const auto at = [&](unsigned channel, std::size_t texel) {
    return light(forms, channel, raster.now(texel), exponent);
  };
  const std::int64_t lead = at(l, p.here), lead_w = at(l, p.w), lead_n = at(l, p.n);
  const std::int64_t w = at(c, p.w), n = at(c, p.n);
  const auto in_proportion_to_lead = [&](std::int64_t own, std::int64_t of, std::int64_t& guess) {
    if (lead < 0 || own < 0 || of <= 0) return;
    const std::uint64_t light =
        in_proportion(static_cast<std::uint64_t>(own), static_cast<std::uint64_t>(lead),
                      static_cast<std::uint64_t>(of));
    guess = guess_of_light(forms, c, static_cast<std::int64_t>(light));
  };
  if (lead_w >= 0 && lead_n >= 0 && w >= 0 && n >= 0) {
    in_proportion_to_lead(w + n, lead_w + lead_n, prediction.guess[8]);
  }
  if (raster.has_past()) {
    in_proportion_to_lead(light(forms, c, raster.past(p.here), exponent),
                          light(forms, l, raster.past(p.here), exponent), prediction.guess[9]);
  } else {
    in_proportion_to_lead(plane(w, n, at(c, p.nw)), plane(lead_w, lead_n, at(l, p.nw)),
                          prediction.guess[9]);
  }
}

std::int64_t TexelPredictor::weighted(const Place& p, unsigned k,
                                      const Prediction& prediction) const {
  const auto &w = trace(p.w, k).error, &n = trace(p.n, k).error, &ne = trace(p.ne, k).error,
             &nw = trace(p.nw, k).error, &ww = trace(p.ww, k).error;
  const auto& z = trace(p.deep ? p.z : p.w, k).error;
  std::array<std::uint32_t, kGuesses> error;
  for (unsigned i = 0; i < kGuesses; ++i) {
    error[i] = std::uint32_t{w[i]} + n[i] + ne[i] + ((std::uint32_t{nw[i]} + ww[i]) >> 1) +
               (p.deep ? z[i] : 0U);
    error[i] = logarithm(error[i] + kErrorFloor);
  }
  const std::uint32_t least = *std::min_element(error.begin(), error.end());
  std::int64_t weights = 0, sum = 0;
  for (unsigned i = 0; i < kGuesses; ++i) {
    const std::uint32_t worse = kWeightPower * (error[i] - least);
    if (worse >= kMaxOctaves * kOctave) continue;
    std::int64_t weight = kPowers[worse % kOctave] >> (worse / kOctave);
    if (i == 1) weight *= 2;
    weights += weight;
    sum += weight * (prediction.guess[i] - prediction.guess[0]);
  }
  const std::int64_t half = weights / 2;
  return prediction.guess[0] + (sum + (sum < 0 ? -half : half)) / weights;
}

void TexelPredictor::learn(const Raster& raster, const Place& p, unsigned k,
                           const Prediction& prediction, std::int64_t residual) {
  const unsigned c = channel_[k], bits = channels_.channel[c].bits();
  const std::int64_t actual = std::int64_t{raster.now(p.here)[c]} << kFraction;
  Trace& here = trace(p.here, k);
  here.residual = static_cast<std::int32_t>(clamped(residual, INT32_MAX));
  const unsigned coarse = bits > 16 ? bits - 16 : 0;
  for (unsigned i = 0; i < kGuesses; ++i) {
    const std::int64_t off = prediction.guess[i] - actual;
    here.error[i] = static_cast<std::uint16_t>(
        std::min<std::int64_t>(UINT16_MAX, (off < 0 ? -off : off) >> coarse));
  }
  // Normalised least mean squares.
  const unsigned shift = bits + kFraction > kInputBits ? bits + kFraction - kInputBits : 0;
  std::int64_t power = kLeastPower;
  for (unsigned i = 0; i < inputs_.count; ++i) {
    std::int64_t& input = inputs_.value[i];
    input = clamped(input >> shift, std::int64_t{1} << kInputBits);
    power += input * input;
  }
  const std::int64_t off =
      clamped((actual - prediction.guess[1]) >> shift, std::int64_t{1} << kInputBits);
  const std::int64_t step = off * kFilterRate * (std::int64_t{1} << kStepBits) / power;
  for (unsigned i = 0; i < inputs_.count; ++i) {
    std::int32_t& weight = filter_[k].weight[i];
    const std::int64_t change =
        (step * inputs_.value[i] + (std::int64_t{1} << (kStepBits - 1))) >> kStepBits;
    weight = static_cast<std::int32_t>(clamped(weight + change, kMaxFilterWeight));
  }
}

void TexelPredictor::pass(const Place& p) {
  for (unsigned k = 0; k < coded_; ++k) {
    const Trace& w = trace(p.w, k);
    Trace& here = trace(p.here, k);
    here.residual = 0;
    for (unsigned i = 0; i < kGuesses; ++i) {
      here.error[i] = static_cast<std::uint16_t>(w.error[i] >> 1);
    }
  }
}

}  // namespace gicodec::native
