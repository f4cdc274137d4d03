#include "kind_bench.h"

#include <fmt/core.h>
#include <zstd.h>

#include <algorithm>
#include <cstdio>
#include <cstring>

namespace gicodec::bench {
namespace {

template <typename Combine>
Bytes combined(std::span<const std::byte> a, std::span<const std::byte> b, const Combine& combine) {
  Bytes out(a.size());
  std::transform(a.begin(), a.end(), b.begin(), out.begin(), combine);
  return out;
}

}  // namespace

std::size_t zstd_size(std::span<const std::byte> bytes, int level, int strategy) {
  const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context(ZSTD_createCCtx(),
                                                                     ZSTD_freeCCtx);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, level);
  if (strategy != 0) ZSTD_CCtx_setParameter(context.get(), ZSTD_c_strategy, strategy);
  Bytes out(ZSTD_compressBound(bytes.size()));
  const std::size_t size =
      ZSTD_compress2(context.get(), out.data(), out.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(size) != 0) tools::fail(tools::Exit::internal, "zstd failed");
  return size;
}

Bytes planes(std::span<const std::byte> records, std::size_t record_bytes) {
  const std::size_t count = records.size() / record_bytes;
  Bytes out(records.size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    out[i % record_bytes * count + i / record_bytes] = records[i];
  }
  return out;
}

Bytes differences(std::span<const std::byte> now, std::span<const std::byte> before,
                  const Record& record) {
  Bytes out(now.size());
  for (std::size_t at = 0; at < now.size(); at += record.bytes) {
    for (const Component& component : record.used()) {
      const std::size_t first = at + component.offset / 32 * 4;
      const std::size_t bytes = std::min<std::size_t>(4, at + record.bytes - first);
      std::uint32_t x = 0, y = 0, z = 0;
      std::memcpy(&x, &now[first], bytes);
      std::memcpy(&y, &before[first], bytes);
      std::memcpy(&z, &out[first], bytes);
      const std::uint32_t shift = component.offset % 32;
      const std::uint32_t mask = component.bits == 32 ? ~0U : (1U << component.bits) - 1;
      z |= (((x >> shift) - (y >> shift)) & mask) << shift;
      std::memcpy(&out[first], &z, bytes);
    }
  }
  return out;
}

Bytes byte_differences(std::span<const std::byte> now, std::span<const std::byte> before) {
  return combined(now, before, [](std::byte a, std::byte b) {
    return static_cast<std::byte>(std::to_integer<unsigned>(a) - std::to_integer<unsigned>(b));
  });
}

Bytes exclusive_or(std::span<const std::byte> now, std::span<const std::byte> before) {
  return combined(now, before, [](std::byte a, std::byte b) { return a ^ b; });
}

Bytes gather(std::span<const std::byte> texture, std::size_t piece_bytes,
             std::span<const std::uint32_t> places) {
  Bytes out;
  out.reserve(places.size() * piece_bytes);
  for (const std::uint32_t place : places) {
    const auto piece = texture.subspan(place * piece_bytes, piece_bytes);
    out.insert(out.end(), piece.begin(), piece.end());
  }
  return out;
}

Encoder make_encoder(const TextureDesc& desc, const std::string& preset) {
  EncoderOptions options;
  options.gop = 0;
  options.settings.preset = preset;
  return tools::take(Encoder::create(desc, options), "encoder");
}

ddgi::RenderOptions picture_options(std::uint32_t width, std::uint32_t height) {
  ddgi::RenderOptions options;
  options.width = width;
  options.height = height;
  options.samples = 1;
  return options;
}

void keep_picture(const std::string& folder, const std::string& name, const ddgi::Picture& picture,
                  float exposure) {
  if (folder.empty()) return;
  ddgi::write_picture(fmt::format("{}/{}.png", folder, name), picture, exposure,
                      tools::Existing::replace);
}

void print_line(const std::string& line) {
  fmt::print("{}\n", line);
  std::fflush(stdout);
}

}  // namespace gicodec::bench
