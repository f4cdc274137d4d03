// Texels that are as another one in all channels (docs/native/continuous.md, "Repeats").
#pragma once

#include "native/models/continuous/bit_contexts.h"
#include "native/raster/channel_forms.h"
#include "native/raster/place.h"

#include <array>
#include <cstdint>

namespace gicodec::native {

/// Memory of one thread, kept for its capacity.
class TexelRepeats {
 public:
  void reset(const Raster& raster);
  /// Whether the texel repeats another; fills it then.
  template <typename Coder>
  bool code(Coder& coder, CounterTable& counters, Raster& raster, const ChannelForms& forms,
            const Place& place);
  /// After every texel, coded or not.
  void learn(const Raster& raster, const ChannelForms& forms, const Place& place);
  /// Whether a texel repeated another.
  [[nodiscard]] bool repeats(std::size_t texel) const { return source_[texel] != Source::none; }

 private:
  /// What texels repeat, and 0: nothing.
  enum class Source : std::uint8_t { none, w, n, ne, nw, match, z, past };
  static constexpr unsigned kSources = 8, kPatterns = 64, kMostFlags = 5;
  static constexpr unsigned kMatchBits = 16;
  static constexpr std::uint32_t kLongMatch = 20;

  [[nodiscard]] std::uint32_t hash_around(const Raster& raster, const ChannelForms& forms,
                                          const Place& place) const;

  Vector<Source> source_;            ///< by texel
  Vector<std::uint32_t> last_seen_;  ///< a texel, by the hash of those before it
  std::size_t match_ = 0;            ///< what the next texel may repeat
  std::uint32_t match_length_ = 0;   ///< texels that did; 0: no match
  std::array<BitMixer, std::size_t{kSources} * kSources> by_source_;
  std::array<BitMixer, kPatterns> by_pattern_;
};

}  // namespace gicodec::native
