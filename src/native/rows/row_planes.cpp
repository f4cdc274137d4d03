#include "native/rows/row_planes.h"

#include "native/frame/workspace.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace gicodec::native {

bool takes_rows(const TextureDesc& desc) noexcept { return takes_raster(desc); }

namespace {

/// Whether places save more than the list of ordinals takes, about. Where most follow one another,
/// there is little between a value and its prediction that does not occur.
bool places_pay(std::span<const std::uint32_t> ordinals, std::size_t texels) {
  constexpr std::uint64_t kShare = 32;  // one of so many bits between ordinals is saved
  std::uint64_t between = 0, next = 0;
  for (std::size_t i = 1; i < ordinals.size(); ++i) {
    const std::uint32_t gap = ordinals[i] - ordinals[i - 1];
    between += static_cast<std::uint64_t>(std::bit_width(gap)) - 1;
    next += gap == 1 ? 1 : 0;
  }
  const std::uint64_t gaps = ordinals.size() - 1;
  const std::uint64_t list = 2 * between + std::min(gaps, 3 * std::min(next, gaps - next));
  return between * texels > kShare * gaps * list;
}

/// True only if more than `most` values occur: so many hashes of them do.
bool surely_more(std::span<const std::uint32_t> values, std::size_t most,
                 Vector<std::uint8_t>& occurs) {
  constexpr unsigned kHashBits = 17;
  occurs.assign(std::size_t{1} << kHashBits, 0);
  std::size_t hashes = 0;
  for (const std::uint32_t value : values) {
    std::uint8_t& occurred = occurs[value * 0x9E3779B1U >> (32 - kHashBits)];
    hashes += 1U - occurred;
    occurred = 1;
    if (hashes > most) return true;
  }
  return false;
}

std::size_t round_up(std::size_t n, std::size_t to) { return (n + to - 1) / to * to; }

/// Rows of blocks, most of which have 8 texels.
void copy_row(std::uint16_t* to, const std::uint16_t* from, std::size_t width) {
  if (width == 8) {
    std::memcpy(to, from, 16);
  } else {
    std::memcpy(to, from, width * 2);
  }
}

}  // namespace

void RowPlanes::lay_out(const Update& u, std::span<const std::uint32_t> positions, bool zero) {
  channels_ = channels_of(u.desc.record);
  // Planes come in the order of components, but for the second before the first.
  const Record& record = u.desc.record;
  unsigned plane = 0;
  for (unsigned i = 0; i < record.count; ++i) {
    const unsigned offset = record.components[record.count >= 3 && i < 2 ? 1 - i : i].offset;
    unsigned c = 0;
    while (channels_.channel[c].component.offset != offset) ++c;
    plane_of_[c] = static_cast<std::uint8_t>(plane);
    plane += is_wide(c) ? 2 : 1;
  }
  box_ = box_around(u.desc.grid, u.probes, positions);
  columns_ = std::size_t{box_.blocks.x} * u.desc.block.x;
  rows_of_slice_ = std::size_t{box_.blocks.y} * u.desc.block.y;
  rows_ = rows_of_slice_ * box_.blocks.z * u.desc.block.z;
  stride_ = round_up(columns_, 8) + kMargin;
  plane_ = (1 + rows_ + kLanes) * stride_ + 2 * kMargin;
  bool wide = false;
  for (unsigned c = 0; c < channels_.count; ++c) wide = wide || is_wide(c);
  const std::size_t size = (wide ? 2 : 1) * channels_.count * plane_;
  if (values_.size() < size) values_.resize(size);
  if (zero) std::fill_n(values_.begin(), size, std::uint16_t{0});
  for (unsigned c = 0; c < channels_.count; ++c) {
    if (is_wide(c)) wide_[c].assign(texels(), 0);
  }
  block_.resize(block_stride(u.layout.planes, u.texels()));
}

