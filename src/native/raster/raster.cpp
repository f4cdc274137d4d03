#include "native/raster/raster.h"

#include "native/frame/workspace.h"
#include "quantise/component_code.h"

#include <algorithm>

namespace gicodec::native {
namespace {

Grid place_in_grid(const Grid& grid, std::uint32_t block) {
  return {block % grid.x, block / grid.x % grid.y, block / grid.x / grid.y};
}

}  // namespace

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

std::size_t blocks_around(const Update& u, std::span<const std::uint32_t> positions) {
  Grid first = u.desc.grid, last{};
  for (const std::uint32_t position : positions) {
    const Grid place = place_in_grid(u.desc.grid, u.probes[position]);
    first = {std::min(first.x, place.x), std::min(first.y, place.y), std::min(first.z, place.z)};
    last = {std::max(last.x, place.x), std::max(last.y, place.y), std::max(last.z, place.z)};
  }
  return std::size_t{last.x - first.x + 1} * (last.y - first.y + 1) * (last.z - first.z + 1);
}

std::uint64_t raster_memory(const TextureDesc& desc) noexcept {
  // Ordinals now and before, a trace of each in two slices, palettes; mixers and matches. Of rows
  // values now and before, a strip's five times, and steps.
  constexpr std::uint64_t kValue = 40, kRowValue = 32, kFixed = 1 << 20;
  const std::uint64_t block = std::uint64_t{record_count(desc.block)} * desc.record.count;
  const std::uint64_t most = std::max<std::uint64_t>(kMaxRasterValues, block);
  return kValue * std::min(most, block * block_count(desc)) +
         kRowValue * std::min<std::uint64_t>(kMaxRowValues, row_values(desc, desc.grid)) + kFixed;
}

template <typename Body>
void Raster::for_each_record(const Update& u, std::uint32_t block, const Body& body) const {
  const auto& b = u.desc.block;
  const Grid place = place_in_grid(u.desc.grid, block);
  const std::size_t x0 = std::size_t{place.x - first_.x} * b.x,
                    y0 = std::size_t{place.y - first_.y} * b.y,
                    z0 = std::size_t{place.z - first_.z} * b.z;
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
  Grid last{};
  first_ = u.desc.grid;
  for (const std::uint32_t position : positions) {
    const Grid place = place_in_grid(u.desc.grid, u.probes[position]);
    first_ = {std::min(first_.x, place.x), std::min(first_.y, place.y),
              std::min(first_.z, place.z)};
    last = {std::max(last.x, place.x), std::max(last.y, place.y), std::max(last.z, place.z)};
  }
  size_ = {(last.x - first_.x + 1) * u.desc.block.x, (last.y - first_.y + 1) * u.desc.block.y,
           (last.z - first_.z + 1) * u.desc.block.z};
  const std::size_t texels = std::size_t{size_.x} * size_.y * size_.z;
  coded_.assign(texels + 1, 0);
  now_.resize((texels + 1) * channels_.count);
  for (unsigned c = 0; c < channels_.count; ++c) {
    const std::uint32_t zero = ordinal_of(channels_.channel[c].component, 0);
    now_[c] = 0;
    for (std::size_t i = 1; i <= texels; ++i) now(i)[c] = zero;
  }
  if (u.mirrored) {
    const Grid& grid = u.desc.grid;
    for (std::uint32_t z = first_.z; z <= last.z; ++z) {
      for (std::uint32_t y = first_.y; y <= last.y; ++y) {
        for (std::uint32_t x = first_.x; x <= last.x; ++x) {
          const std::uint32_t block = x + grid.x * (y + grid.y * z);
          if (u.mirror.is_received(block)) read(u, block, u.mirror.blocks[block], nullptr);
        }
      }
    }
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
