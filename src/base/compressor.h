// General compressors for byte strings: none, LZ4 blocks, Zstandard frames.
#pragma once

#include <gicodec/status.h>

#include "base/memory.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

struct ZSTD_CCtx_s;
struct ZSTD_DCtx_s;

namespace gicodec {

/// Values as in FORMAT.md.
enum class Compression : std::uint8_t { none = 0, lz4 = 1, zstd = 2 };

class Compressor {
 public:
  /// Levels: lz4 1..12 (LZ4HC from 3 on), zstd 1..22; both -64..-1, faster and larger, of which
  /// lz4's are its acceleration; 0: the default, 1 for lz4, 3 for zstd.
  [[nodiscard]] static Result<Compressor> create(Compression method, int level);

  /// Largest input, 1 GiB; beyond it limit_exceeded. LZ4's own limit is about twice that.
  static constexpr std::size_t kMaxInput = std::size_t{1} << 30;
  [[nodiscard]] std::size_t bound(std::size_t size) const noexcept;
  /// Appends the compressed bytes to `out`.
  Status compress(std::span<const std::byte> in, std::vector<std::byte>& out);

 private:
  struct FreeContext {
    void operator()(ZSTD_CCtx_s* context) const noexcept;
  };
  Compression method_ = Compression::none;
  int level_ = 0;
  std::unique_ptr<ZSTD_CCtx_s, FreeContext> context_;
  Vector<std::byte> state_;  ///< LZ4's
};

/// Checks by heads whether these bytes can decompress to `size` bytes: ok, corrupt or
/// limit_exceeded. Takes time in proportion to the bytes; allocates nothing.
Status check_compressed(Compression method, std::span<const std::byte> in,
                        std::size_t size) noexcept;

class Decompressor {
 public:
  [[nodiscard]] static Result<Decompressor> create(Compression method);
  static constexpr std::size_t kMaxSize = std::size_t{3} << 29;
  /// Fills `out` exactly; else corrupt, or limit_exceeded if either is larger than kMaxSize. Safe
  /// on hostile bytes; allocates nothing.
  Status decompress(std::span<const std::byte> in, std::span<std::byte> out);

 private:
  struct FreeContext {
    void operator()(ZSTD_DCtx_s* context) const noexcept;
  };
  Compression method_ = Compression::none;
  std::unique_ptr<ZSTD_DCtx_s, FreeContext> context_;
};

}  // namespace gicodec
