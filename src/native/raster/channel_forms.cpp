#include "native/raster/channel_forms.h"

#include "base/binary_coder.h"
#include "native/models/numbers.h"

#include <algorithm>

namespace gicodec::native {
namespace {

constexpr unsigned kFormBits = 2, kChannelBits = 4, kCountBits = 24;
/// First numbers of hashes.
constexpr std::uint32_t kGap = 1, kGapBefore = 2, kGapsBefore = 3, kGapPlace = 4, kGapSign = 5;

/// Whether to count in places: where many ordinals between the least and the largest do not occur.
bool is_sparse(const Channel& channel, std::span<const std::uint32_t> ordinals,
               std::size_t texels) {
  if (ordinals.size() <= 1) return true;
  if (channel.component.type == ComponentType::exponent) return false;
  const std::uint64_t count = ordinals.size();
  if (channel.in_units) return count * 5 <= std::uint64_t{4} << channel.bits();
  const std::uint64_t range = std::uint64_t{ordinals.back()} - ordinals.front() + 1;
  return count * 3 < 2 * range && count < texels / 4 + 2;
}

}  // namespace

bool ChannelForms::may_copy(unsigned channel, unsigned of) const {
  const Channel &one = channels_.channel[channel], &other = channels_.channel[of];
  return one.bits() == other.bits() && one.component.type == other.component.type &&
         form_[of].form != Form::copy;
}

void ChannelForms::choose_copy(unsigned channel, unsigned of) {
  form_[channel].form = Form::copy;
  form_[channel].of = of;
  form_[channel].palette.clear();
}

void ChannelForms::choose(unsigned channel, std::span<const std::uint32_t> ordinals,
                          std::size_t texels, bool palettes) {
  ChannelForm& form = form_[channel];
  form.form = Form::plain;
  form.of = 0;
  form.palette.clear();
  if (!palettes && ordinals.size() != 1) return;
  if (!is_sparse(channels_.channel[channel], ordinals, texels)) return;
  form.form = Form::palette;
  form.palette.assign(ordinals.begin(), ordinals.end());
  for (unsigned a = 0; a < channel; ++a) {
    if (channels_.channel[a].bits() != channels_.channel[channel].bits()) continue;
    if (form_[a].palette != form.palette) continue;
    form.form = Form::palette_before;
    form.of = a;
    return;
  }
}

template <typename Coder>
bool ChannelForms::code(Coder& coder, const Channels& channels, std::size_t texels,
                        ValueModel& values) {
  channels_ = channels;
  for (unsigned c = 0; c < channels.count; ++c) {
    ChannelForm& form = form_[c];
    form.form = static_cast<Form>(coder.bypass(kFormBits, static_cast<std::uint32_t>(form.form)));
    if (form.form == Form::palette_before || form.form == Form::copy) {
      form.of = coder.bypass(kChannelBits, form.of);
      if (form.of >= c) return false;
      if (channels.channel[c].bits() != channels.channel[form.of].bits()) return false;
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
        !code_palette(coder, channels.channel[c], texels, values, form.palette)) {
      return false;
    }
  }
  // Mantissas need the exponent itself.
  if (channels.shared && form_[0].form != Form::plain && !is_constant(0)) return false;
  list_coded();
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

void ChannelForms::list_coded() {
  coded_count_ = 0;
  for (unsigned c = 0; c < channels_.count; ++c) {
    if (form_[c].form == Form::copy || is_constant(c)) continue;
    coded_[coded_count_++] = static_cast<std::uint8_t>(c);
  }
}

bool ChannelForms::have_places() const {
  return std::any_of(coded().begin(), coded().end(), [&](unsigned c) { return has_places(c); });
}

std::uint32_t ChannelForms::place_of(unsigned channel, std::uint32_t ordinal) const {
  const auto& palette = form_[channel].palette;
  const auto at = std::lower_bound(palette.begin(), palette.end() - 1, ordinal);
  return static_cast<std::uint32_t>(at - palette.begin());
}

void find_nearest(const Channel& channel, std::span<const std::uint32_t> palette,
                  Vector<std::uint16_t>& nearest) {
  nearest.resize(std::size_t{channel.largest()} + 1);
  std::size_t at = 0;
  for (std::uint32_t ordinal = 0; ordinal < nearest.size(); ++ordinal) {
    const auto off = [&](std::size_t place) {
      return palette[place] > ordinal ? palette[place] - ordinal : ordinal - palette[place];
    };
    while (at + 1 < palette.size() && off(at + 1) < off(at)) ++at;
    nearest[ordinal] = static_cast<std::uint16_t>(at);
  }
}

template bool ChannelForms::code(BinaryEncoder&, const Channels&, std::size_t, ValueModel&);
template bool ChannelForms::code(BinaryDecoder&, const Channels&, std::size_t, ValueModel&);

}  // namespace gicodec::native
