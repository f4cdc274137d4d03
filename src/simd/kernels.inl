// The source of every implementation of Kernels: included once per instruction set with
// GICODEC_ISA defined to its namespace, and compiled with that set's flags. Plain loops that the
// compiler vectorises, except where it does not find the byte shuffles.
//
// Everything here has internal linkage: an inline function with external linkage could be taken
// from this translation unit by others and run on a machine without the instruction set.

#include "simd/kernels.h"
#include "simd/narrow.h"
#include "simd/shuffle3.h"
#include "texture/format_table.h"

#include <cstring>
#include <type_traits>
#include <utility>

namespace gicodec::GICODEC_ISA {
namespace {

template <typename T>
T read(const std::byte* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}
template <typename T>
void write(std::byte* to, T value) {
  std::memcpy(to, &value, sizeof value);
}

}  // namespace
}  // namespace gicodec::GICODEC_ISA

#include "simd/block_kernels.inl"

namespace gicodec::GICODEC_ISA {
namespace {

constexpr std::uint32_t kCodeMask = 0x3FF;

/// Shifts known at compile time, so that they are immediate operands.
template <unsigned y_shift, unsigned u_shift, unsigned v_shift, unsigned up>
struct Codes {
  /// The 10 bits from `shift` on, moved to bit `up`.
  template <unsigned shift, typename T>
  static T code(T texel) {
    constexpr int down = int{shift} - int{up};
    if constexpr (down >= 0) {
      return (texel >> down) & (kCodeMask << up);
    } else {
      return (texel << -down) & (kCodeMask << up);
    }
  }

  static void split(const std::byte* __restrict texels, std::size_t count,
                    std::uint16_t* __restrict y, std::uint16_t* __restrict u,
                    std::uint16_t* __restrict v) {
    std::size_t i = 0;
    for (; i + 2 * kWords <= count; i += 2 * kWords) {
      Words a, b;
      std::memcpy(&a, texels + 4 * i, sizeof a);
      std::memcpy(&b, texels + 4 * i + sizeof a, sizeof b);
      store_narrow(code<y_shift>(a), code<y_shift>(b), y + i);
      store_narrow(code<u_shift>(a), code<u_shift>(b), u + i);
      store_narrow(code<v_shift>(a), code<v_shift>(b), v + i);
    }
    for (; i < count; ++i) {
      const auto texel = read<std::uint32_t>(texels + 4 * i);
      y[i] = static_cast<std::uint16_t>(code<y_shift>(texel));
      u[i] = static_cast<std::uint16_t>(code<u_shift>(texel));
      v[i] = static_cast<std::uint16_t>(code<v_shift>(texel));
    }
  }

  static std::uint16_t join(const std::uint16_t* __restrict y, const std::uint16_t* __restrict u,
                            const std::uint16_t* __restrict v, std::size_t count,
                            std::byte* __restrict texels) {
    std::uint16_t seen = 0;
    for (std::size_t i = 0; i < count; ++i) {
      seen = static_cast<std::uint16_t>(seen | y[i] | u[i] | v[i]);
      const std::uint32_t r = y[i] >> up, g = u[i] >> up, b = v[i] >> up;
      write(texels + 4 * i, r << y_shift | g << u_shift | b << v_shift);
    }
    return seen;
  }
};

/// body(Codes) for the shifts of the two packings and alignments.
template <typename Body>
auto with_codes(CodeShifts shifts, Body&& body) {
  const bool high = shifts.up != 0;
  if (shifts.y > shifts.v) return high ? body(Codes<20, 10, 0, 6>{}) : body(Codes<20, 10, 0, 0>{});
  return high ? body(Codes<0, 10, 20, 6>{}) : body(Codes<0, 10, 20, 0>{});
}

void split_codes(const std::byte* texels, std::size_t count, CodeShifts shifts, std::uint16_t* y,
                 std::uint16_t* u, std::uint16_t* v) {
  with_codes(shifts, [&](auto codes) { codes.split(texels, count, y, u, v); });
}

std::uint16_t join_codes(const std::uint16_t* y, const std::uint16_t* u, const std::uint16_t* v,
                         std::size_t count, CodeShifts shifts, std::byte* texels) {
  return with_codes(shifts, [&](auto codes) { return codes.join(y, u, v, count, texels); });
}

void split_bytes(const std::byte* __restrict bytes, std::size_t count, std::uint8_t* __restrict y,
                 std::uint8_t* __restrict u, std::uint8_t* __restrict v) {
  std::size_t i = split_bytes_shuffled(bytes, count, y, u, v);
  for (; i < count; ++i) {
    y[i] = static_cast<std::uint8_t>(bytes[3 * i]);
    u[i] = static_cast<std::uint8_t>(bytes[3 * i + 1]);
    v[i] = static_cast<std::uint8_t>(bytes[3 * i + 2]);
  }
}

void join_bytes(const std::uint8_t* __restrict y, const std::uint8_t* __restrict u,
                const std::uint8_t* __restrict v, std::size_t count, std::byte* __restrict bytes) {
  std::size_t i = join_bytes_shuffled(y, u, v, count, bytes);
  for (; i < count; ++i) {
    bytes[3 * i] = std::byte{y[i]};
    bytes[3 * i + 1] = std::byte{u[i]};
    bytes[3 * i + 2] = std::byte{v[i]};
  }
}

constexpr std::size_t kStep = 512;

constexpr std::uint32_t mask(unsigned bits) {
  return static_cast<std::uint32_t>((std::uint64_t{1} << bits) - 1);
}

constexpr std::uint32_t fold(std::uint32_t value, std::uint32_t reference, unsigned bits) {
  // Sign-extend the difference from `bits` to 32, then zigzag.
  const auto difference =
      static_cast<std::int32_t>((value - reference) << (32 - bits)) >> (32 - bits);
  return ((static_cast<std::uint32_t>(difference) << 1) ^
          static_cast<std::uint32_t>(difference >> 31)) &
         mask(bits);
}
constexpr std::uint32_t unfold(std::uint32_t folded, std::uint32_t reference, unsigned bits) {
  const std::uint32_t difference = (folded >> 1) ^ (0U - (folded & 1U));
  return (reference + difference) & mask(bits);
}

template <std::size_t kPlace>
struct Texels {
  static constexpr const FormatInfo& kInfo = kFormats[kPlace];
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

