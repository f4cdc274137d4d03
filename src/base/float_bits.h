// A float and its bits. std::bit_cast is missing in libc++ 13.
#pragma once

#include <cstdint>
#include <cstring>

namespace gicodec {

inline std::uint32_t bits_of(float value) noexcept {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}
inline float float_of(std::uint32_t bits) noexcept {
  float value = 0;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

}  // namespace gicodec
