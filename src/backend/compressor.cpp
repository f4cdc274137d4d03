#include "backend/compressor.h"

#include <lz4.h>
#include <lz4hc.h>
#include <zstd.h>

#include <cstring>

namespace gicodec {
namespace {

constexpr int kLz4MaxLevel = LZ4HC_CLEVEL_MAX;
constexpr int kZstdMaxLevel = 22;
constexpr int kZstdDefaultLevel = 3;

const char* chars(std::span<const std::byte> bytes) {
  return reinterpret_cast<const char*>(bytes.data());
}

}  // namespace

void Compressor::FreeContext::operator()(ZSTD_CCtx_s* context) const noexcept {
  ZSTD_freeCCtx(context);
}
void Decompressor::FreeContext::operator()(ZSTD_DCtx_s* context) const noexcept {
  ZSTD_freeDCtx(context);
}

Result<Compressor> Compressor::create(Compression method, int level) {
  const int max_level = method == Compression::zstd  ? kZstdMaxLevel
                        : method == Compression::lz4 ? kLz4MaxLevel
                                                     : 0;
  if (level < 0 || level > max_level) return Status::invalid_argument;
  Compressor compressor;
  compressor.method_ = method;
  compressor.level_ = level;
  if (method == Compression::zstd) {
    compressor.context_.reset(ZSTD_createCCtx());
    if (compressor.context_ == nullptr) return Status::out_of_memory;
    const auto set = ZSTD_CCtx_setParameter(compressor.context_.get(), ZSTD_c_compressionLevel,
                                            level == 0 ? kZstdDefaultLevel : level);
    if (ZSTD_isError(set) != 0) return Status::backend_failed;
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
    // LZ4HC's upper levels read through a null pointer if there is nothing to compress.
    const bool high = level_ > 2 && !in.empty();
    const int size = high ? LZ4_compress_HC(chars(in), to, in_size, room, level_)
                          : LZ4_compress_default(chars(in), to, in_size, room);
    if (size <= 0) return Status::backend_failed;
    written = static_cast<std::size_t>(size);
  } else {
    written = ZSTD_compress2(context_.get(), out.data() + start, out.size() - start, in.data(),
                             in.size());
    if (ZSTD_isError(written) != 0) return Status::backend_failed;
  }
  out.resize(start + written);
  return Status::ok;
}

Result<Decompressor> Decompressor::create(Compression method) {
  Decompressor decompressor;
  decompressor.method_ = method;
  if (method == Compression::zstd) {
    decompressor.context_.reset(ZSTD_createDCtx());
    if (decompressor.context_ == nullptr) return Status::out_of_memory;
  }
  return decompressor;
}

Status Decompressor::decompress(std::span<const std::byte> in, std::span<std::byte> out) {
  if (in.size() > kMaxSize || out.size() > kMaxSize) return Status::limit_exceeded;
  switch (method_) {
    case Compression::none:
      if (in.size() != out.size()) return Status::corrupt;
      if (!in.empty()) std::memcpy(out.data(), in.data(), in.size());
      return Status::ok;
    case Compression::lz4: {
      // LZ4 wants somewhere to write even if there is nothing to write.
      char nothing = 0;
      auto* to = out.empty() ? &nothing : reinterpret_cast<char*>(out.data());
      const int size = LZ4_decompress_safe(chars(in), to, static_cast<int>(in.size()),
                                           static_cast<int>(out.size()));
      return size >= 0 && static_cast<std::size_t>(size) == out.size() ? Status::ok
                                                                       : Status::corrupt;
    }
    case Compression::zstd: {
      // One frame and nothing else: no skippable frames, none of zstd's older formats.
      std::uint32_t magic = 0;
      if (in.size() < sizeof magic) return Status::corrupt;
      std::memcpy(&magic, in.data(), sizeof magic);
      if (magic != ZSTD_MAGICNUMBER ||
          ZSTD_findFrameCompressedSize(in.data(), in.size()) != in.size()) {
        return Status::corrupt;
      }
      const std::size_t size =
          ZSTD_decompressDCtx(context_.get(), out.data(), out.size(), in.data(), in.size());
      return ZSTD_isError(size) == 0 && size == out.size() ? Status::ok : Status::corrupt;
    }
  }
  return Status::corrupt;
}

}  // namespace gicodec
