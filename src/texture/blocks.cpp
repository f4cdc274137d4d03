#include "texture/blocks.h"

#include "simd/kernels.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace gicodec {
namespace {

/// Calls body(run, place) for probes that stand side by side in the texture, at most 64 at a time;
/// `place` is that of the first in `probes`.
template <typename Byte, typename Body>
void walk_runs(const TextureDesc& desc, const CheckedView<Byte>& view,
               std::span<const std::uint32_t> probes, Body&& body) {
  constexpr std::size_t kMaxRun = 64;
  const unsigned texel = texel_bytes(desc);
  for (std::size_t place = 0; place < probes.size();) {
    // Along x every tiling moves by one block, except at the end of a row of the grid.
    const std::uint32_t first = probes[place];
    const std::size_t left =
        std::min({kMaxRun, probes.size() - place, std::size_t{desc.grid.x - first % desc.grid.x}});
    unsigned count = 1;
    while (count < left && probes[place + count] == first + count) ++count;
    body(BlockRun<Byte>{view.at(block_origin(desc, first), texel), view.row_pitch, count, desc.core,
                        desc.border, texel},
         place);
    place += count;
  }
}

}  // namespace

void strip(Isa isa, const TextureDesc& desc, const CheckedView<const std::byte>& view,
           std::span<const std::uint32_t> probes, std::span<std::byte> cores,
           std::vector<std::uint32_t>& stale) {
  const std::size_t size = core_bytes(desc);
  walk_runs(desc, view, probes, [&](const BlockRun<const std::byte>& run, std::size_t place) {
    std::uint64_t marks = kernels(isa).strip_run(run, cores.data() + place * size);
    for (; marks != 0; marks &= marks - 1) {
      stale.push_back(static_cast<std::uint32_t>(place + std::countr_zero(marks)));
    }
  });
}

void reconstruct(Isa isa, const TextureDesc& desc, const CheckedView<std::byte>& view,
                 std::span<const std::uint32_t> probes, std::span<const std::byte> cores) {
  const std::size_t size = core_bytes(desc);
  walk_runs(desc, view, probes, [&](const BlockRun<std::byte>& run, std::size_t place) {
    kernels(isa).reconstruct_run(cores.data() + place * size, run);
  });
}

namespace {

/// Visits a block's border in ring order: visit(texture bytes, ring bytes, size).
template <typename Byte, typename RingByte, typename Visit>
void walk_ring(const TextureDesc& desc, const CheckedView<Byte>& view, std::uint32_t probe,
               RingByte* ring, Visit&& visit) {
  const std::size_t texel = texel_bytes(desc);
  const std::size_t row_bytes = block_side(desc) * texel;
  Byte* block = view.at(block_origin(desc, probe), texel);
  visit(block, ring, row_bytes);
  ring += row_bytes;
  for (unsigned y = 1; y <= desc.core; ++y) {
    Byte* row = block + y * view.row_pitch;
    visit(row, ring, texel);
    visit(row + row_bytes - texel, ring + texel, texel);
    ring += 2 * texel;
  }
  visit(block + (desc.core + 1U) * view.row_pitch, ring, row_bytes);
}

}  // namespace

void gather_ring(const TextureDesc& desc, const CheckedView<const std::byte>& view,
                 std::uint32_t probe, std::span<std::byte> ring) {
  if (desc.border == 0) return;
  walk_ring(desc, view, probe, ring.data(),
            [](const std::byte* texels, std::byte* out, std::size_t size) {
              std::memcpy(out, texels, size);
            });
}

void scatter_ring(const TextureDesc& desc, const CheckedView<std::byte>& view, std::uint32_t probe,
                  std::span<const std::byte> ring) {
  if (desc.border == 0) return;
  walk_ring(desc, view, probe, ring.data(),
            [](std::byte* texels, const std::byte* in, std::size_t size) {
              std::memcpy(texels, in, size);
            });
}

}  // namespace gicodec
