#include "base/secret.h"

#if defined(_WIN32)
#ifndef NOMINMAX
#define NOMINMAX
#endif
#include <windows.h>
// Needs windows.h.
#include <bcrypt.h>
#else
#include <sys/random.h>
#include <unistd.h>
#endif

#include <algorithm>

namespace gicodec {
namespace {

constexpr std::size_t kMax = 256;  // getentropy()'s limit per call

bool fill(std::span<std::byte> out) noexcept {
#if defined(_WIN32)
  return BCryptGenRandom(nullptr, reinterpret_cast<unsigned char*>(out.data()),
                         static_cast<ULONG>(out.size()), BCRYPT_USE_SYSTEM_PREFERRED_RNG) == 0;
#else
  return getentropy(out.data(), out.size()) == 0;
#endif
}

}  // namespace

Status system_random(std::span<std::byte> out) noexcept {
  while (!out.empty()) {
    const std::size_t size = std::min(out.size(), kMax);
    if (!fill(out.first(size))) return Status::io_failed;
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
