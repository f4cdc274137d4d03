#include "transform/byte_planes.h"

#include "simd/kernels.h"
#include "texture/format_table.h"

#include <algorithm>

namespace gicodec {
namespace {

/// Texels per step: a step's texels and values stay in the first-level cache.
constexpr std::size_t kStep = 512;

std::size_t place_in_table(Format format) {
  return static_cast<std::size_t>(&format_info(format) - kFormats.data());
}

}  // namespace

void to_byte_planes(Isa isa, Format format, std::span<const std::byte> texels,
                    std::span<const std::byte> reference, std::span<std::byte> planes) {
  const std::size_t place = place_in_table(format);
  const std::size_t size = kFormats[place].texel_bytes;
  const std::size_t total = texels.size() / size;
  for (std::size_t i = 0; i < total; i += kStep) {
    kernels(isa).to_planes(place, texels.data() + i * size,
                           reference.empty() ? nullptr : reference.data() + i * size,
                           planes.data() + i, std::min(kStep, total - i), total);
  }
}

void from_byte_planes(Isa isa, Format format, std::span<const std::byte> planes,
                      std::span<const std::byte> reference, std::span<std::byte> texels) {
  const std::size_t place = place_in_table(format);
  const std::size_t size = kFormats[place].texel_bytes;
  const std::size_t total = texels.size() / size;
  for (std::size_t i = 0; i < total; i += kStep) {
    kernels(isa).from_planes(place, planes.data() + i,
                             reference.empty() ? nullptr : reference.data() + i * size,
                             texels.data() + i * size, std::min(kStep, total - i), total);
  }
}

}  // namespace gicodec
