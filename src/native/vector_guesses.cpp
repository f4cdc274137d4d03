#include "native/vector_guesses.h"

#include "payload/set_order.h"

#include <algorithm>

namespace gicodec::native {
namespace {

constexpr std::uint32_t kLastDistance = 16;  // squared: as far as the last vertex counts
constexpr int kUnlikeBits = 14;              // of two lights that have nothing in common
constexpr std::int64_t kAlike = 32;          // less than that makes no difference
constexpr int kWeightBits = 12;
constexpr int kQuantisedTop = 16, kFloatTop = 127;  // where there is no light

VectorGuesses::Vertex read_vertex(const VectorForm& form, const std::byte* records) {
  VectorGuesses::Vertex vertex;
  for (std::size_t h = 0; h < kHemispheres; ++h) vertex[h] = form.read(records + h * form.bytes());
  return vertex;
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

void VectorGuesses::move_past(const VectorForm& form, const std::byte* before, Guess& guess) const {
  const Vertex old = read_vertex(form, before);
  for (unsigned h = 0; h < kHemispheres; ++h) {
    const HemisphereLight was = form.light(old[h], top_);
    const HemisphereLight& own = guess_[0].light[h];
    HemisphereLight& light = guess.light[h];
    for (unsigned i = 0; i < 3; ++i) {
      light.direction[i] = std::clamp(own.direction[i] + light.direction[i] - was.direction[i],
                                      -kUnitLength, kUnitLength);
      light.color[i] =
          was.color[i] > 0
              ? proportion(own.color[i], std::min(light.color[i], 4 * was.color[i]), was.color[i])
              : std::min(own.color[i] + light.color[i], kMostColor);
    }
  }
}

void VectorGuesses::take(const VectorForm& form, const KnownVertices& around,
                         std::span<const std::byte> past, const Vertex* last) {
  const bool known = !past.empty();
  const std::size_t size = kHemispheres * form.bytes();
  const auto usable = [&](const KnownVertices::Vertex& vertex) {
    return !vertex.dark && (!known || (vertex.past != nullptr && !is_zero({vertex.past, size})));
  };
  std::array<Vertex, kMost> codes;
  std::array<const std::byte*, kMost> before{};
  count_ = 0;
  top_ = 0;
  const auto add = [&](const Vertex& vertex, std::uint32_t distance) {
    for (const VectorCodes& one : vertex) top_ = std::max(top_, form.top(one));
    codes[count_] = vertex;
    Guess& guess = guess_[count_++];
    guess.distance = distance;
    guess.nearness = distance == 0 ? kNearest : kNearest / distance;
    guess.unlike = 0;
  };
  if (known) add(read_vertex(form, past.data()), 0);
  for (unsigned i = 0; i < around.count; ++i) {
    const KnownVertices::Vertex& vertex = around.vertex[i];
    if (!usable(vertex)) continue;
    before[count_] = vertex.past;
    add(read_vertex(form, vertex.now), vertex.distance);
  }
  if (count_ == 0 && last != nullptr) add(*last, kLastDistance);
  if (top_ == 0) top_ = form.floats() ? kFloatTop : kQuantisedTop;

  for (unsigned i = 0; i < count_; ++i) {
    for (unsigned h = 0; h < kHemispheres; ++h) guess_[i].light[h] = form.light(codes[i][h], top_);
    if (known && i > 0) move_past(form, before[i], guess_[i]);
  }
}

void VectorGuesses::weigh(std::span<const std::int64_t, kMost> more, unsigned hemispheres) {
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

Color VectorGuesses::mean_color(unsigned h) const {
  Color sum{};
  std::int64_t weights = 0;
  for (unsigned i = 0; i < count_; ++i) {
    for (unsigned c = 0; c < 3; ++c) sum[c] += guess_[i].weight * guess_[i].light[h].color[c];
    weights += guess_[i].weight;
  }
  for (std::int64_t& c : sum) c = weights > 0 ? c / weights : 0;
  return sum;
}

VectorGuesses::Around VectorGuesses::around(unsigned h) const {
  constexpr int kSumBits = 24, kCut = 10;
  constexpr std::int64_t kDark = 999;
  std::int64_t brightest = 0, weights = 0, green = 0;
  for (const Guess& guess : all()) {
    brightest = std::max(brightest, guess.light[h].sum());
    weights += guess.weight;
    green += guess.weight * guess.light[h].color[1];
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
  green /= weights;
  std::int64_t spread = 0, greens = 0;
  for (const Guess& guess : all()) {
    const HemisphereLight& light = guess.light[h];
    for (const std::size_t a : {(along + 1) % 3, (along + 2) % 3}) {
      spread += guess.weight * std::abs(light.direction[a] - around.direction[a]);
    }
    greens += guess.weight * std::abs(light.color[1] - green);
  }
  around.spread = spread / weights * kSnormCodes >> 22;
  around.green_spread = green > 0 ? std::min((greens / weights) * 64 / green, kMostRatio) : kDark;
  return around;
}

std::int64_t VectorGuesses::ratio_spread(unsigned h, unsigned c, const Color& mean) const {
  constexpr int kRatioBits = 12, kSpreadBits = 8;
  const auto ratio = [c](const Color& of) {
    return of[1] > 0 ? std::min((of[c] << kRatioBits) / of[1], kMostRatio) : 0;
  };
  std::int64_t spread = 0, weights = 0;
  for (const Guess& guess : all()) {
    weights += guess.weight;
    const Color& color = guess.light[h].color;
    if (color[1] > 0) spread += guess.weight * std::abs(ratio(color) - ratio(mean));
  }
  return weights > 0 ? spread / weights >> (kRatioBits - kSpreadBits) : 0;
}

void VectorGuesses::learn(unsigned h, const HemisphereLight& light) {
  for (unsigned i = 0; i < count_; ++i) {
    const HemisphereLight& guessed = guess_[i].light[h];
    guess_[i].unlike += directions_apart(guessed.direction, light.direction) +
                        colors_apart(guessed.color, light.color);
  }
}

}  // namespace gicodec::native
