#include "native/models/light/light_predictors.h"

#include "quantise/set_order.h"

#include <algorithm>

namespace gicodec::native {
namespace {

constexpr std::uint32_t kLastDistance = 16;     // squared: as far as the last light counts
constexpr std::uint32_t kRest = 4 * kNearest;   // nearness of the rest of a mean
constexpr int kDissimilarityBits = 14;          // of two lights without anything in common
constexpr std::int64_t kMinDissimilarity = 32;  // below it all are equal
constexpr int kWeightBits = 12;

LightPredictors::Codes read_codes(const LightEncoding& encoding, const std::byte* records) {
  LightPredictors::Codes codes;
  for (std::size_t h = 0; h < kHemispheres; ++h)
    codes[h] = encoding.read(records + h * encoding.bytes());
  return codes;
}

int top_of(const LightEncoding& encoding, const LightPredictors::Codes& codes) {
  int top = 0;
  for (const LightCodes& one : codes) top = std::max(top, encoding.top(one));
  return top;
}

}  // namespace

std::int64_t direction_distance(const Direction& a, const Direction& b) {
  std::int64_t squares = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const std::int64_t d = std::abs(a[i] - b[i]) >> 14;
    squares += d * d;
  }
  return squares >> 7;
}
std::int64_t color_distance(const Color& a, const Color& b) {
  constexpr int kDigits = 20;
  std::int64_t most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max({most, a[i], b[i]});
  const int shift = std::max(0, static_cast<int>(width_of(most)) - kDigits);
  std::int64_t distance = 0, both = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const std::int64_t p = a[i] >> shift, q = b[i] >> shift;
    distance += (p - q) * (p - q);
    both += p * p + q * q;
  }
  return both == 0 ? 0 : (distance << kDissimilarityBits) / both;
}

void LightPredictors::add_change(const Lights& was, Predictor& predictor) const {
  for (unsigned h = 0; h < kHemispheres; ++h) {
    const HemisphereLight& own = predictor_[0].light[h];
    HemisphereLight& light = predictor.light[h];
    for (unsigned i = 0; i < 3; ++i) {
      light.direction[i] = std::clamp(own.direction[i] + light.direction[i] - was[h].direction[i],
                                      -kUnitLength, kUnitLength);
      light.color[i] = was[h].color[i] > 0
                           ? proportion(own.color[i], std::min(light.color[i], 4 * was[h].color[i]),
                                        was[h].color[i])
                           : std::min(own.color[i] + light.color[i], kMaxColor);
    }
  }
}

LightPredictors::Lights LightPredictors::lights(const LightEncoding& encoding,
                                                const std::byte* records) const {
  const Codes codes = read_codes(encoding, records);
  Lights lights;
  for (unsigned h = 0; h < kHemispheres; ++h) lights[h] = encoding.light(codes[h], top_);
  return lights;
}

