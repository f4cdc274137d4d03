#include "transform/yuv444p16.h"

#include "texture/texel.h"
#include "transform/yuv444_kernels.h"

namespace gicodec {
namespace {

constexpr unsigned kAlphaShift = 30;

CodeShifts shifts(Format format, SampleAlignment alignment) {
  const auto& components = find_format(format)->record.components;
  return {components[0].offset, components[1].offset, components[2].offset,
          alignment == SampleAlignment::high ? 6U : 0U};
}

}  // namespace

void to_yuv444p16(Isa isa, Format format, SampleAlignment alignment,
                  std::span<const std::byte> texels, const Planes<std::uint16_t>& planes) noexcept {
  kernels<Yuv444Kernels>(isa).split_codes(texels.data(), texels.size() / 4,
                                          shifts(format, alignment), planes.y.data(),
                                          planes.u.data(), planes.v.data());
}

bool from_yuv444p16(Isa isa, Format format, SampleAlignment alignment,
                    const Planes<const std::uint16_t>& planes,
                    std::span<std::byte> texels) noexcept {
  const auto shift = shifts(format, alignment);
  const unsigned seen = kernels<Yuv444Kernels>(isa).join_codes(
      planes.y.data(), planes.u.data(), planes.v.data(), texels.size() / 4, shift, texels.data());
  return (seen & ~(0x3FFU << shift.up)) == 0;
}

std::optional<std::uint8_t> constant_alpha(std::span<const std::byte> texels) noexcept {
  if (texels.empty()) return std::uint8_t{0};
  const auto first = load<std::uint32_t>(texels.data());
  std::uint32_t different = 0;
  for (std::size_t i = 0; i < texels.size(); i += 4) {
    different |= load<std::uint32_t>(texels.data() + i) ^ first;
  }
  if (different >> kAlphaShift != 0) return std::nullopt;
  return static_cast<std::uint8_t>(first >> kAlphaShift);
}

void pack_alpha(std::span<const std::byte> texels, std::span<std::byte> packed) noexcept {
  for (auto& byte : packed) byte = std::byte{0};
  for (std::size_t i = 0; i < texels.size() / 4; ++i) {
    const auto alpha = load<std::uint32_t>(texels.data() + 4 * i) >> kAlphaShift;
    packed[i / 4] |= static_cast<std::byte>(alpha << 2 * (i % 4));
  }
}

void add_alpha(std::uint8_t alpha, std::span<std::byte> texels) noexcept {
  const std::uint32_t bits = std::uint32_t{alpha} << kAlphaShift;
  for (std::size_t i = 0; i < texels.size(); i += 4) {
    store(texels.data() + i, load<std::uint32_t>(texels.data() + i) | bits);
  }
}

void unpack_alpha(std::span<const std::byte> packed, std::span<std::byte> texels) noexcept {
  for (std::size_t i = 0; i < texels.size() / 4; ++i) {
    const auto alpha = std::to_integer<std::uint32_t>(packed[i / 4]) >> 2 * (i % 4) & 3U;
    std::byte* at = texels.data() + 4 * i;
    store(at, load<std::uint32_t>(at) | alpha << kAlphaShift);
  }
}

}  // namespace gicodec
