// Predictions of a channel by what is around a texel, weighted by how wrong they were there
// (docs/native/continuous.md, "Prediction").
#pragma once

#include "base/memory.h"
#include "native/raster/channel_forms.h"
#include "native/raster/place.h"

#include <array>
#include <cstdint>

namespace gicodec::native {

inline constexpr unsigned kGuesses = 10;

/// Of a channel at a texel, in sixteenths of an ordinal.
struct Prediction {
  std::array<std::int64_t, kGuesses> guess;
  std::int64_t mean;      ///< weighted, brought into the channel's range
  std::int64_t w, n;      ///< the values there
  std::int64_t gradient;  ///< how much values differ around the texel, in ordinals
};

/// What is kept of a texel and a channel.
struct Trace {
  std::int32_t residual = 0;
  std::array<std::uint16_t, kGuesses> error{};
};

/// Memory of one thread, kept for its capacity.
class TexelPredictor {
 public:
  void reset(const Raster& raster, const ChannelForms& forms);
  /// Of channel `k` of those that are coded.
  [[nodiscard]] Prediction predict(const Raster& raster, const ChannelForms& forms,
                                   const Place& place, unsigned k);
  /// After predict(), when the texel has its ordinal.
  void learn(const Raster& raster, const Place& place, unsigned k, const Prediction& prediction,
             std::int64_t residual);
  /// Of a texel that repeats another, or is not coded.
  void pass(const Place& place);

  [[nodiscard]] std::int32_t residual(std::size_t texel, unsigned k) const {
    return trace(texel, k).residual;
  }
  /// The largest value of a channel.
  [[nodiscard]] std::int64_t largest(unsigned k) const { return largest_[k]; }

 private:
  static constexpr unsigned kMostInputs = 18, kMostLeads = 2;
  struct Filter {
    std::array<std::int32_t, kMostInputs> weight{};
  };
  struct Inputs {
    std::array<std::int64_t, kMostInputs> value;
    unsigned count = 0;
    void add(std::int64_t input) { value[count++] = input; }
  };
  /// Values around a texel in one channel, in sixteenths.
  struct Around;

  [[nodiscard]] std::int64_t value(const std::uint32_t* ordinals, unsigned c,
                                   std::uint32_t exponent) const;
  [[nodiscard]] Around around(const Raster& raster, const Place& place, unsigned c) const;
  void find_inputs(const Raster& raster, const Place& place, unsigned k, const Around& own);
  [[nodiscard]] std::int64_t light(const ChannelForms& forms, unsigned c,
                                   const std::uint32_t* ordinals, std::uint32_t exponent) const;
  [[nodiscard]] std::int64_t guess_of_light(const ChannelForms& forms, unsigned c,
                                            std::int64_t light) const;
  void guess_by_light(const Raster& raster, const ChannelForms& forms, const Place& place,
                      unsigned k, Prediction& prediction) const;
  [[nodiscard]] std::int64_t weighted(const Place& place, unsigned k,
                                      const Prediction& prediction) const;

  [[nodiscard]] const Trace& trace(std::size_t texel, unsigned k) const {
    return traces_[(texel & ring_) * coded_ + k];
  }
  [[nodiscard]] Trace& trace(std::size_t texel, unsigned k) {
    return traces_[(texel & ring_) * coded_ + k];
  }

  Channels channels_;
  std::array<std::uint8_t, kMaxComponents> channel_{};  ///< of those that are coded
  std::array<std::int64_t, kMaxComponents> largest_{};
  unsigned coded_ = 0, lead_ = 0;  ///< lead_: place of the channel that others follow
  std::size_t ring_ = 0;           ///< texels whose traces are kept, less 1
  Vector<Trace> traces_;
  std::array<Filter, kMaxComponents> filter_;
  Inputs inputs_;  ///< of the last prediction, less its base
};

}  // namespace gicodec::native
