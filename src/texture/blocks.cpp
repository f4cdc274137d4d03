#include "texture/blocks.h"

#include "texture/block_kernels.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace gicodec {
namespace {

/// True if the kernels handle the blocks: square, full, of depth 1, with or without a guard band.
bool in_kernels(const TextureDesc& desc) {
  return desc.block.x == desc.block.y && desc.block.z == 1 && desc.records.x == 0;
}

/// Calls body(run, place) for runs of at most 64 blocks at equal distances in memory; `place` is
/// the index in `blocks` of the run's first.
template <typename Byte, typename Body>
void walk_runs(const TextureDesc& desc, const CheckedView<Byte>& view,
               std::span<const std::uint32_t> blocks, Body&& body) {
  constexpr std::size_t kMaxRun = 64;
  const unsigned record = desc.record.bytes;
  const std::uint32_t row = laid_out(desc).x;
  for (std::size_t place = 0; place < blocks.size();) {
    // Along x every tiling moves by one tile, right or down, until the grid's row ends.
    const std::uint32_t first = blocks[place];
    const std::size_t left =
        std::min({kMaxRun, blocks.size() - place, std::size_t{row - first % row}});
    unsigned count = 1;
    while (count < left && blocks[place + count] == first + count) ++count;
    Byte* const at = view.at(block_origin(desc, first), record);
    std::size_t step = 0;
    if (count > 1) {
      step = static_cast<std::size_t>(view.at(block_origin(desc, first + 1), record) - at);
    }
    body(BlockRun<Byte>{at, view.row_pitch, step, count, desc.block.x, desc.guard_band, record},
         place);
    place += count;
  }
}

/// Visits a block's rows within the texture: visit(bytes of the texture, offset in the block,
/// size).
template <typename Byte, typename Visit>
void walk_rows(const TextureDesc& desc, const CheckedView<Byte>& view, std::uint32_t block,
               Visit&& visit) {
  const std::size_t record = desc.record.bytes, row = desc.block.x * record;
  const BlockShape inside = block_inside(desc, block);
  Byte* const first = view.at(block_origin(desc, block), record);
  for (unsigned z = 0; z < inside.z; ++z) {
    for (unsigned y = 0; y < inside.y; ++y) {
      visit(first + z * view.slice_pitch + y * view.row_pitch,
            (std::size_t{z} * desc.block.y + y) * row, inside.x * record);
    }
  }
}

}  // namespace

void strip(Isa isa, const TextureDesc& desc, const CheckedView<const std::byte>& view,
           std::span<const std::uint32_t> blocks, std::span<std::byte> records,
           Vector<std::uint32_t>& stale) {
  const std::size_t size = block_bytes(desc);
  if (!in_kernels(desc)) {
    for (std::size_t place = 0; place < blocks.size(); ++place) {
      const auto to = records.subspan(place * size, size);
      if (!(block_inside(desc, blocks[place]) == desc.block)) {
        std::fill(to.begin(), to.end(), std::byte{0});
      }
      walk_rows(desc, view, blocks[place],
                [&](const std::byte* from, std::size_t at, std::size_t n) {
                  std::memcpy(to.data() + at, from, n);
                });
    }
    return;
  }
  walk_runs(desc, view, blocks, [&](const BlockRun<const std::byte>& run, std::size_t place) {
    std::uint64_t marks = kernels<BlockKernels>(isa).strip_run(run, records.data() + place * size);
    for (; marks != 0; marks &= marks - 1) {
      stale.push_back(
          static_cast<std::uint32_t>(place + static_cast<unsigned>(std::countr_zero(marks))));
    }
  });
}

void reconstruct(Isa isa, const TextureDesc& desc, const CheckedView<std::byte>& view,
                 std::span<const std::uint32_t> blocks, std::span<const std::byte> records) {
  const std::size_t size = block_bytes(desc);
  if (!in_kernels(desc)) {
    for (std::size_t place = 0; place < blocks.size(); ++place) {
      const std::byte* const from = records.data() + place * size;
      walk_rows(desc, view, blocks[place], [&](std::byte* to, std::size_t at, std::size_t n) {
        std::memcpy(to, from + at, n);
      });
    }
    return;
  }
  walk_runs(desc, view, blocks, [&](const BlockRun<std::byte>& run, std::size_t place) {
    kernels<BlockKernels>(isa).reconstruct_run(records.data() + place * size, run);
  });
}

namespace {

/// Visits a block's guard band in band order: visit(texture bytes, band bytes, size).
template <typename Byte, typename BandByte, typename Visit>
void walk_band(const TextureDesc& desc, const CheckedView<Byte>& view, std::uint32_t block,
               BandByte* band, Visit&& visit) {
  const std::size_t record = desc.record.bytes;
  const unsigned core = desc.block.x;
  const std::size_t row_bytes = (core + 2) * record;
  Byte* first = view.at(block_origin(desc, block), record);
  visit(first, band, row_bytes);
  band += row_bytes;
  for (unsigned y = 1; y <= core; ++y) {
    Byte* row = first + y * view.row_pitch;
    visit(row, band, record);
    visit(row + row_bytes - record, band + record, record);
    band += 2 * record;
  }
  visit(first + (core + 1U) * view.row_pitch, band, row_bytes);
}

}  // namespace

void gather_band(const TextureDesc& desc, const CheckedView<const std::byte>& view,
                 std::uint32_t block, std::span<std::byte> band) {
  if (desc.guard_band == 0) return;
  walk_band(desc, view, block, band.data(),
            [](const std::byte* records, std::byte* out, std::size_t size) {
              std::memcpy(out, records, size);
            });
}

void scatter_band(const TextureDesc& desc, const CheckedView<std::byte>& view, std::uint32_t block,
                  std::span<const std::byte> band) {
  if (desc.guard_band == 0) return;
  walk_band(desc, view, block, band.data(),
            [](std::byte* records, const std::byte* in, std::size_t size) {
              std::memcpy(records, in, size);
            });
}

}  // namespace gicodec
