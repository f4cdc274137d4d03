// Which channels of a chunk are coded, and which of their ordinals occur
// (docs/native/continuous.md, "Forms").
#pragma once

#include "native/mixed/value_model.h"
#include "native/raster/raster.h"

#include <array>
#include <cstdint>

namespace gicodec::native {

enum class Form : std::uint8_t {
  plain,
  palette,         ///< some ordinals occur
  palette_before,  ///< the same as in an earlier channel
  copy,            ///< every texel has the ordinal of an earlier channel
};

struct ChannelForm {
  Form form = Form::plain;
  unsigned of = 0;                ///< the earlier channel
  Vector<std::uint32_t> palette;  ///< ascending; of both forms that have one
};

/// Memory of one thread, kept for its capacity.
class ChannelForms {
 public:
  /// An encoder's choice. Without `palettes`, only what costs nothing.
  void choose(const Raster& raster, bool palettes);
  template <typename Coder>
  [[nodiscard]] bool code(Coder& coder, const Raster& raster, ValueModel& values);

  /// Ordinals ↔ what is coded: where a channel has a palette, the ordinal's place in it. An ordinal
  /// that does not occur, of a texel that is not coded, has the place of the next one. Before
  /// anything is coded, and after; the first also gives all texels what they have in common.
  void to_places(Raster& raster) const;
  void from_places(Raster& raster) const;

  /// Whether a channel is counted in places, which may not be worth it.
  [[nodiscard]] bool has_palettes(const Raster& raster) const;
  [[nodiscard]] const ChannelForm& operator[](unsigned channel) const { return form_[channel]; }
  /// Those whose texels differ, ascending.
  [[nodiscard]] std::span<const std::uint8_t> coded() const {
    return std::span(coded_).first(coded_count_);
  }
  /// Whether values are predicted by ordinals, and only residuals counted in places.
  [[nodiscard]] static bool keeps_ordinals(const Channel& channel) { return channel.in_units; }

 private:
  template <typename Coder>
  [[nodiscard]] bool code_palette(Coder& coder, const Channel& channel, std::size_t most,
                                  ValueModel& values, Vector<std::uint32_t>& palette);
  void list_coded(const Raster& raster);

  std::array<ChannelForm, kMaxComponents> form_;
  std::array<std::uint8_t, kMaxComponents> coded_{};
  unsigned coded_count_ = 0;
  Vector<std::uint32_t> ordinals_;  ///< encoding: that occur in a channel
  Vector<std::uint8_t> occurs_;     ///< encoding: which do
};

}  // namespace gicodec::native
