#include "native/models/light/light_guesses.h"

#include "quantise/set_order.h"

#include <algorithm>

namespace gicodec::native {
namespace {

constexpr std::uint32_t kLastDistance = 16;    // squared: as far as the last light counts
constexpr std::uint32_t kRest = 4 * kNearest;  // nearness of what a mean leaves
constexpr int kUnlikeBits = 14;                // of two lights that have nothing in common
constexpr std::int64_t kAlike = 32;            // less than that makes no difference
constexpr int kWeightBits = 12;

LightGuesses::Codes read_codes(const LightForm& form, const std::byte* records) {
  LightGuesses::Codes codes;
  for (std::size_t h = 0; h < kHemispheres; ++h) codes[h] = form.read(records + h * form.bytes());
  return codes;
}

int top_of(const LightForm& form, const LightGuesses::Codes& codes) {
  int top = 0;
  for (const LightCodes& one : codes) top = std::max(top, form.top(one));
  return top;
}

}  // namespace

std::int64_t directions_apart(const Direction& a, const Direction& b) {
  std::int64_t squares = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const std::int64_t d = std::abs(a[i] - b[i]) >> 14;
    squares += d * d;
  }
  return squares >> 7;
}
std::int64_t colors_apart(const Color& a, const Color& b) {
  constexpr int kDigits = 20;
  std::int64_t most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max({most, a[i], b[i]});
  const int shift = std::max(0, static_cast<int>(width_of(most)) - kDigits);
  std::int64_t apart = 0, both = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const std::int64_t p = a[i] >> shift, q = b[i] >> shift;
    apart += (p - q) * (p - q);
    both += p * p + q * q;
  }
  return both == 0 ? 0 : (apart << kUnlikeBits) / both;
}

void LightGuesses::move_past(const Lights& was, Guess& guess) const {
  for (unsigned h = 0; h < kHemispheres; ++h) {
    const HemisphereLight& own = guess_[0].light[h];
    HemisphereLight& light = guess.light[h];
    for (unsigned i = 0; i < 3; ++i) {
      light.direction[i] = std::clamp(own.direction[i] + light.direction[i] - was[h].direction[i],
                                      -kUnitLength, kUnitLength);
      light.color[i] = was[h].color[i] > 0
                           ? proportion(own.color[i], std::min(light.color[i], 4 * was[h].color[i]),
                                        was[h].color[i])
                           : std::min(own.color[i] + light.color[i], kMostColor);
    }
  }
}

LightGuesses::Lights LightGuesses::lights(const LightForm& form, const std::byte* records) const {
  const Codes codes = read_codes(form, records);
  Lights lights;
  for (unsigned h = 0; h < kHemispheres; ++h) lights[h] = form.light(codes[h], top_);
  return lights;
}

/// What a voxel is if those with light that are not coded yet share what is left of their mean;
/// the last one of them is that, but for what the mean was rounded by.
void LightGuesses::add_rest(const LightForm& form, const KnownLights::Family& family, bool moved) {
  const Codes parent = read_codes(form, family.parent.now);
  std::array<std::int64_t, kHemispheres> left{};
  for (unsigned h = 0; h < kHemispheres; ++h) left[h] = family.lit_left(h);
  const auto rest = [&](const std::byte* of_parent, const auto& child) {
    const Lights mean = this->lights(form, of_parent);
    Lights lights = mean;
    for (unsigned h = 0; h < kHemispheres; ++h) {
      for (std::int64_t& c : lights[h].color) c *= left[h];
    }
    for (unsigned i = 0; i < family.coded; ++i) {
      const Lights other = this->lights(form, child(i));
      for (unsigned h = 0; h < kHemispheres; ++h) {
        if ((family.before[i].lit >> h & 1) == 0) continue;
        for (unsigned c = 0; c < 3; ++c) lights[h].color[c] += mean[h].color[c] - other[h].color[c];
      }
    }
    for (unsigned h = 0; h < kHemispheres; ++h) {
      for (std::int64_t& c : lights[h].color) {
        c = left[h] == 0 ? 0 : std::clamp<std::int64_t>(c / left[h], 0, kMostColor);
      }
    }
    return lights;
  };
  Guess& guess = guess_[count_++];
  guess.distance = family.children - family.coded;
  guess.nearness = kRest;
  guess.unlike = 0;
  guess.light = rest(family.parent.now, [&](unsigned i) { return family.before[i].now; });
  for (unsigned h = 0; h < kHemispheres; ++h) {
    if (left[h] != 1) continue;
    Completion& completion = completion_[h];
    completion.color = guess.light[h].color;
    completion.unit = form.color_step(parent[h], top_);
    completion.siblings = family.lit_before(h) + 1;
  }
  bool known = moved && family.parent.past != nullptr;
  for (unsigned i = 0; i < family.coded; ++i) known = known && family.before[i].past != nullptr;
  if (!known) return;
  move_past(rest(family.parent.past, [&](unsigned i) { return family.before[i].past; }), guess);
}

