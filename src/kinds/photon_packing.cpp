// Photons as values and as 20 bytes (FORMAT.md, "Photons"). All arithmetic is in binary64, in which
// every step but the divisions and roots is exact or rounded once.
#include <gicodec/photons.h>

#include "base/float_bits.h"
#include "kinds/octahedral_code.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace gicodec {
namespace {

constexpr double kLargest = std::numeric_limits<float>::max();
constexpr double kLargestHalf = 65504, kLargestShared = 65408;

/// Clamps to 0..most; NaN becomes 0.
double within(double value, double most) noexcept { return value > 0 ? std::min(value, most) : 0; }

/// Clamps to finite floats.
float to_float(double value) noexcept {
  return static_cast<float>(std::clamp(value, -kLargest, kLargest));
}

/// Rounds to nearest, ties to even. Precondition: 0 <= value <= kLargestHalf.
std::uint16_t to_half(double value) noexcept {
  constexpr int kFraction = 10, kMin = -14;
  if (value == 0) return 0;
  const int exponent = std::max(std::ilogb(value), kMin);
  const double steps = std::ldexp(value, kFraction - exponent);
  double whole = std::floor(steps);
  const double rest = steps - whole;
  if (rest > 0.5 || (rest == 0.5 && std::fmod(whole, 2) != 0)) ++whole;
  // Adding lets a fraction that rounds up to 2 carry into the exponent; subnormals have no implicit
  // 1.
  const int code = ((exponent - kMin) << kFraction) + static_cast<int>(whole);
  return static_cast<std::uint16_t>(code);
}

float from_half(std::uint16_t bits) noexcept {
  const std::uint32_t sign = std::uint32_t{bits} >> 15 << 31, fraction = bits & 0x3FFU;
  const std::uint32_t exponent = bits >> 10 & 31U;
  if (exponent == 31) return float_of(sign | 0x7F800000U | fraction << 13);
  if (exponent != 0) return float_of(sign | (exponent + 112) << 23 | fraction << 13);
  const auto magnitude = static_cast<float>(fraction) * (1.0F / 16777216);
  return sign != 0 ? -magnitude : magnitude;
}

constexpr int kMantissa = 9, kBias = 15;

std::uint32_t to_shared_exponent(const std::array<float, 3>& value) noexcept {
  std::array<double, 3> c{};
  for (std::size_t i = 0; i < 3; ++i) c[i] = within(value[i], kLargestShared);
  const double most = std::max({c[0], c[1], c[2]});
  int exponent = most > 0 ? std::max(std::ilogb(most) + 1 + kBias, 0) : 0;
  const auto steps = [&](double v) {
    return std::floor(std::ldexp(v, kBias + kMantissa - exponent) + 0.5);
  };
  if (steps(most) >= 1 << kMantissa) ++exponent;
  std::uint32_t bits = static_cast<std::uint32_t>(exponent) << 3 * kMantissa;
  for (std::size_t i = 0; i < 3; ++i) {
    bits |= static_cast<std::uint32_t>(steps(c[i])) << (kMantissa * i);
  }
  return bits;
}

std::array<float, 3> from_shared_exponent(std::uint32_t bits) noexcept {
  const int exponent = static_cast<int>(bits >> 3 * kMantissa) - kBias - kMantissa;
  std::array<float, 3> value{};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint32_t mantissa = bits >> (kMantissa * i) & 0x1FFU;
    value[i] = std::ldexp(static_cast<float>(mantissa), exponent);
  }
  return value;
}

std::uint16_t to_place(double position, double minimum, double extent) noexcept {
  if (!(extent > 0)) return 0;
  return static_cast<std::uint16_t>(
      std::floor(within((position - minimum) / extent, 1) * 65535 + 0.5));
}
float from_place(std::uint16_t code, double minimum, double extent) noexcept {
  return to_float(minimum + extent * code / 65535);
}

Octahedral to_octahedral(const std::array<float, 3>& direction, std::int32_t most) noexcept {
  const double x = direction[0], y = direction[1], z = direction[2];
  const double size = std::abs(x) + std::abs(y) + std::abs(z);
  if (!(size > 0 && size <= 3 * kLargest)) return {};
  double a = x / size, b = y / size;
  if (z < 0) octahedral::fold(a, b);
  const auto code = [most](double p) {
    return static_cast<std::int32_t>(std::floor(std::clamp(p, -1.0, 1.0) * most + 0.5));
  };
  return octahedral::unique({code(a), code(b)}, most);
}

