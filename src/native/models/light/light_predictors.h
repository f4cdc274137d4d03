// Predictors of a light: its previous value and those around (docs/native/light.md).
#pragma once

#include "native/models/light/known_lights.h"
#include "native/models/light/light_numbers.h"

namespace gicodec::native {

[[nodiscard]] std::int64_t direction_distance(const Direction& a, const Direction& b);
[[nodiscard]] std::int64_t color_distance(const Color& a, const Color& b);
/// value · to / from.
[[nodiscard]] inline std::int64_t proportion(std::int64_t value, std::int64_t to,
                                             std::int64_t from) {
  return static_cast<std::int64_t>(in_proportion(static_cast<std::uint64_t>(value),
                                                 static_cast<std::uint64_t>(to),
                                                 static_cast<std::uint64_t>(from)));
}
inline constexpr std::uint32_t kNearest =
    4096;  ///< nearness of the previous light, and at distance 1
inline constexpr std::int64_t kMaxRatio = 1000000;
inline constexpr std::int64_t kSnormCodes = 127;  ///< of a direction's coordinate

class LightPredictors {
 public:
  static constexpr unsigned kMax = KnownLights::kMax + 2;
  using Lights = std::array<HemisphereLight, kHemispheres>;
  struct Predictor {
    Lights light{};
    std::uint32_t nearness = 0, distance = 0;
    std::int64_t dissimilarity = 0;  ///< from what was coded, summed over hemispheres
    std::int64_t weight = 0;
  };
  using Codes = std::array<LightCodes, kHemispheres>;
  /// The rest of a parent's mean, for the last of its children with light.
  struct Completion {
    unsigned siblings = 0;  ///< with light there, itself included; 0: it is not the last one
    Color color{};
    std::int64_t unit = 0;  ///< of the mean's green, or of all its colours
  };

  /// `previous`: empty if there is none; `last`: the light coded before, or null.
  void take(const LightEncoding& encoding, const KnownLights& around,
            std::span<const std::byte> previous, const Codes* last);
  [[nodiscard]] std::span<const Predictor> all() const {
    return std::span(predictor_).first(count_);
  }
  [[nodiscard]] const Completion& completion(unsigned h) const { return completion_[h]; }
  /// The exponent that colours are in units of.
  [[nodiscard]] int top() const { return top_; }

  /// Weights by nearness, and by the mean dissimilarity over so many hemispheres, with `more`
  /// added.
  void weigh(std::span<const std::int64_t, kMax> more, unsigned hemispheres);
  /// By weight.
  [[nodiscard]] Color mean_color(unsigned h) const;
  /// The mean direction of a hemisphere, and the mean distance of predictors from it.
  struct Around {
    Direction direction{};
    std::int64_t spread = 0;  ///< across the axis, in quarters of 1/127
  };
  [[nodiscard]] Around around(unsigned h) const;
  /// The mean distance of predicted greens from their mean, in 1/64 of that.
  [[nodiscard]] std::int64_t green_spread(unsigned h) const;
  /// The mean distance of component c's ratio to green from that in `mean`, in 1/256.
  [[nodiscard]] std::int64_t ratio_spread(unsigned h, unsigned c, const Color& mean) const;
  /// Hemisphere h was coded: updates the dissimilarities.
  void learn(unsigned h, const HemisphereLight& light);

 private:
  void add_rest(const LightEncoding& encoding, const KnownLights::Siblings& siblings, bool moved);
  /// Makes of a predictor the previous light, the first predictor, plus its change from `was`.
  void add_change(const Lights& was, Predictor& predictor) const;
  [[nodiscard]] Lights lights(const LightEncoding& encoding, const std::byte* records) const;

  int top_ = 0;
  bool skip_dark_ = false;  ///< of predictors without light
  unsigned count_ = 0;
  std::array<Predictor, kMax> predictor_{};
  std::array<Completion, kHemispheres> completion_{};
};

}  // namespace gicodec::native
