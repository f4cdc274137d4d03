// Strips of a raster's rows ↔ lanes (docs/native/rows.md, "Strips").
#include "native/frame/workspace.h"
#include "native/rows/row_chunk.h"

#include <algorithm>
#include <bit>

namespace gicodec::native {
namespace {

/// Values that are moved at once.
constexpr std::size_t kTile = 8;

std::size_t tiled_steps(const RowPlanes& planes) {
  return (row_steps(planes.columns()) + kTile - 1) / kTile * kTile;
}

/// Rows from `y` on, each as far before its begin as its lane is behind.
std::array<std::uint16_t*, kLanes> skewed_rows(RowPlanes& planes, unsigned plane, std::size_t y) {
  std::array<std::uint16_t*, kLanes> rows;
  for (std::size_t l = 0; l < kLanes; ++l) {
    rows[l] = planes.row(plane, y + l) - kRowDelay * l;
  }
  return rows;
}

enum class From { here, above };
/// Rows from `y` on, or those above them.
void skew(const Kernels& kernels, RowPlanes& planes, unsigned plane, std::size_t y, From from,
          std::uint16_t* lanes) {
  const std::uint16_t* rows[kLanes];
  for (std::size_t l = 0; l < kLanes; ++l) {
    const std::uint16_t* const row =
        from == From::here ? planes.row(plane, y + l) : planes.row_above(plane, y + l);
    rows[l] = row - kRowDelay * l;
  }
  kernels.to_lanes(rows, tiled_steps(planes), lanes);
}

/// Values of the lanes of all strips of a slice.
std::size_t slice_lanes(const RowPlanes& planes) {
  return (planes.rows_of_slice() + kLanes - 1) / kLanes * tiled_steps(planes) * kLanes;
}

/// Of lanes that follow a step that does not exist.
void make_room(const RowPlanes& planes, Vector<std::uint16_t>& lanes) {
  lanes.assign((1 + tiled_steps(planes)) * kLanes, 0);
}

}  // namespace

void load_past(const Update& u, std::span<const std::uint32_t> positions, RowMemory& memory) {
  memory.past.lay_out(u, positions, true);
  memory.past.load_mirror(u);
  memory.past.to_ordinals();
  memory.past.to_planes(memory.forms);
}

RowStrip prepare_strips(bool update, RowMemory& memory) {
  RowPlanes& planes = memory.planes;
  const ChannelForms& forms = memory.forms;
  const Channels& channels = planes.channels();
  const auto coded = planes.coded();
  const std::size_t columns = planes.columns(), above = above_stride(columns);
  const bool slices = planes.has_slices();
  RowStrip strip{};
  strip.columns = static_cast<unsigned>(columns);
  strip.update = update;
  strip.channels = static_cast<unsigned>(coded.size());
  const bool exponents = channels.shared && !coded.empty() && coded[0] == 0;
  strip.lead = exponents ? 1 : 0;
  for (unsigned k = 0; k < strip.channels; ++k) {
    const unsigned c = planes.channel_of(coded[k]);
    const Channel& channel = channels.channel[c];
    const auto& palette = forms[c].palette;
    RowChannel& to = strip.channel[k];
    memory.lanes[k].resize(tiled_steps(planes) * kLanes);
    for (auto* lanes : {&memory.slice[k], &memory.slice_above[k]}) {
      if (slices) make_room(planes, *lanes);
    }
    if (slices) memory.z_residuals[k].assign(slice_lanes(planes), 0);
    for (auto* lanes : {&memory.past_lanes[k], &memory.past_above[k]}) {
      if (update) make_room(planes, *lanes);
    }
    const auto behind_first = [](auto& lanes) {
      return lanes.empty() ? nullptr : lanes.data() + kLanes;
    };
    to.slice = behind_first(memory.slice[k]);
    to.slice_above = behind_first(memory.slice_above[k]);
    to.past = behind_first(memory.past_lanes[k]);
    to.past_above = behind_first(memory.past_above[k]);
    memory.above[k].assign(kRowTrail * above, 0);
    to.values = memory.lanes[k].data();
    to.above = memory.above[k].data();
    to.low = planes.is_low(coded[k]);
    to.high = static_cast<std::uint8_t>(std::find(coded.begin(), coded.end(), c) - coded.begin());
    to.bits = to.low ? 16 : channel.bits() > 16 ? channel.bits() - 16 : channel.bits();
    to.largest = static_cast<std::uint16_t>((1U << to.bits) - 1);
    to.in_units = channel.in_units && exponents;
    to.last_place = to.largest;
    if (forms.has_places(c)) {
      to.largest = static_cast<std::uint16_t>(palette.size() - 1);
      to.bits = static_cast<unsigned>(std::bit_width(palette.size() - 1));
    }
    if (forms.has_palette_of_mantissas(c)) {
      find_nearest(channel, palette, memory.nearest[k]);
      memory.palette[k].assign(palette.begin(), palette.end());
      to.nearest = memory.nearest[k].data();
      to.palette = memory.palette[k].data();
      to.last_place = static_cast<std::uint16_t>(palette.size() - 1);
      to.bits = static_cast<unsigned>(std::bit_width(palette.size() - 1));
    }
  }
  memory.above_repeats.assign(above, 0);
  if (slices) memory.z_repeats.assign(slice_lanes(planes), 0);
  memory.trail.resize(trail_size(strip.channels));
  strip.above = memory.above_repeats.data();
  strip.trail = memory.trail.data();
  return strip;
}

RowClasses classes_of(const RowStrip& strip) {
  const auto lows = static_cast<unsigned>(
      std::count_if(strip.channel, strip.channel + strip.channels, [](auto& c) { return c.low; }));
  const unsigned whole = strip.channels - lows;
  const unsigned followers = whole > strip.lead ? whole - strip.lead - 1 : 0;
  return {strip.lead + 1, followers == 0 ? 0 : followers == 1 ? 2U : 4U, lows == 0 ? 0U : 2U};
}

void move_to(const Kernels& kernels, RowStrip& strip, RowMemory& memory, std::size_t y) {
  RowPlanes& planes = memory.planes;
  const std::size_t slice = planes.rows_of_slice(), left = slice - y % slice;
  strip.rows = static_cast<unsigned>(std::min<std::size_t>(kLanes, left));
  strip.first = left == slice;
  strip.deep = y >= slice;
  const bool slices = planes.has_slices();
  const std::size_t of_slice = y % slice / kLanes * tiled_steps(planes) * kLanes;
  strip.z_repeats = slices ? memory.z_repeats.data() + of_slice : nullptr;
  if (strip.first) {
    for (unsigned k = 0; k < strip.channels; ++k) {
      std::fill(memory.above[k].begin(), memory.above[k].end(), std::uint16_t{0});
    }
    std::fill(memory.above_repeats.begin(), memory.above_repeats.end(), std::uint16_t{0});
  }
  for (unsigned k = 0; k < strip.channels; ++k) {
    const unsigned plane = planes.coded()[k];
    strip.channel[k].z_residuals = slices ? memory.z_residuals[k].data() + of_slice : nullptr;
    const auto load = [&](RowPlanes& from, std::size_t row, Vector<std::uint16_t>& there,
                          Vector<std::uint16_t>& above) {
      skew(kernels, from, plane, row, From::here, there.data() + kLanes);
      skew(kernels, from, plane, row, From::above, above.data() + kLanes);
    };
    if (strip.deep) load(planes, y - slice, memory.slice[k], memory.slice_above[k]);
    if (strip.update) load(memory.past, y, memory.past_lanes[k], memory.past_above[k]);
  }
}

void load_lanes(const Kernels& kernels, RowMemory& memory, std::size_t y) {
  RowPlanes& planes = memory.planes;
  for (unsigned k = 0; k < planes.coded().size(); ++k) {
    skew(kernels, planes, planes.coded()[k], y, From::here, memory.lanes[k].data());
  }
}

void store_lanes(const Kernels& kernels, RowMemory& memory, const RowStrip& strip, std::size_t y) {
  RowPlanes& planes = memory.planes;
  for (unsigned k = 0; k < strip.channels; ++k) {
    const unsigned plane = planes.coded()[k];
    auto rows = skewed_rows(planes, plane, y);
    // Lanes without a row go behind the last one.
    for (unsigned l = strip.rows; l < kLanes; ++l) {
      rows[l] = planes.row(plane, planes.rows() + l) - kRowDelay * l;
    }
    kernels.from_lanes(memory.lanes[k].data(), tiled_steps(planes), rows.data());
  }
}

}  // namespace gicodec::native