std::array<float, 3> from_octahedral(Octahedral code, std::int32_t most) noexcept {
  const auto [x, y, z] = octahedral::direction(code, most);
  return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
}

// Byte offsets of fields in the record.
constexpr std::size_t kDirection = 6, kPowerHalves = 8, kRadiusHalves = 14;
constexpr std::size_t kRadiusShared = 10, kPowerShared = 12, kNormalisation = 16;

template <typename T>
void put(std::byte* at, T value) noexcept {
  std::memcpy(at, &value, sizeof value);
}
template <typename T>
T get(const std::byte* at) noexcept {
  T value{};
  std::memcpy(&value, at, sizeof value);
  return value;
}

}  // namespace

void pack_photon(const Photon& photon, const PhotonBatch& batch, PhotonForm form,
                 PhotonBytes out) noexcept {
  std::byte* const to = out.data();
  for (std::size_t i = 0; i < 3; ++i) {
    put(to + 2 * i, to_place(photon.position[i], batch.minimum[i], batch.extent[i]));
  }
  const std::uint16_t radius = to_half(within(photon.radius, kLargestHalf));
  if (form == PhotonForm::halves) {
    const Octahedral code = to_octahedral(photon.direction, 127);
    put(to + kDirection, static_cast<std::int8_t>(code.u));
    put(to + kDirection + 1, static_cast<std::int8_t>(code.v));
    for (std::size_t i = 0; i < 3; ++i) {
      put(to + kPowerHalves + 2 * i, to_half(within(photon.power[i], kLargestHalf)));
    }
    put(to + kRadiusHalves, radius);
  } else {
    const Octahedral code = to_octahedral(photon.direction, 32767);
    put(to + kDirection, static_cast<std::int16_t>(code.u));
    put(to + kDirection + 2, static_cast<std::int16_t>(code.v));
    put(to + kRadiusShared, radius);
    put(to + kPowerShared, to_shared_exponent(photon.power));
  }
  put(to + kNormalisation, to_float(within(photon.normalisation, kLargest)));
}

Photon unpack_photon(ConstPhotonBytes bytes, const PhotonBatch& batch, PhotonForm form) noexcept {
  const std::byte* const from = bytes.data();
  Photon photon;
  for (std::size_t i = 0; i < 3; ++i) {
    photon.position[i] =
        from_place(get<std::uint16_t>(from + 2 * i), batch.minimum[i], batch.extent[i]);
  }
  if (form == PhotonForm::halves) {
    photon.direction = from_octahedral(
        {get<std::int8_t>(from + kDirection), get<std::int8_t>(from + kDirection + 1)}, 127);
    for (std::size_t i = 0; i < 3; ++i) {
      photon.power[i] = from_half(get<std::uint16_t>(from + kPowerHalves + 2 * i));
    }
    photon.radius = from_half(get<std::uint16_t>(from + kRadiusHalves));
  } else {
    photon.direction = from_octahedral(
        {get<std::int16_t>(from + kDirection), get<std::int16_t>(from + kDirection + 2)}, 32767);
    photon.radius = from_half(get<std::uint16_t>(from + kRadiusShared));
    photon.power = from_shared_exponent(get<std::uint32_t>(from + kPowerShared));
  }
  photon.normalisation = float_of(get<std::uint32_t>(from + kNormalisation));
  return photon;
}

void pack_photon_batch(const PhotonBatch& batch,
                       std::span<std::byte, kPhotonBatchBytes> out) noexcept {
  std::byte* const to = out.data();
  for (std::size_t i = 0; i < 3; ++i) {
    put(to + 4 * i, bits_of(batch.minimum[i]));
    put(to + 12 + 4 * i, bits_of(batch.extent[i]));
  }
  put(to + 24, bits_of(batch.watts));
  put(to + 28, batch.light);
  put(to + 30, batch.generation);
  put(to + 32, batch.emitted);
}

PhotonBatch unpack_photon_batch(std::span<const std::byte, kPhotonBatchBytes> bytes) noexcept {
  const std::byte* const from = bytes.data();
  PhotonBatch batch;
  for (std::size_t i = 0; i < 3; ++i) {
    batch.minimum[i] = float_of(get<std::uint32_t>(from + 4 * i));
    batch.extent[i] = float_of(get<std::uint32_t>(from + 12 + 4 * i));
  }
  batch.watts = float_of(get<std::uint32_t>(from + 24));
  batch.light = get<std::uint16_t>(from + 28);
  batch.generation = get<std::uint16_t>(from + 30);
  batch.emitted = get<std::uint32_t>(from + 32);
  return batch;
}

}  // namespace gicodec
