#include <gicodec/isa.h>

#include <algorithm>
#include <array>

namespace gicodec {
namespace {

constexpr std::array<Isa, 4> kAll{Isa::scalar, Isa::sse4, Isa::avx2, Isa::avx512};
constexpr std::array<std::string_view, 4> kNames{"scalar", "sse4", "avx2", "avx512"};

std::size_t count_supported() noexcept {
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (!__builtin_cpu_supports("sse4.1")) return 1;
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("bmi2")) return 2;
  if (!__builtin_cpu_supports("avx512f") || !__builtin_cpu_supports("avx512bw") ||
      !__builtin_cpu_supports("avx512cd") || !__builtin_cpu_supports("avx512dq") ||
      !__builtin_cpu_supports("avx512vl") || !__builtin_cpu_supports("avx512vbmi")) {
    return 3;
  }
  return 4;
#else
  return 1;
#endif
}

}  // namespace

std::span<const Isa> supported_isas() noexcept {
  static const std::size_t count = count_supported();
  return std::span(kAll).first(count);
}

bool is_supported(Isa isa) noexcept {
  const auto isas = supported_isas();
  return std::find(isas.begin(), isas.end(), isa) != isas.end();
}

std::string_view to_string(Isa isa) noexcept { return kNames[static_cast<std::size_t>(isa)]; }

std::optional<Isa> isa_from_string(std::string_view name) noexcept {
  const auto found = std::find(kNames.begin(), kNames.end(), name);
  if (found == kNames.end()) return std::nullopt;
  return kAll[static_cast<std::size_t>(found - kNames.begin())];
}

}  // namespace gicodec
