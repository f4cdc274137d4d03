#include "native/models/continuous/channel_forms.h"

#include "base/binary_coder.h"
#include "native/models/continuous/raster_contexts.h"
#include "native/models/numbers.h"

#include <algorithm>

namespace gicodec::native {
namespace {

constexpr unsigned kFormBits = 2, kChannelBits = 4, kCountBits = 24;
/// Of ordinals that are marked instead of sorted.
constexpr unsigned kMarkedBits = 16;

/// `occurs` is overwritten.
void find_ordinals(const Raster& raster, unsigned c, Vector<std::uint8_t>& occurs,
                   Vector<std::uint32_t>& ordinals) {
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
  occurs.assign(std::size_t{1} << bits, 0);
  for (std::size_t i = 1; i <= raster.texels(); ++i) {
    if (raster.coded(i)) occurs[raster.now(i)[c]] = 1;
  }
  for (std::uint32_t n = 0; n < occurs.size(); ++n) {
    if (occurs[n] != 0) ordinals.push_back(n);
  }
}

/// Whether both have the same ordinals in all texels.
bool is_copy(const Raster& raster, unsigned c, unsigned of) {
  const Channel &one = raster.channels().channel[c], &other = raster.channels().channel[of];
  if (one.bits() != other.bits() || one.component.type != other.component.type) return false;
  for (std::size_t i = 1; i <= raster.texels(); ++i) {
    if (raster.coded(i) && raster.now(i)[c] != raster.now(i)[of]) return false;
  }
  return true;
}

/// Whether to count in places: where many ordinals between the least and the largest do not occur.
bool is_sparse(const Channel& channel, const Vector<std::uint32_t>& ordinals, std::size_t texels) {
  if (ordinals.size() <= 1) return true;
  const std::uint64_t range = std::uint64_t{ordinals.back()} - ordinals.front() + 1;
  if (channel.component.type == ComponentType::exponent) return false;
  if (channel.in_units)
    return ordinals.size() * std::uint64_t{5} <= std::uint64_t{4} << channel.bits();
  return ordinals.size() * std::uint64_t{3} < 2 * range && ordinals.size() < texels / 4 + 2;
}

}  // namespace

void ChannelForms::choose(const Raster& raster, bool palettes) {
  const Channels& channels = raster.channels();
  for (unsigned c = 0; c < channels.count; ++c) {
    ChannelForm& form = form_[c];
    form.form = Form::plain;
    form.of = 0;
    form.palette.clear();
    find_ordinals(raster, c, occurs_, ordinals_);
    for (unsigned a = 0; a < c && form.form == Form::plain && ordinals_.size() > 1; ++a) {
      if (form_[a].form == Form::copy || !is_copy(raster, c, a)) continue;
      form.form = Form::copy;
      form.of = a;
    }
    if (form.form == Form::copy || (!palettes && ordinals_.size() > 1)) continue;
    if (!is_sparse(channels.channel[c], ordinals_, raster.coded_texels())) continue;
    form.form = Form::palette;
    form.palette.assign(ordinals_.begin(), ordinals_.end());
    for (unsigned a = 0; a < c; ++a) {
      if (channels.channel[a].bits() != channels.channel[c].bits()) continue;
      if (form_[a].palette != form.palette) continue;
      form.form = Form::palette_before;
      form.of = a;
      break;
    }
  }
}

template <typename Coder>
bool ChannelForms::code(Coder& coder, const Raster& raster, ValueModel& values) {
  const Channels& channels = raster.channels();
  for (unsigned c = 0; c < channels.count; ++c) {
    ChannelForm& form = form_[c];
    form.form = static_cast<Form>(coder.bypass(kFormBits, static_cast<std::uint32_t>(form.form)));
    if (form.form == Form::palette_before || form.form == Form::copy) {
      form.of = coder.bypass(kChannelBits, form.of);
      if (form.of >= c) return false;
      const Channel &one = channels.channel[c], &other = channels.channel[form.of];
      if (one.bits() != other.bits()) return false;
      if (form.form == Form::copy && form_[form.of].form == Form::copy) return false;
    }
    if constexpr (Coder::kDecodes) form.palette.clear();
    if (form.form == Form::palette_before) {
      if (form_[form.of].palette.empty()) return false;
      if constexpr (Coder::kDecodes) {
        form.palette.assign(form_[form.of].palette.begin(), form_[form.of].palette.end());
      }
    }
    if (form.form == Form::palette &&
        !code_palette(coder, channels.channel[c], raster.coded_texels(), values, form.palette)) {
      return false;
    }
  }
  // Mantissas need the exponent itself.
  const ChannelForm& first = form_[0];
  if (channels.shared && first.form != Form::plain && first.palette.size() != 1) return false;
  list_coded(raster);
  return true;
}

/// How many, the least, and what each is more than the one before.
template <typename Coder>
bool ChannelForms::code_palette(Coder& coder, const Channel& channel, std::size_t most,
                                ValueModel& values, Vector<std::uint32_t>& palette) {
  const std::size_t count =
      std::size_t{coder.bypass(kCountBits, static_cast<std::uint32_t>(palette.size()))};
  if (count == 0 || count > most) return false;
  if constexpr (Coder::kDecodes) palette.reserve(count);
  std::uint64_t ordinal = 0;
  std::uint32_t width = 0, width_before = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t actual = Coder::kDecodes ? 0 : palette[i];
    if (i == 0) {
      ordinal = coder.bypass(channel.bits(), actual);
    } else {
      const std::uint32_t place = top_bits(static_cast<std::uint32_t>(ordinal), channel.bits(), 6);
      const std::int64_t more = values.number(
          coder, 0,
          {hashed(kGap, 0), hashed(kGapBefore, width), hashed(kGapsBefore, width, width_before),
           hashed(kGapPlace, place), hashed(kGapPlace, place, width)},
          {{{kGapSign, 0}, {kGapSign, 1}, {kGapSign, 2}}},
          static_cast<std::int64_t>(actual - ordinal) - 1);
      if (more < 0) return false;
      ordinal += static_cast<std::uint64_t>(more) + 1;
      if (ordinal > channel.largest()) return false;
      width_before = width;
      width = width_of(more);
    }
    if constexpr (Coder::kDecodes) {
      palette.push_back(static_cast<std::uint32_t>(ordinal));
      if (coder.overrun()) return false;
    }
  }
  return true;
}

