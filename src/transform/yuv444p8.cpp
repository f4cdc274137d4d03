#include "transform/yuv444p8.h"

#include "transform/yuv444_kernels.h"

namespace gicodec {

void to_yuv444p8(Isa isa, std::span<const std::byte> row,
                 const Planes<std::uint8_t>& planes) noexcept {
  const std::size_t whole = row.size() / 3;
  kernels<Yuv444Kernels>(isa).split_bytes(row.data(), whole, planes.y.data(), planes.u.data(),
                                          planes.v.data());
  if (const std::size_t rest = row.size() % 3; rest > 0) {
    const auto tail = row.last(rest);
    planes.y[whole] = static_cast<std::uint8_t>(tail[0]);
    planes.u[whole] = rest > 1 ? static_cast<std::uint8_t>(tail[1]) : std::uint8_t{0};
    planes.v[whole] = 0;
  }
}

bool from_yuv444p8(Isa isa, const Planes<const std::uint8_t>& planes,
                   std::span<std::byte> row) noexcept {
  const std::size_t whole = row.size() / 3;
  kernels<Yuv444Kernels>(isa).join_bytes(planes.y.data(), planes.u.data(), planes.v.data(), whole,
                                         row.data());
  const std::size_t rest = row.size() % 3;
  if (rest == 0) return true;
  const auto tail = row.last(rest);
  tail[0] = std::byte{planes.y[whole]};
  if (rest > 1) tail[1] = std::byte{planes.u[whole]};
  return planes.v[whole] == 0 && (rest > 1 || planes.u[whole] == 0);
}

}  // namespace gicodec
