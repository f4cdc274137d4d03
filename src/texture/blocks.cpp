#include "texture/blocks.h"

#include "texture/guard_band.h"
#include "texture/shape.h"

#include <cstring>

namespace gicodec {
namespace {

/// Block origins of successive probes; a probe that follows its predecessor costs no division.
class OriginCursor {
 public:
  explicit OriginCursor(const TextureDesc& desc) noexcept : desc_(desc), side_(block_side(desc)) {}
  BlockOrigin at(std::uint32_t probe) noexcept {
    // Along x every tiling moves by one column, except at the end of a row of the grid.
    if (probe == next_ && left_ > 0) {
      origin_.x += side_;
      --left_;
    } else {
      origin_ = block_origin(desc_, probe);
      left_ = desc_.grid.x - 1 - probe % desc_.grid.x;
    }
    next_ = probe + 1;
    return origin_;
  }

 private:
  const TextureDesc& desc_;
  std::uint32_t side_;
  std::uint32_t next_ = 0;
  std::uint32_t left_ = 0;
  BlockOrigin origin_;
};

template <typename S>
bool block_follows_rule(S shape, const std::byte* block, std::size_t pitch) {
  using Texel = typename S::Texel;
  const std::byte* core = block + pitch + sizeof(Texel);
  Difference difference;
  walk_rule(shape, [&](unsigned y, unsigned x, unsigned row, unsigned column) {
    difference.add(load<Texel>(block + y * pitch + x * sizeof(Texel)),
                   load<Texel>(core + row * pitch + column * sizeof(Texel)));
  });
  return !difference.any();
}

}  // namespace

void strip(const TextureDesc& desc, const CheckedView<const std::byte>& view,
           std::span<const std::uint32_t> probes, std::span<std::byte> cores,
           std::vector<std::uint32_t>& stale) {
  with_shape(desc, [&](auto shape) {
    using Texel = typename decltype(shape)::Texel;
    const std::size_t row_bytes = shape.core() * sizeof(Texel);
    const std::size_t inset = desc.border * (view.row_pitch + sizeof(Texel));
    OriginCursor origins(desc);
    std::byte* to = cores.data();
    for (std::uint32_t place = 0; place < probes.size(); ++place) {
      const std::byte* block = view.at(origins.at(probes[place]), sizeof(Texel));
      for (unsigned y = 0; y < shape.core(); ++y, to += row_bytes) {
        std::memcpy(to, block + inset + y * view.row_pitch, row_bytes);
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
    OriginCursor origins(desc);
    const std::byte* from = cores.data();
    for (const std::uint32_t probe : probes) {
      std::byte* block = view.at(origins.at(probe), sizeof(Texel));
      std::byte* core = block + desc.border * (pitch + sizeof(Texel));
      for (unsigned y = 0; y < n; ++y) {
        std::memcpy(core + y * pitch, from + y * row_bytes, row_bytes);
      }
      if (desc.border != 0) {
        walk_rule(shape, [&](unsigned y, unsigned x, unsigned row, unsigned column) {
          store(block + y * pitch + x * sizeof(Texel),
                load<Texel>(from + row * row_bytes + column * sizeof(Texel)));
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
  const std::byte* first =
      view.at(block_origin(desc, probe), texel) + desc.border * (view.row_pitch + texel);
  for (unsigned y = 0; y < desc.core; ++y) {
    const std::byte* row = first + y * view.row_pitch;
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