void LightGuesses::take(const LightForm& form, const KnownLights& around,
                        std::span<const std::byte> past, const Codes* last) {
  const bool known = !past.empty();
  const std::size_t size = kHemispheres * form.bytes();
  const KnownLights::Family& family = around.family;
  const auto usable = [&](const KnownLights::Other& other) {
    return !other.dark && (!known || (other.past != nullptr && !is_zero({other.past, size})));
  };
  std::array<Codes, kMost> codes;
  std::array<const std::byte*, kMost> before{};
  count_ = 0;
  top_ = 0;
  skip_dark_ = !form.directed();
  completion_ = {};
  const auto add = [&](const Codes& those, std::uint32_t distance) {
    top_ = std::max(top_, top_of(form, those));
    codes[count_] = those;
    Guess& guess = guess_[count_++];
    guess.distance = distance;
    guess.nearness = distance == 0 ? kNearest : kNearest / distance;
    guess.unlike = 0;
  };
  if (known) add(read_codes(form, past.data()), 0);
  for (unsigned i = 0; i < around.count; ++i) {
    const KnownLights::Other& other = around.other[i];
    if (!usable(other)) continue;
    before[count_] = other.past;
    add(read_codes(form, other.now), other.distance);
  }
  const bool of_parent = family.parent.now != nullptr;
  if (of_parent) top_ = std::max(top_, top_of(form, read_codes(form, family.parent.now)));
  if (count_ == 0 && !of_parent && last != nullptr) add(*last, kLastDistance);
  if (top_ == 0) top_ = form.usual_top();

  for (unsigned i = 0; i < count_; ++i) {
    for (unsigned h = 0; h < kHemispheres; ++h) guess_[i].light[h] = form.light(codes[i][h], top_);
    if (known && i > 0) move_past(lights(form, before[i]), guess_[i]);
  }
  if (of_parent) add_rest(form, family, known);
}

void LightGuesses::weigh(std::span<const std::int64_t, kMost> more, unsigned hemispheres) {
  const auto over = static_cast<std::int64_t>(std::max(hemispheres, 1U));
  std::int64_t most = 0;
  for (unsigned i = 0; i < count_; ++i) {
    const std::int64_t apart = kAlike + (guess_[i].unlike + more[i]) / over;
    guess_[i].weight = (std::int64_t{guess_[i].nearness} << 40) / (apart * apart);
    most = std::max(most, guess_[i].weight);
  }
  const int shift = std::max(0, static_cast<int>(width_of(most)) - kWeightBits);
  for (unsigned i = 0; i < count_; ++i) guess_[i].weight >>= shift;
}

Color LightGuesses::mean_color(unsigned h) const {
  Color sum{};
  std::int64_t weights = 0;
  for (unsigned i = 0; i < count_; ++i) {
    if (skip_dark_ && guess_[i].light[h].color == Color{}) continue;
    for (unsigned c = 0; c < 3; ++c) sum[c] += guess_[i].weight * guess_[i].light[h].color[c];
    weights += guess_[i].weight;
  }
  for (std::int64_t& c : sum) c = weights > 0 ? c / weights : 0;
  return sum;
}

LightGuesses::Around LightGuesses::around(unsigned h) const {
  constexpr int kSumBits = 24, kCut = 10;
  std::int64_t brightest = 0, weights = 0;
  for (const Guess& guess : all()) {
    brightest = std::max(brightest, guess.light[h].sum());
    weights += guess.weight;
  }
  const int shift = std::max(0, static_cast<int>(width_of(brightest)) - kSumBits);
  Direction sum{};
  for (const Guess& guess : all()) {
    const HemisphereLight& light = guess.light[h];
    for (unsigned a = 0; a < 3; ++a) {
      sum[a] += guess.weight * (light.direction[a] >> kCut) * (light.sum() >> shift);
    }
  }
  const std::size_t along = h / 2;
  std::int64_t length = 0;
  Around around;
  around.direction = normalised(sum, along, h % 2 != 0, length);
  if (weights == 0) return around;
  std::int64_t spread = 0;
  for (const Guess& guess : all()) {
    const HemisphereLight& light = guess.light[h];
    for (const std::size_t a : {(along + 1) % 3, (along + 2) % 3}) {
      spread += guess.weight * std::abs(light.direction[a] - around.direction[a]);
    }
  }
  around.spread = spread / weights * kSnormCodes >> 22;
  return around;
}

std::int64_t LightGuesses::green_spread(unsigned h) const {
  constexpr std::int64_t kDark = 999;
  std::int64_t green = 0, greens = 0, weights = 0;
  for (const Guess& guess : all()) {
    if (skip_dark_ && guess.light[h].color == Color{}) continue;
    weights += guess.weight;
    green += guess.weight * guess.light[h].color[1];
  }
  if (weights == 0) return 0;
  green /= weights;
  for (const Guess& guess : all()) {
    if (skip_dark_ && guess.light[h].color == Color{}) continue;
    greens += guess.weight * std::abs(guess.light[h].color[1] - green);
  }
  return green > 0 ? std::min((greens / weights) * 64 / green, kMostRatio) : kDark;
}

std::int64_t LightGuesses::ratio_spread(unsigned h, unsigned c, const Color& mean) const {
  constexpr int kRatioBits = 12, kSpreadBits = 8;
  const auto ratio = [c](const Color& of) {
    return of[1] > 0 ? std::min((of[c] << kRatioBits) / of[1], kMostRatio) : 0;
  };
  std::int64_t spread = 0, weights = 0;
  for (const Guess& guess : all()) {
    if (skip_dark_ && guess.light[h].color == Color{}) continue;
    weights += guess.weight;
    const Color& color = guess.light[h].color;
    if (color[1] > 0) spread += guess.weight * std::abs(ratio(color) - ratio(mean));
  }
  return weights > 0 ? spread / weights >> (kRatioBits - kSpreadBits) : 0;
}

void LightGuesses::learn(unsigned h, const HemisphereLight& light) {
  for (unsigned i = 0; i < count_; ++i) {
    const HemisphereLight& guessed = guess_[i].light[h];
    guess_[i].unlike += directions_apart(guessed.direction, light.direction) +
                        colors_apart(guessed.color, light.color);
  }
}

}  // namespace gicodec::native
