// Bytes of updates of AO points: as in the paper, by zstd on differences, by the library's
// backends.
#pragma once

#include "dump/error.h"

#include <gicodec/encoder.h>
#include <gicodec/kind.h>

#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace gicodec::bench {

using Bytes = std::vector<std::byte>;

/// zstd of a level; `strategy` 0 is that of the level.
inline std::size_t zstd_bytes(const Bytes& input, int level, int strategy) {
  const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context(ZSTD_createCCtx(),
                                                                     ZSTD_freeCCtx);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, level);
  if (strategy != 0) ZSTD_CCtx_setParameter(context.get(), ZSTD_c_strategy, strategy);
  Bytes out(ZSTD_compressBound(input.size()));
  const std::size_t size =
      ZSTD_compress2(context.get(), out.data(), out.size(), input.data(), input.size());
  if (ZSTD_isError(size) != 0) tools::fail(tools::Exit::internal, "zstd failed");
  return size;
}

/// What an update takes, all textures together.
struct UpdateBytes {
  std::size_t paper = 0;   ///< zstd 15, strategy 4: whole blocks that changed, free places last
  std::size_t planes = 0;  ///< zstd 15: byte planes of their differences
  std::size_t native = 0;  ///< packets
  std::size_t dirty = 0;   ///< blocks of the first texture that changed

  UpdateBytes& operator+=(const UpdateBytes& more) {
    paper += more.paper, planes += more.planes, native += more.native, dirty += more.dirty;
    return *this;
  }
};

class AoCoders {
 public:
  AoCoders(const VolumeDesc& volume, const std::string& preset) {
    EncoderOptions options;
    options.gop = 0;
    options.settings.preset = preset;
    for (const TextureGroup& group : volume.groups) {
      for (const NamedTexture& texture : group.textures) {
        encoders_.push_back(tools::take(Encoder::create(texture.desc, options), texture.name));
        before_.emplace_back(texture_bytes(texture.desc));
      }
    }
  }

  UpdateBytes update(std::span<const Bytes> textures) {
    UpdateBytes sum;
    Bytes whole, planes;
    for (std::size_t t = 0; t < textures.size(); ++t) {
      const Bytes& now = textures[t];
      const TextureDesc& desc = encoders_[t].desc();
      const std::size_t block = block_bytes(desc);
      std::vector<std::uint32_t> dirty;
      for (std::uint32_t b = 0; b < block_count(desc); ++b) {
        if (std::memcmp(&now[b * block], &before_[t][b * block], block) != 0) dirty.push_back(b);
      }
      if (t == 0) sum.dirty = dirty.size();
      const std::size_t numbers = whole.size();
      whole.resize(numbers + dirty.size() * sizeof dirty[0]);
      if (!dirty.empty()) {
        std::memcpy(&whole[numbers], dirty.data(), dirty.size() * sizeof dirty[0]);
      }
      Bytes differences;
      for (const std::uint32_t b : dirty) {
        const std::span<const std::byte> is(&now[b * block], block);
        append_compacted(is, desc.record.bytes, whole);
        for (std::size_t i = 0; i < block; ++i) {
          differences.push_back(
              static_cast<std::byte>(std::to_integer<unsigned>(is[i]) -
                                     std::to_integer<unsigned>(before_[t][b * block + i])));
        }
      }
      for (std::size_t i = dirty.size(); i-- > 1;) dirty[i] -= dirty[i - 1];
      const auto steps = std::as_bytes(std::span(dirty));
      append_planes(steps, 4, planes);
      append_planes(differences, desc.record.bytes, planes);
      if (!dirty.empty()) {  // Nobody is sent a packet of nothing.
        const std::span<const std::byte> view(now);
        sum.native += tools::take(encoders_[t].encode(view), "native").size();
      }
      before_[t] = now;
    }
    sum.paper = zstd_bytes(whole, 15, static_cast<int>(ZSTD_lazy));
    sum.planes = zstd_bytes(planes, 15, 0);
    return sum;
  }

 private:
  static void append_compacted(std::span<const std::byte> block, std::size_t record, Bytes& out) {
    std::size_t free = 0;
    for (std::size_t at = 0; at < block.size(); at += record) {
      const auto one = block.subspan(at, record);
      if (std::ranges::all_of(one, [](std::byte b) { return b == std::byte{0}; })) {
        free += record;
      } else {
        out.insert(out.end(), one.begin(), one.end());
      }
    }
    out.resize(out.size() + free);
  }
  static void append_planes(std::span<const std::byte> records, std::size_t bytes, Bytes& out) {
    for (std::size_t plane = 0; plane < bytes; ++plane) {
      for (std::size_t at = plane; at < records.size(); at += bytes) out.push_back(records[at]);
    }
  }

  std::vector<Encoder> encoders_;
  std::vector<Bytes> before_;
};

}  // namespace gicodec::bench
