// What lights around, or its past, say of a light (docs/native.md, "Vertices", "Voxels").
#pragma once

#include "native/models/light/known_lights.h"
#include "native/models/light/light_numbers.h"

namespace gicodec::native {

[[nodiscard]] std::int64_t directions_apart(const Direction& a, const Direction& b);
[[nodiscard]] std::int64_t colors_apart(const Color& a, const Color& b);
/// value · to / from.
[[nodiscard]] inline std::int64_t proportion(std::int64_t value, std::int64_t to,
                                             std::int64_t from) {
  return static_cast<std::int64_t>(in_proportion(static_cast<std::uint64_t>(value),
                                                 static_cast<std::uint64_t>(to),
                                                 static_cast<std::uint64_t>(from)));
}
inline constexpr std::uint32_t kNearest = 4096;  ///< nearness of the past, and at distance 1
inline constexpr std::int64_t kMostRatio = 1000000;
inline constexpr std::int64_t kSnormCodes = 127;  ///< of a direction's coordinate

class LightGuesses {
 public:
  static constexpr unsigned kMost = KnownLights::kMost + 2;
  using Lights = std::array<HemisphereLight, kHemispheres>;
  struct Guess {
    Lights light{};
    std::uint32_t nearness = 0, distance = 0;
    std::int64_t unlike = 0;  ///< from what was coded, summed over hemispheres
    std::int64_t weight = 0;
  };
  using Codes = std::array<LightCodes, kHemispheres>;
  /// What a mean leaves to the last one with light of those that it is of.
  struct Completion {
    unsigned siblings = 0;  ///< with light there, itself included; 0: it is not the last one
    Color color{};
    std::int64_t unit = 0;  ///< of the mean's green, or of all its colours
  };

  /// `past`: empty if nothing is known of it; `last`: the light coded before, or null.
  void take(const LightForm& form, const KnownLights& around, std::span<const std::byte> past,
            const Codes* last);
  [[nodiscard]] std::span<const Guess> all() const { return std::span(guess_).first(count_); }
  [[nodiscard]] const Completion& completion(unsigned h) const { return completion_[h]; }
  /// The exponent that colours are in units of.
  [[nodiscard]] int top() const { return top_; }

  /// Weights by nearness, and by how unlike they are over so many hemispheres, with `more` added.
  void weigh(std::span<const std::int64_t, kMost> more, unsigned hemispheres);
  /// By weight.
  [[nodiscard]] Color mean_color(unsigned h) const;
  /// The mean direction of a hemisphere, and how far guesses are from it.
  struct Around {
    Direction direction{};
    std::int64_t spread = 0;  ///< across the axis, in quarters of 1/127
  };
  [[nodiscard]] Around around(unsigned h) const;
  /// How far guesses of green are from their mean, in 1/64 of that.
  [[nodiscard]] std::int64_t green_spread(unsigned h) const;
  /// How far component c is from its share beside green in `mean`, in 1/256.
  [[nodiscard]] std::int64_t ratio_spread(unsigned h, unsigned c, const Color& mean) const;
  /// Hemisphere h is this.
  void learn(unsigned h, const HemisphereLight& light);

 private:
  void add_rest(const LightForm& form, const KnownLights::Family& family, bool moved);
  /// Makes a guess what the first one, the past, is if it changed from `was` as that light did.
  void move_past(const Lights& was, Guess& guess) const;
  [[nodiscard]] Lights lights(const LightForm& form, const std::byte* records) const;

  int top_ = 0;
  bool skip_dark_ = false;  ///< as darkness is told apart
  unsigned count_ = 0;
  std::array<Guess, kMost> guess_{};
  std::array<Completion, kHemispheres> completion_{};
};

}  // namespace gicodec::native
