// What a channel differs by from its prediction (docs/native/continuous.md, "Residuals").
#pragma once

#include "native/models/continuous/bit_contexts.h"
#include "native/models/continuous/texel_predictor.h"
#include "native/raster/channel_forms.h"
#include "native/raster/place.h"

#include <array>
#include <cstdint>

namespace gicodec::native {

/// Memory of one thread, kept for its capacity.
class TexelResiduals {
 public:
  void reset(const Raster& raster, const ChannelForms& forms);
  /// Before the first channel of a texel.
  void begin_texel() {
    residual_ = residual_before_ = 0;
    large_ = false;
  }
  /// The ordinal of channel `k` of those that are coded, which the raster has when encoding, gets
  /// when decoding. `residual`: what was coded. False if there is no such ordinal.
  template <typename Coder>
  [[nodiscard]] bool code(Coder& coder, CounterTable& counters, Raster& raster,
                          const ChannelForms& forms, const TexelPredictor& predictor,
                          const Place& place, unsigned k, const Prediction& prediction,
                          std::int64_t& residual);

 private:
  static constexpr unsigned kWidths = 32, kEnergies = 80, kFractions = 4, kDigits = 3;
  /// What contexts are made of.
  struct Around;

  [[nodiscard]] Around around(const ChannelForms& forms, const TexelPredictor& predictor,
                              const Place& place, unsigned k, const Prediction& prediction) const;
  /// The place of the ordinal nearest to a prediction; the ordinal without a palette.
  [[nodiscard]] std::int64_t place_of_prediction(unsigned k, std::int64_t prediction) const;
  template <typename Coder>
  std::uint32_t code_width(Coder& coder, CounterTable& counters, const Around& around, unsigned k,
                           std::uint32_t most, std::uint32_t width);
  template <typename Coder>
  bool code_sign(Coder& coder, CounterTable& counters, const Around& around, unsigned k,
                 std::uint32_t width, bool negative);
  template <typename Coder>
  std::uint32_t code_digits(Coder& coder, CounterTable& counters, const Around& around, unsigned k,
                            std::uint32_t width, bool negative, std::uint32_t magnitude);

  bool units_ = false;  ///< the texel in hand has mantissas
  std::array<std::uint8_t, kMaxComponents> channel_{};
  std::array<bool, kMaxComponents> in_units_{};
  std::array<std::uint32_t, kMaxComponents> large_ordinal_{};  ///< of mantissas
  std::array<Vector<std::uint16_t>, kMaxComponents> nearest_;  ///< places, by ordinal
  Vector<BitMixer> widths_, widths_by_energy_, signs_, signs_by_fraction_, digits_,
      digits_by_width_;

  // Of the texel.
  std::int64_t residual_ = 0, residual_before_ = 0;  ///< of the last channels
  bool large_ = false;                               ///< a mantissa uses all its bits
};

}  // namespace gicodec::native
