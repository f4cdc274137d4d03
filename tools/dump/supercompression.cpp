#include "dump/supercompression.h"

#include "dump/cure.h"
#include "dump/error.h"

#include <zlib.h>
#include <zstd.h>

#include <array>

namespace gicodec::tools {
namespace {

constexpr std::array<std::string_view, 4> kNames = {"none", "BasisLZ", "Zstandard", "ZLIB"};
/// A level of zstd that is slow to pack only for large files.
constexpr int kZstdLevel = 12;

}  // namespace

std::string_view to_string(Scheme scheme) noexcept {
  const auto number = static_cast<std::size_t>(scheme);
  return number < kNames.size() ? kNames[number] : "";
}

std::optional<Scheme> scheme_from_string(std::string_view name) noexcept {
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (kNames[i] == name) return static_cast<Scheme>(i);
  }
  return std::nullopt;
}

std::vector<std::byte> pack_level(Scheme scheme, std::span<const std::byte> level,
                                  const std::string& path) {
  std::vector<std::byte> packed;
  if (scheme == Scheme::zstandard) {
    packed.resize(ZSTD_compressBound(level.size()));
    const std::size_t size =
        ZSTD_compress(packed.data(), packed.size(), level.data(), level.size(), kZstdLevel);
    if (ZSTD_isError(size) != 0) fail(Exit::internal, "{}: {}", path, ZSTD_getErrorName(size));
    packed.resize(size);
    return packed;
  }
  uLongf size = compressBound(static_cast<uLong>(level.size()));
  packed.resize(size);
  const int status = compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                               reinterpret_cast<const Bytef*>(level.data()),
                               static_cast<uLong>(level.size()), Z_DEFAULT_COMPRESSION);
  if (status != Z_OK) fail(Exit::internal, "{}: {}", path, zError(status));
  packed.resize(size);
  return packed;
}

std::vector<std::byte> unpack_level(Scheme scheme, std::span<const std::byte> packed,
                                    std::size_t bytes, const std::string& path) {
  if (scheme == Scheme::zstandard) {
    // Before anything is allocated.
    const auto said = ZSTD_getFrameContentSize(packed.data(), packed.size());
    if (said != ZSTD_CONTENTSIZE_UNKNOWN && said != ZSTD_CONTENTSIZE_ERROR && said != bytes) {
      fail(Exit::bad_input, "{}: a level is damaged: it unpacks to {} bytes, not {}; {}", path,
           said, bytes, to_cure(Cure::get_again));
    }
  }
  std::vector<std::byte> level(bytes);
  std::size_t got = 0;
  std::string_view why;
  if (scheme == Scheme::zstandard) {
    got = ZSTD_decompress(level.data(), level.size(), packed.data(), packed.size());
    if (ZSTD_isError(got) != 0) why = ZSTD_getErrorName(got);
  } else {
    uLongf size = static_cast<uLongf>(bytes);
    const int status = uncompress(reinterpret_cast<Bytef*>(level.data()), &size,
                                  reinterpret_cast<const Bytef*>(packed.data()),
                                  static_cast<uLong>(packed.size()));
    if (status != Z_OK) why = zError(status);
    got = size;
  }
  if (!why.empty()) {
    fail(Exit::bad_input, "{}: a level is damaged: {} says {}; {}", path, to_string(scheme), why,
         to_cure(Cure::get_again));
  }
  if (got != bytes) {
    fail(Exit::bad_input, "{}: a level is damaged: it unpacks to {} bytes, not {}; {}", path, got,
         bytes, to_cure(Cure::get_again));
  }
  return level;
}

}  // namespace gicodec::tools
