#include "texture/blocks.h"

#include "texture/guard_band.h"
#include "texture/shape.h"

#include <cstring>

namespace gicodec {
namespace {

template <typename S>
bool block_follows_rule(S shape, const std::byte* block, std::size_t pitch) {
  using Texel = typename S::Texel;
  const unsigned n = shape.core();
  const std::byte* core = block + pitch + sizeof(Texel);
  bool same = true;
  apply_rule(
      shape, core, pitch,
      [&](unsigned y, const Texel* row) {
        same &= std::memcmp(block + y * pitch, row, (n + 2) * sizeof(Texel)) == 0;
      },
      [&](unsigned j, Texel left, Texel right) {
        const std::byte* row = core + j * pitch;
        same &= load<Texel>(row - sizeof(Texel)) == left;
        same &= load<Texel>(row + n * sizeof(Texel)) == right;
      });
  return same;
}

}  // namespace

void strip(const TextureDesc& desc, const CheckedView<const std::byte>& view,
           std::span<const std::uint32_t> probes, std::span<std::byte> cores,
           std::vector<std::uint32_t>& stale) {
  with_shape(desc, [&](auto shape) {
    using Texel = typename decltype(shape)::Texel;
    const std::size_t row_bytes = shape.core() * sizeof(Texel);
    const std::size_t inset = desc.border * (view.row_pitch + sizeof(Texel));
    std::byte* to = cores.data();
    for (std::uint32_t place = 0; place < probes.size(); ++place) {
      const std::byte* block = view.at(block_origin(desc, probes[place]), sizeof(Texel));
      const std::byte* row = block + inset;
      for (unsigned y = 0; y < shape.core(); ++y, row += view.row_pitch, to += row_bytes) {
        std::memcpy(to, row, row_bytes);
      }
      if (desc.border != 0 && !block_follows_rule(shape, block, view.row_pitch)) {
        stale.push_back(place);
      }
    }
  });
}

void reconstruct(const TextureDesc& desc, const CheckedView<std::byte>& view,
                 std::span<const std::uint32_t> probes, std::span<const std::byte> cores) {
  with_shape(desc, [&](auto shape) {
    using Texel = typename decltype(shape)::Texel;
    const unsigned n = shape.core();
    const std::size_t row_bytes = n * sizeof(Texel);
    const std::size_t pitch = view.row_pitch;
    const std::byte* from = cores.data();
    for (const std::uint32_t probe : probes) {
      std::byte* block = view.at(block_origin(desc, probe), sizeof(Texel));
      std::byte* core = block + desc.border * (pitch + sizeof(Texel));
      for (unsigned y = 0; y < n; ++y) {
        std::memcpy(core + y * pitch, from + y * row_bytes, row_bytes);
      }
      if (desc.border != 0) {
        apply_rule(
            shape, from, row_bytes,
            [&](unsigned y, const Texel* row) {
              std::memcpy(block + y * pitch, row, row_bytes + 2 * sizeof(Texel));
            },
            [&](unsigned j, Texel left, Texel right) {
              store(core + j * pitch - sizeof(Texel), left);
              store(core + j * pitch + row_bytes, right);
            });
      }
      from += n * row_bytes;
    }
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

bool core_equals(const TextureDesc& desc, const CheckedView<const std::byte>& view,
                 std::uint32_t probe, std::span<const std::byte> core) noexcept {
  const std::size_t texel = texel_bytes(desc);
  const std::size_t row_bytes = desc.core * texel;
  const std::byte* row =
      view.at(block_origin(desc, probe), texel) + desc.border * (view.row_pitch + texel);
  for (unsigned y = 0; y < desc.core; ++y, row += view.row_pitch) {
    if (std::memcmp(row, core.data() + y * row_bytes, row_bytes) != 0) return false;
  }
  return true;
}

bool ring_follows_rule(const TextureDesc& desc, const CheckedView<const std::byte>& view,
                       std::uint32_t probe) {
  if (desc.border == 0) return true;
  bool same = true;
  with_shape(desc, [&](auto shape) {
    using Texel = typename decltype(shape)::Texel;
    same = block_follows_rule(shape, view.at(block_origin(desc, probe), sizeof(Texel)),
                              view.row_pitch);
  });
  return same;
}

}  // namespace gicodec
