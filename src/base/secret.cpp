#include "base/secret.h"

#include <sys/random.h>
#include <unistd.h>
#include <algorithm>

namespace gicodec {

Status system_random(std::span<std::byte> out) noexcept {
  constexpr std::size_t kMax = 256;  // getentropy()'s limit per call
  while (!out.empty()) {
    const std::size_t size = std::min(out.size(), kMax);
    if (getentropy(out.data(), size) != 0) return Status::io_failed;
    out = out.subspan(size);
  }
  return Status::ok;
}

bool same_secret(std::span<const std::byte> a, std::span<const std::byte> b) noexcept {
  if (a.size() != b.size()) return false;
  std::byte difference{0};
  for (std::size_t i = 0; i < a.size(); ++i) difference |= a[i] ^ b[i];
  return difference == std::byte{0};
}

}  // namespace gicodec