/// The predictor of a voxel if those with light that are not coded yet share the rest of their
/// mean equally; the last one of them is that, but for the rounding of the mean.
void LightPredictors::add_rest(const LightEncoding& encoding, const KnownLights::Siblings& siblings,
                               bool moved) {
  const Codes parent = read_codes(encoding, siblings.parent.now);
  std::array<std::int64_t, kHemispheres> left{};
  for (unsigned h = 0; h < kHemispheres; ++h) left[h] = siblings.lit_left(h);
  const auto rest = [&](const std::byte* of_parent, const auto& child) {
    const Lights mean = this->lights(encoding, of_parent);
    Lights lights = mean;
    for (unsigned h = 0; h < kHemispheres; ++h) {
      for (std::int64_t& c : lights[h].color) c *= left[h];
    }
    for (unsigned i = 0; i < siblings.coded; ++i) {
      const Lights other = this->lights(encoding, child(i));
      for (unsigned h = 0; h < kHemispheres; ++h) {
        if ((siblings.before[i].lit >> h & 1) == 0) continue;
        for (unsigned c = 0; c < 3; ++c) lights[h].color[c] += mean[h].color[c] - other[h].color[c];
      }
    }
    for (unsigned h = 0; h < kHemispheres; ++h) {
      for (std::int64_t& c : lights[h].color) {
        c = left[h] == 0 ? 0 : std::clamp<std::int64_t>(c / left[h], 0, kMaxColor);
      }
    }
    return lights;
  };
  Predictor& predictor = predictor_[count_++];
  predictor.distance = siblings.children - siblings.coded;
  predictor.nearness = kRest;
  predictor.dissimilarity = 0;
  predictor.light = rest(siblings.parent.now, [&](unsigned i) { return siblings.before[i].now; });
  for (unsigned h = 0; h < kHemispheres; ++h) {
    if (left[h] != 1) continue;
    Completion& completion = completion_[h];
    completion.color = predictor.light[h].color;
    completion.unit = encoding.color_step(parent[h], top_);
    completion.siblings = siblings.lit_before(h) + 1;
  }
  bool known = moved && siblings.parent.previous != nullptr;
  for (unsigned i = 0; i < siblings.coded; ++i)
    known = known && siblings.before[i].previous != nullptr;
  if (!known) return;
  add_change(
      rest(siblings.parent.previous, [&](unsigned i) { return siblings.before[i].previous; }),
      predictor);
}

void LightPredictors::take(const LightEncoding& encoding, const KnownLights& around,
                           std::span<const std::byte> previous, const Codes* last) {
  const bool known = !previous.empty();
  const std::size_t size = kHemispheres * encoding.bytes();
  const KnownLights::Siblings& siblings = around.siblings;
  const auto usable = [&](const KnownLights::Neighbour& other) {
    return !other.dark &&
           (!known || (other.previous != nullptr && !is_zero({other.previous, size})));
  };
  std::array<Codes, kMax> codes;
  std::array<const std::byte*, kMax> before{};
  count_ = 0;
  top_ = 0;
  skip_dark_ = !encoding.directed();
  completion_ = {};
  const auto add = [&](const Codes& those, std::uint32_t distance) {
    top_ = std::max(top_, top_of(encoding, those));
    codes[count_] = those;
    Predictor& predictor = predictor_[count_++];
    predictor.distance = distance;
    predictor.nearness = distance == 0 ? kNearest : kNearest / distance;
    predictor.dissimilarity = 0;
  };
  if (known) add(read_codes(encoding, previous.data()), 0);
  for (unsigned i = 0; i < around.count; ++i) {
    const KnownLights::Neighbour& other = around.other[i];
    if (!usable(other)) continue;
    before[count_] = other.previous;
    add(read_codes(encoding, other.now), other.distance);
  }
  const bool of_parent = siblings.parent.now != nullptr;
  if (of_parent) top_ = std::max(top_, top_of(encoding, read_codes(encoding, siblings.parent.now)));
  if (count_ == 0 && !of_parent && last != nullptr) add(*last, kLastDistance);
  if (top_ == 0) top_ = encoding.default_top();

  for (unsigned i = 0; i < count_; ++i) {
    for (unsigned h = 0; h < kHemispheres; ++h)
      predictor_[i].light[h] = encoding.light(codes[i][h], top_);
    if (known && i > 0) add_change(lights(encoding, before[i]), predictor_[i]);
  }
  if (of_parent) add_rest(encoding, siblings, known);
}

void LightPredictors::weigh(std::span<const std::int64_t, kMax> more, unsigned hemispheres) {
  const auto over = static_cast<std::int64_t>(std::max(hemispheres, 1U));
  std::int64_t most = 0;
  for (unsigned i = 0; i < count_; ++i) {
    const std::int64_t distance =
        kMinDissimilarity + (predictor_[i].dissimilarity + more[i]) / over;
    predictor_[i].weight = (std::int64_t{predictor_[i].nearness} << 40) / (distance * distance);
    most = std::max(most, predictor_[i].weight);
  }
  const int shift = std::max(0, static_cast<int>(width_of(most)) - kWeightBits);
  for (unsigned i = 0; i < count_; ++i) predictor_[i].weight >>= shift;
}

