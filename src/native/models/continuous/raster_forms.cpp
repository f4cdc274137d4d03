#include "native/models/continuous/raster_forms.h"

#include <algorithm>

namespace gicodec::native {
namespace {

/// Bits of ordinals that are marked instead of sorted.
constexpr unsigned kMarkedBits = 16;

void find_ordinals(const Raster& raster, unsigned c, FormScratch& scratch) {
  auto& ordinals = scratch.ordinals;
  ordinals.clear();
  const unsigned bits = raster.channels().channel[c].bits();
  if (bits > kMarkedBits) {
    for (std::size_t i = 1; i <= raster.texels(); ++i) {
      if (raster.coded(i)) ordinals.push_back(raster.now(i)[c]);
    }
    std::sort(ordinals.begin(), ordinals.end());
    ordinals.erase(std::unique(ordinals.begin(), ordinals.end()), ordinals.end());
    return;
  }
  scratch.occurs.assign(std::size_t{1} << bits, 0);
  for (std::size_t i = 1; i <= raster.texels(); ++i) {
    if (raster.coded(i)) scratch.occurs[raster.now(i)[c]] = 1;
  }
  for (std::uint32_t n = 0; n < scratch.occurs.size(); ++n) {
    if (scratch.occurs[n] != 0) ordinals.push_back(n);
  }
}

/// Whether both have the same ordinals in all texels.
bool is_copy(const Raster& raster, unsigned c, unsigned of) {
  for (std::size_t i = 1; i <= raster.texels(); ++i) {
    if (raster.coded(i) && raster.now(i)[c] != raster.now(i)[of]) return false;
  }
  return true;
}

}  // namespace

void choose_forms(const Raster& raster, bool palettes, ChannelForms& forms, FormScratch& scratch) {
  forms.begin(raster.channels());
  for (unsigned c = 0; c < raster.channels().count; ++c) {
    find_ordinals(raster, c, scratch);
    bool copied = false;
    for (unsigned a = 0; a < c && !copied && scratch.ordinals.size() > 1; ++a) {
      copied = forms.may_copy(c, a) && is_copy(raster, c, a);
      if (copied) forms.choose_copy(c, a);
    }
    if (!copied) forms.choose(c, scratch.ordinals, raster.coded_texels(), palettes);
  }
}

void to_places(const ChannelForms& forms, Raster& raster) {
  for (unsigned c = 0; c < raster.channels().count; ++c) {
    const bool constant = forms.is_constant(c);
    if (!constant && !forms.has_places(c)) continue;
    for (std::size_t i = 1; i <= raster.texels(); ++i) {
      std::uint32_t& now = raster.now(i)[c];
      if (constant) {
        if (raster.coded(i)) now = forms[c].palette[0];
        continue;
      }
      now = forms.place_of(c, now);
      if (raster.has_past()) raster.past(i)[c] = forms.place_of(c, raster.past(i)[c]);
    }
  }
}

void from_places(const ChannelForms& forms, Raster& raster) {
  for (unsigned c = 0; c < raster.channels().count; ++c) {
    const ChannelForm& form = forms[c];
    if (form.form != Form::copy && !forms.has_places(c)) continue;
    for (std::size_t i = 1; i <= raster.texels(); ++i) {
      if (!raster.coded(i)) continue;
      std::uint32_t* const now = raster.now(i);
      now[c] = form.form == Form::copy ? now[form.of] : form.palette[now[c]];
    }
  }
}

}  // namespace gicodec::native
