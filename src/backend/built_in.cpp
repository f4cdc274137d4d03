// The backends of the core library.
#include "backend/byte_backend.h"
#include "backend/find_backend.h"
#include "backend/native.h"

#include <array>

namespace gicodec {
namespace {

constinit const ByteBackend kRaw(kBackendRaw, Compression::none);
#ifdef GICODEC_NO_COMPRESSORS
constinit const NativeBackend kNative;
constexpr std::array<const Backend*, 2> kBuiltIn{&kRaw, &kNative};
#else
constinit const ByteBackend kLz4(kBackendLz4, Compression::lz4);
constinit const ByteBackend kZstd(kBackendZstd, Compression::zstd);
constinit const NativeBackend kNative;
constexpr std::array<const Backend*, 4> kBuiltIn{&kRaw, &kLz4, &kZstd, &kNative};
#endif

constexpr std::array<std::string_view, 5> kNames{"raw", "lz4", "zstd", "hevc", "native"};

}  // namespace

std::span<const Backend* const> built_in_backends() noexcept { return kBuiltIn; }

const Backend* find_backend(std::span<const Backend* const> callers,
                            std::string_view name) noexcept {
  for (const auto list : {callers, built_in_backends()}) {
    for (const Backend* backend : list) {
      if (backend != nullptr && backend->name() == name) return backend;
    }
  }
  return nullptr;
}

const Backend* find_backend(std::uint8_t id) noexcept {
  for (const Backend* backend : kBuiltIn) {
    if (backend->id() == id) return backend;
  }
  return nullptr;
}

std::string_view backend_name(std::uint8_t id) noexcept {
  return id < kNames.size() ? kNames[id] : std::string_view{};
}

}  // namespace gicodec
