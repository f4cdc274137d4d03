// In place of compressor.cpp in a library without LZ4 and Zstandard.
#include "base/compressor.h"

#include <cstring>

namespace gicodec {

void Compressor::FreeContext::operator()(ZSTD_CCtx_s*) const noexcept {}
void Decompressor::FreeContext::operator()(ZSTD_DCtx_s*) const noexcept {}

Result<Compressor> Compressor::create(Compression, int) { return Status::unsupported_feature; }
std::size_t Compressor::bound(std::size_t size) const noexcept { return size; }
Status Compressor::compress(std::span<const std::byte>, std::vector<std::byte>&) {
  return Status::unsupported_feature;
}

Status check_compressed(Compression method, std::span<const std::byte> in,
                        std::size_t size) noexcept {
  if (method != Compression::none) return Status::unsupported_feature;
  return in.size() == size ? Status::ok : Status::corrupt;
}

Result<Decompressor> Decompressor::create(Compression method) {
  if (method != Compression::none) return Status::unsupported_feature;
  return Decompressor();
}

Status Decompressor::decompress(std::span<const std::byte> in, std::span<std::byte> out) {
  const Status status = check_compressed(method_, in, out.size());
  if (status == Status::ok && !in.empty()) std::memcpy(out.data(), in.data(), in.size());
  return status;
}

}  // namespace gicodec
