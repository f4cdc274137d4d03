// A raster's channels as rows of words, and blocks ↔ these (docs/native/rows.md, "Raster").
#pragma once

#include "base/memory.h"
#include "native/raster/channel_forms.h"
#include "native/raster/raster.h"

#include <gicodec/texture.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace gicodec::native {

struct Update;

/// What an encoder may do to channels.
struct RowChoice {
  bool halves;  ///< code those of more than 16 bits in halves
  bool places;  ///< count in places wherever there are few, also where that should not pay
};

/// The least box of blocks around those listed, all texels of which are coded; the rows of its
/// slices stand below one another. Planes are channels in places, or in 16-bit words; those of wide
/// channels, of more than 16 bits, are places or high halves, and behind all channels follow their
/// low halves. Memory of one thread, kept for its capacity.
class RowPlanes {
 public:
  /// Makes room; all texels are zero, or anything.
  void lay_out(const Update& u, std::span<const std::uint32_t> positions, bool zero);
  /// Reads what the mirror has of the box's blocks.
  void load_mirror(const Update& u);
  void load(const Update& u, std::uint32_t block, std::span<const std::byte> records);
  void store(const Update& u, std::uint32_t position, std::span<std::byte> records);
  /// Bits of the records ↔ ordinals, of every texel.
  void to_ordinals();
  void to_bits();

  /// False if that would need halves that are not wanted.
  [[nodiscard]] bool choose_forms(RowChoice choice, ChannelForms& forms);
  /// Whether RowChoice::places would have changed that choice.
  [[nodiscard]] bool places_left_out() const { return places_left_out_; }
  /// Lists the planes that are coded by those forms; false if there are too many.
  [[nodiscard]] bool list_coded(const ChannelForms& forms);
  [[nodiscard]] std::span<const std::uint8_t> coded() const {
    return std::span(coded_).first(coded_count_);
  }
  [[nodiscard]] bool is_low(unsigned plane) const { return plane >= channels_.count; }
  [[nodiscard]] unsigned channel_of(unsigned plane) const {
    return is_low(plane) ? plane - channels_.count : plane;
  }
  /// Ordinals ↔ what is coded. An ordinal that is not in a palette has the place of the next one.
  void to_planes(const ChannelForms& forms);
  void from_planes(const ChannelForms& forms);

  [[nodiscard]] const Channels& channels() const { return channels_; }
  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] bool has_slices() const { return rows_ > rows_of_slice_; }
  [[nodiscard]] std::size_t rows_of_slice() const { return rows_of_slice_; }
  [[nodiscard]] std::size_t texels() const { return columns_ * rows_; }
  /// With kMargin words on either side. There are rows beyond the last, as many as lanes.
  [[nodiscard]] std::uint16_t* row(unsigned plane, std::size_t y) {
    return row_above(plane, y) + stride_;
  }
  /// That before row `y`; there is one before the first.
  [[nodiscard]] std::uint16_t* row_above(unsigned plane, std::size_t y) {
    return values_.data() + plane * plane_ + y * stride_ + kMargin;
  }
  static constexpr std::size_t kMargin = kRowMargin;

 private:
  template <typename Body>
  void for_each_value(unsigned channel, const Body& body);
  /// Calls body(value of the block, row, column) for each row of a block.
  template <typename Body>
  void for_each_row(const Update& u, std::uint32_t block, const Body& body) const;
  [[nodiscard]] bool is_wide(unsigned channel) const {
    return channels_.channel[channel].bits() > 16;
  }
  [[nodiscard]] std::uint32_t* wide(unsigned channel, std::size_t y) {
    return wide_[channel].data() + y * columns_;
  }
  /// Inverts the highest bit.
  void flip(unsigned channel);
  [[nodiscard]] bool find_ordinals(unsigned channel);
  [[nodiscard]] bool is_copy(unsigned channel, unsigned of);
  [[nodiscard]] unsigned low_plane(unsigned channel) const { return channels_.count + channel; }
  [[nodiscard]] bool has_halves(const ChannelForms& forms, unsigned channel) const {
    return is_wide(channel) && forms[channel].form == Form::plain;
  }
  void wide_to_planes(const ChannelForms& forms, unsigned channel);
  void wide_from_planes(const ChannelForms& forms, unsigned channel);

  Channels channels_;
  std::array<std::uint8_t, kMaxComponents> plane_of_{};  ///< of kernels, the first, by channel
  BlockBox box_;
  std::size_t columns_ = 0, rows_ = 0, stride_ = 0, plane_ = 0;
  std::size_t rows_of_slice_ = 0;
  std::array<std::uint8_t, kMaxComponents> coded_{};
  unsigned coded_count_ = 0;
  bool places_left_out_ = false;
  Vector<std::uint16_t> values_, block_;
  std::array<Vector<std::uint32_t>, kMaxComponents> wide_;  ///< [y][x] of channels above 16 bits
  Vector<std::uint32_t> ordinals_;
  Vector<std::uint16_t> table_;
  Vector<std::uint8_t> occurs_;
};

/// Whether blocks of the texture can be rows.
[[nodiscard]] bool takes_rows(const TextureDesc& desc) noexcept;

}  // namespace gicodec::native