template <typename Body>
void RowPlanes::for_each_row(const Update& u, std::uint32_t block, const Body& body) const {
  const auto& b = u.desc.block;
  const Grid first = box_.texel_of(u.desc, block);
  const std::size_t x0 = first.x, y0 = first.y, z0 = first.z;
  std::size_t value = 0;
  for (std::size_t z = z0; z < z0 + b.z; ++z) {
    for (std::size_t y = y0; y < y0 + b.y; ++y, value += b.x) {
      body(value, z * rows_of_slice_ + y, x0);
    }
  }
}

void RowPlanes::load_mirror(const Update& u) {
  box_.for_each_received(
      u.desc.grid, u.mirror,
      [&](std::uint32_t block, std::span<const std::byte> records) { load(u, block, records); });
}

void RowPlanes::load(const Update& u, std::uint32_t block, std::span<const std::byte> records) {
  u.kernels.unpack(u.layout, reinterpret_cast<const std::uint8_t*>(records.data()), u.texels(),
                   block_.data());
  const std::size_t width = u.desc.block.x, texels = u.texels();
  // Pairs are unpacked to R and G − 2·R.
  for (std::size_t i = 0; i < texels && u.layout.pairs; ++i) {
    block_[texels + i] = static_cast<std::uint16_t>(block_[texels + i] + 2 * block_[i]);
  }
  for (unsigned c = 0; c < channels_.count; ++c) {
    const std::uint16_t* const high = block_.data() + plane_of_[c] * u.texels();
    const std::uint16_t* const low = high + u.texels();
    for_each_row(u, block, [&](std::size_t value, std::size_t y, std::size_t x) {
      if (!is_wide(c)) {
        copy_row(row(c, y) + x, high + value, width);
        return;
      }
      std::uint32_t* const to = wide(c, y) + x;
      for (std::size_t i = 0; i < width; ++i) {
        to[i] = static_cast<std::uint32_t>(high[value + i]) << 16 | low[value + i];
      }
    });
  }
}

void RowPlanes::store(const Update& u, std::uint32_t position, std::span<std::byte> records) {
  const std::size_t width = u.desc.block.x;
  for (unsigned c = 0; c < channels_.count; ++c) {
    std::uint16_t* const high = block_.data() + plane_of_[c] * u.texels();
    std::uint16_t* const low = high + u.texels();
    for_each_row(u, u.probes[position], [&](std::size_t value, std::size_t y, std::size_t x) {
      if (!is_wide(c)) {
        copy_row(high + value, row(c, y) + x, width);
        return;
      }
      const std::uint32_t* const from = wide(c, y) + x;
      for (std::size_t i = 0; i < width; ++i) {
        high[value + i] = static_cast<std::uint16_t>(from[i] >> 16);
        low[value + i] = static_cast<std::uint16_t>(from[i]);
      }
    });
  }
  for (std::size_t i = 0; i < u.texels() && u.layout.pairs; ++i) {
    block_[u.texels() + i] = static_cast<std::uint16_t>(block_[u.texels() + i] - 2 * block_[i]);
  }
  u.kernels.pack(u.layout, block_.data(), u.texels(),
                 reinterpret_cast<std::uint8_t*>(records.data()));
  if (!u.partial()) return;
  const BlockPresence presence(u.desc, u.presence_of(position));
  const std::size_t size = u.desc.record.bytes;
  for (std::uint32_t r = 0; r < u.texels(); ++r) {
    if (presence.exists(r)) continue;
    std::fill_n(records.begin() + static_cast<std::ptrdiff_t>(r * size), size, std::byte{0});
  }
}

template <typename Body>
void RowPlanes::for_each_value(unsigned channel, const Body& body) {
  for (std::size_t y = 0; y < rows_; ++y) {
    std::uint16_t* const values = row(channel, y);
    for (std::size_t x = 0; x < columns_; ++x) body(values[x]);
  }
}

void RowPlanes::flip(unsigned c) {
  const std::uint32_t sign = 1U << (channels_.channel[c].bits() - 1U);
  for_each_value(
      c, [sign](std::uint16_t& value) { value = static_cast<std::uint16_t>(value ^ sign); });
}