Color LightPredictors::mean_color(unsigned h) const {
  Color sum{};
  std::int64_t weights = 0;
  for (unsigned i = 0; i < count_; ++i) {
    if (skip_dark_ && predictor_[i].light[h].color == Color{}) continue;
    for (unsigned c = 0; c < 3; ++c)
      sum[c] += predictor_[i].weight * predictor_[i].light[h].color[c];
    weights += predictor_[i].weight;
  }
  for (std::int64_t& c : sum) c = weights > 0 ? c / weights : 0;
  return sum;
}

LightPredictors::Around LightPredictors::around(unsigned h) const {
  constexpr int kSumBits = 24, kCut = 10;
  std::int64_t brightest = 0, weights = 0;
  for (const Predictor& predictor : all()) {
    brightest = std::max(brightest, predictor.light[h].sum());
    weights += predictor.weight;
  }
  const int shift = std::max(0, static_cast<int>(width_of(brightest)) - kSumBits);
  Direction sum{};
  for (const Predictor& predictor : all()) {
    const HemisphereLight& light = predictor.light[h];
    for (unsigned a = 0; a < 3; ++a) {
      sum[a] += predictor.weight * (light.direction[a] >> kCut) * (light.sum() >> shift);
    }
  }
  const std::size_t along = h / 2;
  std::int64_t length = 0;
  Around around;
  around.direction = normalised(sum, along, h % 2 != 0, length);
  if (weights == 0) return around;
  std::int64_t spread = 0;
  for (const Predictor& predictor : all()) {
    const HemisphereLight& light = predictor.light[h];
    for (const std::size_t a : {(along + 1) % 3, (along + 2) % 3}) {
      spread += predictor.weight * std::abs(light.direction[a] - around.direction[a]);
    }
  }
  around.spread = spread / weights * kSnormCodes >> 22;
  return around;
}

std::int64_t LightPredictors::green_spread(unsigned h) const {
  constexpr std::int64_t kDark = 999;
  std::int64_t green = 0, greens = 0, weights = 0;
  for (const Predictor& predictor : all()) {
    if (skip_dark_ && predictor.light[h].color == Color{}) continue;
    weights += predictor.weight;
    green += predictor.weight * predictor.light[h].color[1];
  }
  if (weights == 0) return 0;
  green /= weights;
  for (const Predictor& predictor : all()) {
    if (skip_dark_ && predictor.light[h].color == Color{}) continue;
    greens += predictor.weight * std::abs(predictor.light[h].color[1] - green);
  }
  return green > 0 ? std::min((greens / weights) * 64 / green, kMaxRatio) : kDark;
}

std::int64_t LightPredictors::ratio_spread(unsigned h, unsigned c, const Color& mean) const {
  constexpr int kRatioBits = 12, kSpreadBits = 8;
  const auto ratio = [c](const Color& of) {
    return of[1] > 0 ? std::min((of[c] << kRatioBits) / of[1], kMaxRatio) : 0;
  };
  std::int64_t spread = 0, weights = 0;
  for (const Predictor& predictor : all()) {
    if (skip_dark_ && predictor.light[h].color == Color{}) continue;
    weights += predictor.weight;
    const Color& color = predictor.light[h].color;
    if (color[1] > 0) spread += predictor.weight * std::abs(ratio(color) - ratio(mean));
  }
  return weights > 0 ? spread / weights >> (kRatioBits - kSpreadBits) : 0;
}

void LightPredictors::learn(unsigned h, const HemisphereLight& light) {
  for (unsigned i = 0; i < count_; ++i) {
    const HemisphereLight& predicted = predictor_[i].light[h];
    predictor_[i].dissimilarity += direction_distance(predicted.direction, light.direction) +
                                   color_distance(predicted.color, light.color);
  }
}

}  // namespace gicodec::native
