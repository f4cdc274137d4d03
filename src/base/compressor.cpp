#include "base/compressor.h"

#include <lz4.h>
#include <lz4hc.h>
#define ZSTD_STATIC_LINKING_ONLY  // ZSTD_customMem
#include <zstd.h>
#include <zstd_errors.h>

#include <algorithm>
#include <cstring>

namespace gicodec {
namespace {

struct Levels {
  int min, max;
};
constexpr Levels levels_of(Compression method) {
  switch (method) {
    case Compression::lz4:
      return {-64, LZ4HC_CLEVEL_MAX};
    case Compression::zstd:
      return {-64, 22};
    case Compression::none:
      return {0, 0};
  }
  return {0, 0};
}
constexpr int kZstdDefaultLevel = 3;

const char* chars(std::span<const std::byte> bytes) {
  return reinterpret_cast<const char*>(bytes.data());
}

/// zstd's contexts use the library's allocator.
void* allocate(void* /*opaque*/, std::size_t size) {
  return take_memory(size, alignof(std::max_align_t));
}
void deallocate(void* /*opaque*/, void* memory) {
  if (memory != nullptr) give_back(memory, alignof(std::max_align_t));
}
constexpr ZSTD_customMem kMemory{allocate, deallocate, nullptr};

/// The status of a failed zstd call.
Status status_of(std::size_t failed, Status otherwise) {
  const bool memory = ZSTD_getErrorCode(failed) == ZSTD_error_memory_allocation;
  return memory ? Status::out_of_memory : otherwise;
}

}  // namespace

void Compressor::FreeContext::operator()(ZSTD_CCtx_s* context) const noexcept {
  ZSTD_freeCCtx(context);
}
void Decompressor::FreeContext::operator()(ZSTD_DCtx_s* context) const noexcept {
  ZSTD_freeDCtx(context);
}

Result<Compressor> Compressor::create(Compression method, int level) {
  const Levels levels = levels_of(method);
  if (level < levels.min || level > levels.max) return Status::invalid_settings;
  Compressor compressor;
  compressor.method_ = method;
  compressor.level_ = level;
  if (method == Compression::zstd) {
    compressor.context_.reset(ZSTD_createCCtx_advanced(kMemory));
    if (compressor.context_ == nullptr) return Status::out_of_memory;
    const auto set = ZSTD_CCtx_setParameter(compressor.context_.get(), ZSTD_c_compressionLevel,
                                            level == 0 ? kZstdDefaultLevel : level);
    if (ZSTD_isError(set) != 0) return Status::backend_failed;
  } else if (method == Compression::lz4) {
    const int size = level > 2 ? LZ4_sizeofStateHC() : LZ4_sizeofState();
    compressor.state_.resize(static_cast<std::size_t>(std::max(LZ4_sizeofState(), size)));
  }
  return compressor;
}

std::size_t Compressor::bound(std::size_t size) const noexcept {
  switch (method_) {
    case Compression::none:
      return size;
    case Compression::lz4:
      return size + size / 255 + 16;
    case Compression::zstd:
      return ZSTD_compressBound(size);
  }
  return 0;
}

Status Compressor::compress(std::span<const std::byte> in, std::vector<std::byte>& out) {
  if (in.size() > kMaxInput) return Status::limit_exceeded;
  if (method_ == Compression::none) {
    out.insert(out.end(), in.begin(), in.end());
    return Status::ok;
  }
  const std::size_t start = out.size();
  out.resize(start + bound(in.size()));
  std::size_t written = 0;
  if (method_ == Compression::lz4) {
    const auto in_size = static_cast<int>(in.size());
    const auto room = static_cast<int>(out.size() - start);
    auto* to = reinterpret_cast<char*>(out.data() + start);
    // LZ4HC's upper levels dereference null for empty input.
    const bool high = level_ > 2 && !in.empty();
    const int size =
        high ? LZ4_compress_HC_extStateHC(state_.data(), chars(in), to, in_size, room, level_)
             : LZ4_compress_fast_extState(state_.data(), chars(in), to, in_size, room,
                                          std::max(-level_, 1));
    if (size <= 0) return Status::backend_failed;
    written = static_cast<std::size_t>(size);
  } else {
    written = ZSTD_compress2(context_.get(), out.data() + start, out.size() - start, in.data(),
                             in.size());
    if (ZSTD_isError(written) != 0) return status_of(written, Status::backend_failed);
  }
  out.resize(start + written);
  return Status::ok;
}

Status check_compressed(Compression method, std::span<const std::byte> in,
                        std::size_t size) noexcept {
  if (in.size() > Decompressor::kMaxSize || size > Decompressor::kMaxSize) {
    return Status::limit_exceeded;
  }
  bool sound = false;
  switch (method) {
    case Compression::none:
      sound = in.size() == size;
      break;
    case Compression::lz4:  // A byte expands to 255 at most.
      sound = !in.empty() && size / 255 <= in.size();
      break;
    case Compression::zstd: {
      // Exactly one frame with its content's size: no skippable frames, no older formats.
      std::uint32_t magic = 0;
      if (in.size() < sizeof magic) break;
      std::memcpy(&magic, in.data(), sizeof magic);
      sound = magic == ZSTD_MAGICNUMBER && ZSTD_getFrameContentSize(in.data(), in.size()) == size &&
              ZSTD_findFrameCompressedSize(in.data(), in.size()) == in.size();
    }
  }
  return sound ? Status::ok : Status::corrupt;
}

Result<Decompressor> Decompressor::create(Compression method) {
  Decompressor decompressor;
  decompressor.method_ = method;
  if (method == Compression::zstd) {
    decompressor.context_.reset(ZSTD_createDCtx_advanced(kMemory));
    if (decompressor.context_ == nullptr) return Status::out_of_memory;
  }
  return decompressor;
}

Status Decompressor::decompress(std::span<const std::byte> in, std::span<std::byte> out) {
  if (const Status status = check_compressed(method_, in, out.size()); status != Status::ok) {
    return status;
  }
  switch (method_) {
    case Compression::none:
      if (!in.empty()) std::memcpy(out.data(), in.data(), in.size());
      return Status::ok;
    case Compression::lz4: {
      // LZ4 needs a valid pointer even for empty output.
      char nothing = 0;
      auto* to = out.empty() ? &nothing : reinterpret_cast<char*>(out.data());
      const int size = LZ4_decompress_safe(chars(in), to, static_cast<int>(in.size()),
                                           static_cast<int>(out.size()));
      return size >= 0 && static_cast<std::size_t>(size) == out.size() ? Status::ok
                                                                       : Status::corrupt;
    }
    case Compression::zstd: {
      const std::size_t size =
          ZSTD_decompressDCtx(context_.get(), out.data(), out.size(), in.data(), in.size());
      if (ZSTD_isError(size) != 0) return status_of(size, Status::corrupt);
      return size == out.size() ? Status::ok : Status::corrupt;
    }
  }
  return Status::corrupt;
}

}  // namespace gicodec