void RowPlanes::to_ordinals() {
  for (unsigned c = 0; c < channels_.count; ++c) {
    const Component& component = channels_.channel[c].component;
    if (is_wide(c)) {
      for (auto& value : wide_[c]) value = ordinal_of(component, value);
    } else if (component.type == ComponentType::snorm) {
      flip(c);
    } else if (component.type == ComponentType::sfloat) {
      // As ordinal_of(), without a branch.
      for_each_value(c, [](std::uint16_t& value) {
        const int negative = static_cast<std::int16_t>(value) >> 15;
        value = static_cast<std::uint16_t>(value ^ (negative | 0x8000));
      });
    }
  }
}

void RowPlanes::to_bits() {
  for (unsigned c = 0; c < channels_.count; ++c) {
    const Component& component = channels_.channel[c].component;
    if (is_wide(c)) {
      for (auto& value : wide_[c]) value = bits_of(component, value);
    } else if (component.type == ComponentType::snorm) {
      flip(c);
    } else if (component.type == ComponentType::sfloat) {
      for_each_value(c, [](std::uint16_t& value) {
        const int negative = ~(static_cast<std::int16_t>(value) >> 15);
        value = static_cast<std::uint16_t>(value ^ (negative | 0x8000));
      });
    }
  }
}

/// Into `ordinals_`; false if those of a wide channel are too many.
bool RowPlanes::find_ordinals(unsigned c) {
  ordinals_.clear();
  if (!is_wide(c)) {
    occurs_.assign(std::size_t{1} << channels_.channel[c].bits(), 0);
    for_each_value(c, [occurs = occurs_.data()](std::uint16_t value) { occurs[value] = 1; });
    for (std::uint32_t n = 0; n < occurs_.size(); ++n) {
      if (occurs_[n] != 0) ordinals_.push_back(n);
    }
    return true;
  }
  const std::size_t most = std::min<std::size_t>(texels() / 4 + 1, UINT16_MAX);
  if (surely_more(wide_[c], most, occurs_)) return false;
  // Sorted and without doubles each time that as many came again.
  constexpr std::size_t kFew = 1024;
  std::size_t known = 0;
  const auto tidy = [&] {
    std::sort(ordinals_.begin(), ordinals_.end());
    ordinals_.erase(std::unique(ordinals_.begin(), ordinals_.end()), ordinals_.end());
    known = ordinals_.size();
    return known <= most;
  };
  for (const std::uint32_t value : wide_[c]) {
    if (!ordinals_.empty() && ordinals_.back() == value) continue;
    ordinals_.push_back(value);
    if (ordinals_.size() >= 2 * known + kFew && !tidy()) return false;
  }
  return tidy();
}

bool RowPlanes::is_copy(unsigned c, unsigned of) {
  if (is_wide(c)) return wide_[c] == wide_[of];
  for (std::size_t y = 0; y < rows_; ++y) {
    if (std::memcmp(row(c, y), row(of, y), columns_ * 2) != 0) return false;
  }
  return true;
}

bool RowPlanes::choose_forms(RowChoice choice, ChannelForms& forms) {
  forms.begin(channels_);
  places_left_out_ = false;
  for (unsigned c = 0; c < channels_.count; ++c) {
    const bool found = find_ordinals(c);
    bool copied = false;
    for (unsigned a = 0; a < c && !copied && (!found || ordinals_.size() > 1); ++a) {
      copied = forms.may_copy(c, a) && is_copy(c, a);
      if (copied) forms.choose_copy(c, a);
    }
    if (copied) continue;
    forms.choose(c, ordinals_, texels(), found);
    if (forms.has_places(c) && !is_wide(c) && !choice.places && !places_pay(ordinals_, texels())) {
      forms.choose(c, ordinals_, texels(), false);
      places_left_out_ = true;
    }
    if (has_halves(forms, c) && !choice.halves) return false;
  }
  return true;
}

