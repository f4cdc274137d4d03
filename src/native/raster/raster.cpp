#include "native/raster/raster.h"

#include "native/frame/workspace.h"
#include "quantise/component_code.h"

#include <algorithm>

namespace gicodec::native {
bool fits_raster(const TextureDesc& desc, const Grid& box) noexcept {
  const std::uint64_t blocks = std::uint64_t{box.x} * box.y * box.z;
  return blocks == 1 || blocks * record_count(desc.block) * desc.record.count <= kMaxRasterValues;
}

namespace {

std::uint64_t row_values(const TextureDesc& desc, const Grid& box) {
  constexpr std::uint64_t kRows = 32;
  const std::uint64_t columns = std::uint64_t{box.x} * desc.block.x,
                      rows = std::uint64_t{box.y} * desc.block.y,
                      slices = std::uint64_t{box.z} * desc.block.z;
  return (columns + kRowMargin) * ((rows + kRows - 1) / kRows * kRows) * slices * desc.record.count;
}

}  // namespace

bool fits_rows(const TextureDesc& desc, const Grid& box) noexcept {
  return fits_raster(desc, box) && row_values(desc, box) <= kMaxRowValues;
}

std::uint32_t blocks_of_raster(const TextureDesc& desc) noexcept {
  const std::size_t values = std::size_t{record_count(desc.block)} * desc.record.count;
  return static_cast<std::uint32_t>(std::max<std::size_t>(1, kMaxRasterValues / values));
}

bool fills_rows(const Update& u, std::span<const std::uint32_t> positions) {
  return 4 * positions.size() >= box_around(u.desc.grid, u.probes, positions).count();
}

std::uint64_t raster_memory(const TextureDesc& desc) noexcept {
  // Ordinals now and before, a trace of each in two slices, palettes; mixers and matches. Of rows
  // values now and before, a strip's five times, and steps.
  constexpr std::uint64_t kValue = 40, kRowValue = 32, kFixed = 1 << 20;
  const std::uint64_t block = std::uint64_t{record_count(desc.block)} * desc.record.count;
  const auto used = desc.record.used();
  const bool halves = std::any_of(used.begin(), used.end(), [](auto& c) { return c.bits > 16; });
  const std::uint64_t most = std::max<std::uint64_t>(kMaxRasterValues, block);
  return kValue * std::min(most, block * block_count(desc)) +
         kRowValue * (halves ? 2 : 1) *
             std::min<std::uint64_t>(kMaxRowValues, row_values(desc, desc.grid)) +
         kFixed;
}

template <typename Body>
void Raster::for_each_record(const Update& u, std::uint32_t block, const Body& body) const {
  const auto& b = u.desc.block;
  const Grid first = box_.texel_of(u.desc, block);
  const std::size_t x0 = first.x, y0 = first.y, z0 = first.z;
  std::uint32_t record = 0;
  for (std::size_t z = z0; z < z0 + b.z; ++z) {
    for (std::size_t y = y0; y < y0 + b.y; ++y) {
      const std::size_t row = 1 + (z * size_.y + y) * size_.x + x0;
      for (std::size_t x = 0; x < b.x; ++x) body(record++, row + x);
    }
  }
}

void Raster::lay_out(const Update& u, std::span<const std::uint32_t> positions) {
  channels_ = channels_of(u.desc.record);
  box_ = box_around(u.desc.grid, u.probes, positions);
  size_ = {box_.blocks.x * u.desc.block.x, box_.blocks.y * u.desc.block.y,
           box_.blocks.z * u.desc.block.z};
  const std::size_t texels = std::size_t{size_.x} * size_.y * size_.z;
  coded_.assign(texels + 1, 0);
  now_.resize((texels + 1) * channels_.count);
  for (unsigned c = 0; c < channels_.count; ++c) {
    const std::uint32_t zero = ordinal_of(channels_.channel[c].component, 0);
    now_[c] = 0;
    for (std::size_t i = 1; i <= texels; ++i) now(i)[c] = zero;
  }
  if (u.mirrored) {
    box_.for_each_received(u.desc.grid, u.mirror,
                           [&](std::uint32_t block, std::span<const std::byte> records) {
                             read(u, block, records, nullptr);
                           });
  }
  past_.clear();
  if (u.update) past_.assign(now_.begin(), now_.end());
  coded_texels_ = 0;
  for (const std::uint32_t position : positions) {
    const BlockPresence presence(u.desc, u.presence_of(position));
    for_each_record(u, u.probes[position], [&](std::uint32_t record, std::size_t texel) {
      for (unsigned c = 0; c < channels_.count; ++c) {
        now(texel)[c] = ordinal_of(channels_.channel[c].component, 0);
      }
      if (!presence.exists(record)) return;
      coded_[texel] = 1;
      ++coded_texels_;
    });
  }
}

void Raster::read(const Update& u, std::uint32_t block, std::span<const std::byte> records,
                  const std::uint8_t* wanted) {
  const std::size_t size = u.desc.record.bytes;
  for_each_record(u, block, [&](std::uint32_t record, std::size_t texel) {
    if (wanted != nullptr && wanted[texel] == 0) return;
    const std::byte* const from = records.data() + record * size;
    std::uint32_t* const to = now(texel);
    for (unsigned c = 0; c < channels_.count; ++c) {
      const Component& component = channels_.channel[c].component;
      to[c] = ordinal_of(component, code_of(from, component, size));
    }
  });
}

void Raster::load(const Update& u, std::uint32_t position, std::span<const std::byte> records) {
  read(u, u.probes[position], records, coded_.data());
}

void Raster::store(const Update& u, std::uint32_t position, std::span<std::byte> records) const {
  const std::size_t size = u.desc.record.bytes;
  std::fill(records.begin(), records.end(), std::byte{0});
  for_each_record(u, u.probes[position], [&](std::uint32_t record, std::size_t texel) {
    if (!coded(texel)) return;
    std::byte* const to = records.data() + record * size;
    for (unsigned c = 0; c < channels_.count; ++c) {
      const Component& component = channels_.channel[c].component;
      set_code(to, component, size, bits_of(component, now(texel)[c]));
    }
  });
}

}  // namespace gicodec::native
