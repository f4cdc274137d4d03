#include "transform/yuv444p16.h"

#include "texture/format_table.h"
#include "texture/shape.h"

namespace gicodec {
namespace {

constexpr unsigned kAlphaShift = 30;

struct Shifts {
  unsigned y, u, v;
};
constexpr Shifts shifts(Format format) {
  const auto& info = format_info(format);
  return {info.components[0].offset, info.components[1].offset, info.components[2].offset};
}

template <unsigned kY, unsigned kV, unsigned kUp>
void forward(const std::byte* __restrict texels, std::size_t count, std::uint16_t* __restrict y,
             std::uint16_t* __restrict u, std::uint16_t* __restrict v) noexcept {
  constexpr std::uint32_t kMask = 0x3FF;
  for (std::size_t i = 0; i < count; ++i) {
    const auto texel = load<std::uint32_t>(texels + 4 * i);
    y[i] = static_cast<std::uint16_t>((texel >> kY & kMask) << kUp);
    u[i] = static_cast<std::uint16_t>((texel >> 10 & kMask) << kUp);
    v[i] = static_cast<std::uint16_t>((texel >> kV & kMask) << kUp);
  }
}

template <unsigned kY, unsigned kV, unsigned kUp>
bool inverse(const std::uint16_t* __restrict y, const std::uint16_t* __restrict u,
             const std::uint16_t* __restrict v, std::size_t count,
             std::byte* __restrict texels) noexcept {
  std::uint16_t seen = 0;
  for (std::size_t i = 0; i < count; ++i) {
    seen = static_cast<std::uint16_t>(seen | y[i] | u[i] | v[i]);
    const std::uint32_t r = y[i] >> kUp, g = u[i] >> kUp, b = v[i] >> kUp;
    store(texels + 4 * i, r << kY | g << 10 | b << kV);
  }
  return (seen & ~(0x3FFU << kUp)) == 0;
}

/// Calls body with the shifts of R and B and the alignment shift as compile-time constants.
template <typename Body>
auto with_shifts(Format format, SampleAlignment alignment, Body&& body) noexcept {
  using std::integral_constant;
  constexpr auto kRgb = shifts(Format::A2R10G10B10_UNORM_PACK32);
  constexpr auto kBgr = shifts(Format::A2B10G10R10_UNORM_PACK32);
  static_assert(kRgb.u == 10 && kBgr.u == 10);
  const auto aligned = [&](auto up) {
    if (format == Format::A2R10G10B10_UNORM_PACK32) {
      return body(integral_constant<unsigned, kRgb.y>{}, integral_constant<unsigned, kRgb.v>{}, up);
    }
    return body(integral_constant<unsigned, kBgr.y>{}, integral_constant<unsigned, kBgr.v>{}, up);
  };
  return alignment == SampleAlignment::high ? aligned(integral_constant<unsigned, 6>{})
                                            : aligned(integral_constant<unsigned, 0>{});
}

}  // namespace

void to_yuv444p16(Format format, SampleAlignment alignment, std::span<const std::byte> texels,
                  const Planes<std::uint16_t>& planes) noexcept {
  with_shifts(format, alignment, [&](auto y, auto v, auto up) {
    forward<y(), v(), up()>(texels.data(), texels.size() / 4, planes.y.data(), planes.u.data(),
                            planes.v.data());
  });
}

bool from_yuv444p16(Format format, SampleAlignment alignment,
                    const Planes<const std::uint16_t>& planes,
                    std::span<std::byte> texels) noexcept {
  return with_shifts(format, alignment, [&](auto y, auto v, auto up) {
    return inverse<y(), v(), up()>(planes.y.data(), planes.u.data(), planes.v.data(),
                                   texels.size() / 4, texels.data());
  });
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