void ChannelForms::list_coded(const Raster& raster) {
  coded_count_ = 0;
  for (unsigned c = 0; c < raster.channels().count; ++c) {
    if (form_[c].form == Form::copy || form_[c].palette.size() == 1) continue;
    coded_[coded_count_++] = static_cast<std::uint8_t>(c);
  }
}

bool ChannelForms::has_palettes(const Raster& raster) const {
  return std::any_of(coded().begin(), coded().end(), [&](unsigned c) {
    return !form_[c].palette.empty() && !keeps_ordinals(raster.channels().channel[c]);
  });
}

void ChannelForms::to_places(Raster& raster) const {
  for (unsigned c = 0; c < raster.channels().count; ++c) {
    if (form_[c].palette.size() != 1) continue;
    for (std::size_t i = 1; i <= raster.texels(); ++i) {
      if (raster.coded(i)) raster.now(i)[c] = form_[c].palette[0];
    }
  }
  for (const unsigned c : coded()) {
    const auto& palette = form_[c].palette;
    if (palette.empty() || keeps_ordinals(raster.channels().channel[c])) continue;
    for (std::size_t i = 1; i <= raster.texels(); ++i) {
      const auto place = [&](std::uint32_t ordinal) {
        const auto at = std::lower_bound(palette.begin(), palette.end() - 1, ordinal);
        return static_cast<std::uint32_t>(at - palette.begin());
      };
      raster.now(i)[c] = place(raster.now(i)[c]);
      if (raster.has_past()) raster.past(i)[c] = place(raster.past(i)[c]);
    }
  }
}

void ChannelForms::from_places(Raster& raster) const {
  for (unsigned c = 0; c < raster.channels().count; ++c) {
    const ChannelForm& form = form_[c];
    const bool places = form.palette.size() > 1 && !keeps_ordinals(raster.channels().channel[c]);
    for (std::size_t i = 1; i <= raster.texels() && form.form != Form::plain; ++i) {
      if (!raster.coded(i)) continue;
      std::uint32_t* const now = raster.now(i);
      if (form.form == Form::copy) {
        now[c] = now[form.of];
      } else if (places) {
        now[c] = form.palette[now[c]];
      }
    }
  }
}

template bool ChannelForms::code(BinaryEncoder&, const Raster&, ValueModel&);
template bool ChannelForms::code(BinaryDecoder&, const Raster&, ValueModel&);

}  // namespace gicodec::native
