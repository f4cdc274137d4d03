// What vertices around, or its past, say of a vertex (docs/native.md, "Vectors").
#pragma once

#include "native/vector_neighbours.h"
#include "native/vector_numbers.h"

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

class VectorGuesses {
 public:
  static constexpr unsigned kMost = KnownVertices::kMost + 1;
  struct Guess {
    std::array<HemisphereLight, kHemispheres> light{};
    std::uint32_t nearness = 0, distance = 0;
    std::int64_t unlike = 0;  ///< from what was coded, summed over hemispheres
    std::int64_t weight = 0;
  };
  using Vertex = std::array<VectorCodes, kHemispheres>;

  /// `past`: empty if nothing is known of it; `last`: the vertex with light coded before, or null.
  void take(const VectorForm& form, const KnownVertices& around, std::span<const std::byte> past,
            const Vertex* last);
  [[nodiscard]] std::span<const Guess> all() const { return std::span(guess_).first(count_); }
  /// The exponent that colours are in units of.
  [[nodiscard]] int top() const { return top_; }

  /// Weights by nearness, and by how unlike they are over so many hemispheres, with `more` added.
  void weigh(std::span<const std::int64_t, kMost> more, unsigned hemispheres);
  /// By weight.
  [[nodiscard]] Color mean_color(unsigned h) const;
  /// The mean direction of a hemisphere, and how far guesses are from it.
  struct Around {
    Direction direction{};
    std::int64_t spread = 0;        ///< across the axis, in quarters of 1/127
    std::int64_t green_spread = 0;  ///< of green, in 1/64 of its mean
  };
  [[nodiscard]] Around around(unsigned h) const;
  /// How far component c is from its share beside green in `mean`, in 1/256.
  [[nodiscard]] std::int64_t ratio_spread(unsigned h, unsigned c, const Color& mean) const;
  /// Hemisphere h is this.
  void learn(unsigned h, const HemisphereLight& light);

 private:
  /// Makes a guess what the first one, the past, is if it changed as that vertex did.
  void move_past(const VectorForm& form, const std::byte* before, Guess& guess) const;

  int top_ = 0;
  unsigned count_ = 0;
  std::array<Guess, kMost> guess_{};
};

}  // namespace gicodec::native
