// Which channels of a chunk are coded, and which of their ordinals occur
// (docs/native/continuous.md, "Forms").
#pragma once

#include "native/mixed/value_model.h"
#include "native/raster/channels.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

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
  // An encoder's choice, channel by channel, ascending.
  void begin(const Channels& channels) { channels_ = channels; }
  void choose_copy(unsigned channel, unsigned of);
  /// `ordinals`: those that occur, ascending. Without `palettes`, only what costs nothing.
  void choose(unsigned channel, std::span<const std::uint32_t> ordinals, std::size_t texels,
              bool palettes);
  /// Whether a copy of the earlier channel could be told.
  [[nodiscard]] bool may_copy(unsigned channel, unsigned of) const;

  /// False for forms of which there are no texels. `texels`: how many are coded.
  template <typename Coder>
  [[nodiscard]] bool code(Coder& coder, const Channels& channels, std::size_t texels,
                          ValueModel& values);

  [[nodiscard]] const ChannelForm& operator[](unsigned channel) const { return form_[channel]; }
  /// Those whose texels differ, ascending.
  [[nodiscard]] std::span<const std::uint8_t> coded() const {
    return std::span(coded_).first(coded_count_);
  }
  [[nodiscard]] bool is_constant(unsigned channel) const {
    return form_[channel].palette.size() == 1;
  }
  /// Whether what is coded of a channel are places in its palette. An ordinal that does not occur
  /// has the place of the next one. Mantissas keep their values, and count residuals in places.
  [[nodiscard]] bool has_places(unsigned channel) const {
    return form_[channel].palette.size() > 1 && !channels_.channel[channel].in_units;
  }
  [[nodiscard]] bool has_palette_of_mantissas(unsigned channel) const {
    return form_[channel].palette.size() > 1 && channels_.channel[channel].in_units;
  }
  /// Whether any channel has places, which may not be worth it.
  [[nodiscard]] bool have_places() const;
  [[nodiscard]] std::uint32_t place_of(unsigned channel, std::uint32_t ordinal) const;

 private:
  template <typename Coder>
  [[nodiscard]] bool code_palette(Coder& coder, const Channel& channel, std::size_t most,
                                  ValueModel& values, Vector<std::uint32_t>& palette);
  void list_coded();

  Channels channels_;
  std::array<ChannelForm, kMaxComponents> form_;
  std::array<std::uint8_t, kMaxComponents> coded_{};
  unsigned coded_count_ = 0;
};

/// Of every number of a channel of mantissas the place of the nearest in its palette, the lower of
/// two.
void find_nearest(const Channel& channel, std::span<const std::uint32_t> palette,
                  Vector<std::uint16_t>& nearest);

}  // namespace gicodec::native
