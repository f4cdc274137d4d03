#include "transform/yuv444p8.h"

namespace gicodec {

void to_yuv444p8(std::span<const std::byte> row, const Planes<std::uint8_t>& planes) noexcept {
  const std::size_t whole = row.size() / 3;
  const auto* __restrict from = reinterpret_cast<const std::uint8_t*>(row.data());
  std::uint8_t* __restrict y = planes.y.data();
  std::uint8_t* __restrict u = planes.u.data();
  std::uint8_t* __restrict v = planes.v.data();
  for (std::size_t i = 0; i < whole; ++i) {
    y[i] = from[3 * i];
    u[i] = from[3 * i + 1];
    v[i] = from[3 * i + 2];
  }
  if (const std::size_t rest = row.size() % 3; rest > 0) {
    y[whole] = from[3 * whole];
    u[whole] = rest > 1 ? from[3 * whole + 1] : std::uint8_t{0};
    v[whole] = 0;
  }
}

bool from_yuv444p8(const Planes<const std::uint8_t>& planes, std::span<std::byte> row) noexcept {
  const std::size_t whole = row.size() / 3;
  auto* __restrict to = reinterpret_cast<std::uint8_t*>(row.data());
  const std::uint8_t* __restrict y = planes.y.data();
  const std::uint8_t* __restrict u = planes.u.data();
  const std::uint8_t* __restrict v = planes.v.data();
  for (std::size_t i = 0; i < whole; ++i) {
    to[3 * i] = y[i];
    to[3 * i + 1] = u[i];
    to[3 * i + 2] = v[i];
  }
  const std::size_t rest = row.size() % 3;
  if (rest == 0) return true;
  to[3 * whole] = y[whole];
  if (rest > 1) to[3 * whole + 1] = u[whole];
  return v[whole] == 0 && (rest > 1 || u[whole] == 0);
}

}  // namespace gicodec