  template <unsigned c>
  static std::uint32_t component(const std::byte* texels, std::size_t i) {
    const auto* at = texels + i * kBytes + word(c) * 4;
    return (std::uint32_t{read<Word>(at)} >> shift(c)) & mask(bits(c));
  }

  template <unsigned c>
  static void forward_component(const std::byte* __restrict texels,
                                const std::byte* __restrict reference, std::byte* __restrict planes,
                                std::uint8_t* __restrict high, std::size_t count,
                                std::size_t stride) {
    std::uint32_t values[kStep];
    for (std::size_t i = 0; i < count; ++i) values[i] = component<c>(texels, i);
    if (reference != nullptr) {
      for (std::size_t i = 0; i < count; ++i) {
        values[i] = fold(values[i], component<c>(reference, i), bits(c));
      }
    }
    for (unsigned k = 0; k < whole(c); ++k) {
      std::byte* to = planes + (plane(c) + k) * stride;
      for (std::size_t i = 0; i < count; ++i) to[i] = static_cast<std::byte>(values[i] >> 8 * k);
    }
    if constexpr (bits(c) % 8 != 0) {
      for (std::size_t i = 0; i < count; ++i) {
        high[i] = static_cast<std::uint8_t>(high[i] | values[i] >> 8 * whole(c) << high_bit(c));
      }
    }
  }

  template <unsigned c>
  static void inverse_component(const std::byte* __restrict planes,
                                const std::byte* __restrict reference,
                                Word (*__restrict words)[kStep], std::size_t count,
                                std::size_t stride) {
    std::uint32_t values[kStep] = {};
    for (unsigned k = 0; k < whole(c); ++k) {
      const std::byte* from = planes + (plane(c) + k) * stride;
      for (std::size_t i = 0; i < count; ++i) {
        values[i] |= static_cast<std::uint32_t>(from[i]) << 8 * k;
      }
    }
    if constexpr (bits(c) % 8 != 0) {
      const std::byte* from = planes + kHighPlane * stride;
      for (std::size_t i = 0; i < count; ++i) {
        const auto part = static_cast<std::uint32_t>(from[i]) >> high_bit(c);
        values[i] |= (part & mask(bits(c) % 8)) << 8 * whole(c);
      }
    }
    if (reference != nullptr) {
      for (std::size_t i = 0; i < count; ++i) {
        values[i] = unfold(values[i], component<c>(reference, i), bits(c));
      }
    }
    for (std::size_t i = 0; i < count; ++i) {
      words[word(c)][i] = static_cast<Word>(words[word(c)][i] | values[i] << shift(c));
    }
  }

  /// body.operator()<c>() for each component.
  template <typename Body>
  static void each_component(Body&& body) {
    [&]<unsigned... c>(std::integer_sequence<unsigned, c...>) {
      (body.template operator()<c>(), ...);
    }
    (std::make_integer_sequence<unsigned, kInfo.component_count>{});
  }

  static void forward(const std::byte* texels, const std::byte* reference, std::byte* planes,
                      std::size_t count, std::size_t stride) {
    std::uint8_t high[kStep] = {};
    each_component([&]<unsigned c>() {
      forward_component<c>(texels, reference, planes, high, count, stride);
    });
    if constexpr (kHighPlane < kBytes) {
      if (count != 0) std::memcpy(planes + kHighPlane * stride, high, count);  // Maybe no memory.
    }
  }

  static void inverse(const std::byte* planes, const std::byte* reference, std::byte* texels,
                      std::size_t count, std::size_t stride) {
    Word words[kWords][kStep] = {};
    each_component(
        [&]<unsigned c>() { inverse_component<c>(planes, reference, words, count, stride); });
    for (std::size_t w = 0; w < kWords; ++w) {
      for (std::size_t i = 0; i < count; ++i) write(texels + i * kBytes + 4 * w, words[w][i]);
    }
  }
};

template <std::size_t kIndex = 0>
void to_planes(std::size_t format, const std::byte* texels, const std::byte* reference,
               std::byte* planes, std::size_t count, std::size_t stride) {
  if constexpr (kIndex < kFormats.size()) {
    if (format == kIndex) {
      return Texels<kIndex>::forward(texels, reference, planes, count, stride);
    }
    to_planes<kIndex + 1>(format, texels, reference, planes, count, stride);
  }
}

template <std::size_t kIndex = 0>
void from_planes(std::size_t format, const std::byte* planes, const std::byte* reference,
                 std::byte* texels, std::size_t count, std::size_t stride) {
  if constexpr (kIndex < kFormats.size()) {
    if (format == kIndex) {
      return Texels<kIndex>::inverse(planes, reference, texels, count, stride);
    }
    from_planes<kIndex + 1>(format, planes, reference, texels, count, stride);
  }
}

}  // namespace

extern const Kernels kKernels;
constinit const Kernels kKernels{strip_run,   reconstruct_run, split_codes, join_codes,
                                 split_bytes, join_bytes,      to_planes<>, from_planes<>};

}  // namespace gicodec::GICODEC_ISA