bool RowPlanes::list_coded(const ChannelForms& forms) {
  const auto channels = forms.coded();
  coded_count_ = static_cast<unsigned>(channels.size());
  std::copy(channels.begin(), channels.end(), coded_.begin());
  for (const unsigned c : channels) {
    if (!has_halves(forms, c)) continue;
    if (coded_count_ == coded_.size()) return false;
    coded_[coded_count_++] = static_cast<std::uint8_t>(low_plane(c));
  }
  return true;
}

/// Places, or halves.
void RowPlanes::wide_to_planes(const ChannelForms& forms, unsigned c) {
  const bool halves = has_halves(forms, c);
  for (std::size_t y = 0; y < rows_; ++y) {
    const std::uint32_t* const from = wide(c, y);
    std::uint16_t* const to = row(c, y);
    if (!halves) {
      for (std::size_t x = 0; x < columns_; ++x) {
        to[x] = x > 0 && from[x] == from[x - 1]
                    ? to[x - 1]
                    : static_cast<std::uint16_t>(forms.place_of(c, from[x]));
      }
      continue;
    }
    std::uint16_t* const low = row(low_plane(c), y);
    for (std::size_t x = 0; x < columns_; ++x) {
      to[x] = static_cast<std::uint16_t>(from[x] >> 16);
      low[x] = static_cast<std::uint16_t>(from[x]);
    }
  }
}
void RowPlanes::wide_from_planes(const ChannelForms& forms, unsigned c) {
  const ChannelForm& form = forms[c];
  if (form.form == Form::copy) {
    std::copy(wide_[form.of].begin(), wide_[form.of].end(), wide_[c].begin());
    return;
  }
  if (forms.is_constant(c)) {
    std::fill(wide_[c].begin(), wide_[c].end(), form.palette[0]);
    return;
  }
  const bool halves = has_halves(forms, c);
  for (std::size_t y = 0; y < rows_; ++y) {
    const std::uint16_t* const from = row(c, y);
    const std::uint16_t* const low = row(halves ? low_plane(c) : c, y);
    std::uint32_t* const to = wide(c, y);
    for (std::size_t x = 0; x < columns_; ++x) {
      to[x] = halves ? static_cast<std::uint32_t>(from[x]) << 16 | low[x] : form.palette[from[x]];
    }
  }
}

void RowPlanes::to_planes(const ChannelForms& forms) {
  for (unsigned c = 0; c < channels_.count; ++c) {
    if (is_wide(c)) {
      if (has_halves(forms, c) || forms.has_places(c)) wide_to_planes(forms, c);
      continue;
    }
    if (!forms.has_places(c)) continue;
    const auto& palette = forms[c].palette;
    table_.resize(std::size_t{1} << channels_.channel[c].bits());
    std::uint16_t place = 0;
    for (std::uint32_t ordinal = 0; ordinal < table_.size(); ++ordinal) {
      while (place + 1U < palette.size() && palette[place] < ordinal) ++place;
      table_[ordinal] = place;
    }
    for_each_value(c, [table = table_.data()](std::uint16_t& value) { value = table[value]; });
  }
}

void RowPlanes::from_planes(const ChannelForms& forms) {
  for (unsigned c = 0; c < channels_.count; ++c) {
    const ChannelForm& form = forms[c];
    if (is_wide(c)) {
      wide_from_planes(forms, c);
    } else if (form.form == Form::copy) {
      for (std::size_t y = 0; y < rows_; ++y) {
        std::memcpy(row(c, y), row(form.of, y), columns_ * 2);
      }
    } else if (forms.is_constant(c)) {
      for_each_value(c, [&](std::uint16_t& v) { v = static_cast<std::uint16_t>(form.palette[0]); });
    } else if (forms.has_places(c)) {
      table_.assign(form.palette.begin(), form.palette.end());
      for_each_value(c, [table = table_.data()](std::uint16_t& value) { value = table[value]; });
    }
  }
}

}  // namespace gicodec::native
