#include "transform/byte_planes.h"

#include "texture/format_table.h"
#include "texture/shape.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace gicodec {
namespace {

/// Texels per step: a step's texels and values stay in the first-level cache.
constexpr std::size_t kStep = 512;

constexpr std::uint32_t mask(unsigned bits) {
  return static_cast<std::uint32_t>((std::uint64_t{1} << bits) - 1);
}

constexpr std::uint32_t fold(std::uint32_t value, std::uint32_t reference, unsigned bits) {
  // Sign-extend the difference from `bits` to 32, then zigzag.
  const auto difference = static_cast<std::int32_t>((value - reference) << (32 - bits)) >>
                          (32 - bits);
  return ((static_cast<std::uint32_t>(difference) << 1) ^
          static_cast<std::uint32_t>(difference >> 31)) & mask(bits);
}
constexpr std::uint32_t unfold(std::uint32_t folded, std::uint32_t reference, unsigned bits) {
  const std::uint32_t difference = (folded >> 1) ^ (0U - (folded & 1U));
  return (reference + difference) & mask(bits);
}

template <const FormatInfo& kInfo>
struct Texels {
  static constexpr std::size_t kBytes = kInfo.texel_bytes;
  static constexpr std::size_t kWords = kBytes < 4 ? 1 : kBytes / 4;
  using Word = std::conditional_t<kBytes == 2, std::uint16_t, std::uint32_t>;

  static constexpr unsigned word(unsigned c) { return kInfo.components[c].offset / 32U; }
  static constexpr unsigned shift(unsigned c) { return kInfo.components[c].offset % 32U; }
  static constexpr unsigned bits(unsigned c) { return kInfo.components[c].bits; }
  static constexpr unsigned whole(unsigned c) { return bits(c) / 8U; }
  /// First byte plane of component c.
  static constexpr unsigned plane(unsigned c) {
    unsigned sum = 0;
    for (unsigned i = 0; i < c; ++i) sum += whole(i);
    return sum;
  }
  /// First bit of component c in the plane of high bits.
  static constexpr unsigned high_bit(unsigned c) {
    unsigned sum = 0;
    for (unsigned i = 0; i < c; ++i) sum += bits(i) % 8U;
    return sum;
  }
  static constexpr unsigned kHighPlane = plane(kInfo.component_count);
  static_assert(high_bit(kInfo.component_count) == 8U * (kBytes - kHighPlane));

  static std::uint32_t component(const std::byte* texels, std::size_t i, unsigned c) {
    const auto* at = texels + i * kBytes + word(c) * 4;
    return (std::uint32_t{load<Word>(at)} >> shift(c)) & mask(bits(c));
  }

  static void forward(const std::byte* __restrict texels, const std::byte* __restrict reference,
                      std::byte* __restrict planes, std::size_t count, std::size_t stride) {
    std::uint8_t high[kStep] = {};
    for (unsigned c = 0; c < kInfo.component_count; ++c) {
      std::uint32_t values[kStep];
      for (std::size_t i = 0; i < count; ++i) values[i] = component(texels, i, c);
      if (reference != nullptr) {
        for (std::size_t i = 0; i < count; ++i) {
          values[i] = fold(values[i], component(reference, i, c), bits(c));
        }
      }
      for (unsigned k = 0; k < whole(c); ++k) {
        std::byte* to = planes + (plane(c) + k) * stride;
        for (std::size_t i = 0; i < count; ++i) to[i] = static_cast<std::byte>(values[i] >> 8 * k);
      }
      if constexpr (kHighPlane < kBytes) {
        for (std::size_t i = 0; i < count; ++i) {
          high[i] = static_cast<std::uint8_t>(high[i] | values[i] >> 8 * whole(c) << high_bit(c));
        }
      }
    }
    if constexpr (kHighPlane < kBytes) std::memcpy(planes + kHighPlane * stride, high, count);
  }

  static void inverse(const std::byte* __restrict planes, const std::byte* __restrict reference,
                      std::byte* __restrict texels, std::size_t count, std::size_t stride) {
    Word words[kWords][kStep] = {};
    for (unsigned c = 0; c < kInfo.component_count; ++c) {
      std::uint32_t values[kStep] = {};
      for (unsigned k = 0; k < whole(c); ++k) {
        const std::byte* from = planes + (plane(c) + k) * stride;
        for (std::size_t i = 0; i < count; ++i) {
          values[i] |= std::to_integer<std::uint32_t>(from[i]) << 8 * k;
        }
      }
      if constexpr (kHighPlane < kBytes) {
        const std::byte* from = planes + kHighPlane * stride;
        for (std::size_t i = 0; i < count; ++i) {
          const auto part = std::to_integer<std::uint32_t>(from[i]) >> high_bit(c);
          values[i] |= (part & mask(bits(c) % 8)) << 8 * whole(c);
        }
      }
      if (reference != nullptr) {
        for (std::size_t i = 0; i < count; ++i) {
          values[i] = unfold(values[i], component(reference, i, c), bits(c));
        }
      }
      for (std::size_t i = 0; i < count; ++i) {
        words[word(c)][i] = static_cast<Word>(words[word(c)][i] | values[i] << shift(c));
      }
    }
    for (std::size_t w = 0; w < kWords; ++w) {
      for (std::size_t i = 0; i < count; ++i) store(texels + i * kBytes + 4 * w, words[w][i]);
    }
  }
};

/// Calls body(Texels<info>) for the format.
template <std::size_t kIndex = 0, typename Body>
void with_format(Format format, Body&& body) {
  if constexpr (kIndex < kFormats.size()) {
    if (kFormats[kIndex].format == format) return body(Texels<kFormats[kIndex]>{});
    with_format<kIndex + 1>(format, body);
  }
}

}  // namespace

void to_byte_planes(Format format, std::span<const std::byte> texels,
                    std::span<const std::byte> reference, std::span<std::byte> planes) {
  with_format(format, [&](auto t) {
    const std::size_t total = texels.size() / t.kBytes;
    for (std::size_t i = 0; i < total; i += kStep) {
      t.forward(texels.data() + i * t.kBytes,
                reference.empty() ? nullptr : reference.data() + i * t.kBytes, planes.data() + i,
                std::min(kStep, total - i), total);
    }
  });
}

void from_byte_planes(Format format, std::span<const std::byte> planes,
                      std::span<const std::byte> reference, std::span<std::byte> texels) {
  with_format(format, [&](auto t) {
    const std::size_t total = texels.size() / t.kBytes;
    for (std::size_t i = 0; i < total; i += kStep) {
      t.inverse(planes.data() + i, reference.empty() ? nullptr : reference.data() + i * t.kBytes,
                texels.data() + i * t.kBytes, std::min(kStep, total - i), total);
    }
  });
}

}  // namespace gicodec
