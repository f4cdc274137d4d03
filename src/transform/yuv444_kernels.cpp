// Codes and bytes ↔ three planes of samples, for one instruction set (simd/dispatch.h).
#include "transform/yuv444_kernels.h"

#include "simd/intrinsics.h"
#include "simd/vector.h"

#include <cstring>

namespace gicodec::GICODEC_ISA {
namespace {

#include GICODEC_VECTORS

constexpr std::uint32_t kCodeMask = 0x3FF;

/// Shifts known at compile time, so that they are immediate operands.
template <unsigned y_shift, unsigned u_shift, unsigned v_shift, unsigned up>
struct Codes {
  /// The 10 bits from `shift` on, moved to bit `up`.
  template <unsigned shift>
  GICODEC_INLINE static U32 code(U32 texel) {
    const U32 mask = set32(kCodeMask << up);
    if constexpr (shift >= up) {
      return bit_and(shift_right<int{shift - up}>(texel), mask);
    } else {
      return bit_and(shift_left<int{up - shift}>(texel), mask);
    }
  }
  template <unsigned shift>
  static std::uint16_t code(std::uint32_t texel) {
    return static_cast<std::uint16_t>((texel >> shift & kCodeMask) << up);
  }

  /// The inverse.
  template <unsigned shift>
  GICODEC_INLINE static U32 place(I16 sample) {
    return shift_left<int{shift}>(widen(shift_right<int{up}>(sample)));
  }

  static void split(const std::byte* __restrict texels, std::size_t count,
                    std::uint16_t* __restrict y, std::uint16_t* __restrict u,
                    std::uint16_t* __restrict v) {
    std::size_t i = 0;
    for (; i + kLanes <= count; i += kLanes) {
      const U32 texel = load(reinterpret_cast<const std::uint32_t*>(texels + 4 * i));
      store(y + i, narrow(code<y_shift>(texel)));
      store(u + i, narrow(code<u_shift>(texel)));
      store(v + i, narrow(code<v_shift>(texel)));
    }
    for (; i < count; ++i) {
      std::uint32_t texel;
      std::memcpy(&texel, texels + 4 * i, sizeof texel);
      y[i] = code<y_shift>(texel);
      u[i] = code<u_shift>(texel);
      v[i] = code<v_shift>(texel);
    }
  }

  static std::uint16_t join(const std::uint16_t* __restrict y, const std::uint16_t* __restrict u,
                            const std::uint16_t* __restrict v, std::size_t count,
                            std::byte* __restrict texels) {
    I16 bits = set(0);
    std::size_t i = 0;
    for (; i + kLanes <= count; i += kLanes) {
      const I16 a = load(y + i), b = load(u + i), c = load(v + i);
      bits = bit_or(bits, bit_or(bit_or(a, b), c));
      store(reinterpret_cast<std::uint32_t*>(texels + 4 * i),
            bit_or(bit_or(place<y_shift>(a), place<u_shift>(b)), place<v_shift>(c)));
    }
    std::uint16_t lanes[kLanes], seen = 0;
    store(lanes, bits);
    for (const std::uint16_t lane : lanes) seen |= lane;
    for (; i < count; ++i) {
      seen = static_cast<std::uint16_t>(seen | y[i] | u[i] | v[i]);
      const std::uint32_t r = y[i] >> up, g = u[i] >> up, b = v[i] >> up;
      const std::uint32_t texel = r << y_shift | g << u_shift | b << v_shift;
      std::memcpy(texels + 4 * i, &texel, sizeof texel);
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
  const auto* const from = reinterpret_cast<const std::uint8_t*>(bytes);
  std::size_t i = 0;
  for (; i + kTriples <= count; i += kTriples) split3(from + 3 * i, {y + i, u + i, v + i});
  for (; i < count; ++i) {
    y[i] = from[3 * i];
    u[i] = from[3 * i + 1];
    v[i] = from[3 * i + 2];
  }
}

void join_bytes(const std::uint8_t* __restrict y, const std::uint8_t* __restrict u,
                const std::uint8_t* __restrict v, std::size_t count, std::byte* __restrict bytes) {
  auto* const to = reinterpret_cast<std::uint8_t*>(bytes);
  std::size_t i = 0;
  for (; i + kTriples <= count; i += kTriples) join3({y + i, u + i, v + i}, to + 3 * i);
  for (; i < count; ++i) {
    to[3 * i] = y[i];
    to[3 * i + 1] = u[i];
    to[3 * i + 2] = v[i];
  }
}

constexpr Yuv444Kernels kKernels{split_codes, join_codes, split_bytes, join_bytes};

}  // namespace
}  // namespace gicodec::GICODEC_ISA

namespace gicodec {
template <>
constinit const Yuv444Kernels TableOf<Yuv444Kernels, Isa::GICODEC_ISA>::kernels =
    GICODEC_ISA::kKernels;
}  // namespace gicodec
