// The forms of a raster's channels: an encoder's choice, ordinals ↔ places.
#pragma once

#include "native/raster/channel_forms.h"
#include "native/raster/raster.h"

namespace gicodec::native {

/// Memory of one thread, kept for its capacity.
struct FormScratch {
  Vector<std::uint32_t> ordinals;
  Vector<std::uint8_t> occurs;
};
/// Without `palettes`, only what costs nothing.
void choose_forms(const Raster& raster, bool palettes, ChannelForms& forms, FormScratch& scratch);
/// Before texels are coded: what is coded of them and of the past, and what they have in common.
void to_places(const ChannelForms& forms, Raster& raster);
/// After they were decoded.
void from_places(const ChannelForms& forms, Raster& raster);

}  // namespace gicodec::native
