// Bytes of updates of AO points: as in the paper, by zstd on differences, by the library's
// backends.
#pragma once

#include "kind_bench.h"

#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <span>
#include <vector>

namespace gicodec::bench {

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
    for (const NamedTexture* texture : textures_of(volume)) {
      encoders_.push_back(make_encoder(texture->desc, preset));
      before_.emplace_back(texture_bytes(texture->desc));
    }
  }

  UpdateBytes update(std::span<const Bytes> textures) {
    UpdateBytes sum;
    Bytes whole, differences;
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
      for (const std::uint32_t b : dirty) {
        append_compacted({&now[b * block], block}, desc.record.bytes, whole);
      }
      const Bytes changes =
          byte_differences(gather(now, block, dirty), gather(before_[t], block, dirty));
      for (std::size_t i = dirty.size(); i-- > 1;) dirty[i] -= dirty[i - 1];
      for (const Bytes& more : {planes(std::as_bytes(std::span(dirty)), sizeof dirty[0]),
                                planes(changes, desc.record.bytes)}) {
        differences.insert(differences.end(), more.begin(), more.end());
      }
      if (!dirty.empty()) {  // Nobody is sent a packet of nothing.
        const std::span<const std::byte> view(now);
        sum.native += tools::take(encoders_[t].encode(view), "native").size();
      }
      before_[t] = now;
    }
    sum.paper = zstd_size(whole, 15, static_cast<int>(ZSTD_lazy));
    sum.planes = zstd_size(differences, 15);
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
  std::vector<Encoder> encoders_;
  std::vector<Bytes> before_;
};

}  // namespace gicodec::bench
