#include "volume_encoders.h"

#include "common/backend_flags.h"
#include "dump/block_place.h"
#include "dump/error.h"

#include <cstring>

namespace gicodec::ddgi {
namespace {

/// Calls visit(offset, bytes) for each row of a block in a texture, tightly packed, until it
/// answers true; returns that.
template <typename Visit>
bool any_row(const TextureDesc& desc, std::uint32_t block, const Visit& visit) {
  const tools::BlockPlace place = tools::block_place(desc, extent(desc), block);
  for (std::uint32_t slice = 0; slice < place.slices; ++slice) {
    for (std::uint32_t y = 0; y < place.rows; ++y) {
      if (visit(place.row(y, slice), place.row_bytes)) return true;
    }
  }
  return false;
}

/// Whether a block differs between two contents of a texture.
bool differs(const TextureDesc& desc, Texels a, Texels b, std::uint32_t block) {
  return any_row(desc, block, [&](std::size_t from, std::size_t bytes) {
    return std::memcmp(&a[from], &b[from], bytes) != 0;
  });
}

}  // namespace

VolumeEncoders::VolumeEncoders(const VolumeDesc& volume, const std::string& backend,
                               std::string file, std::uint8_t first_texture,
                               std::span<const int> quantisers)
    : file_(std::move(file)), sets_(volume.sets) {
  for (const BlockSet& set : sets_) {
    for (const NamedTexture& texture : set.textures) {
      EncoderOptions options;
      options.backend = backend;
      std::unique_ptr<const Backend> lossy;
      if (encoders_.size() < quantisers.size() && quantisers[encoders_.size()] >= 0) {
        lossy = tools::lossy_hevc(quantisers[encoders_.size()]);
        options.backend = lossy->name();
        options.backends = {lossy.get()};
      }
      options.gop = 0;  // keyframes would need blocks that did not change
      options.texture_id = static_cast<std::uint8_t>(first_texture + encoders_.size());
      encoders_.push_back(tools::take(Encoder::create(texture.desc, options), file_));
      before_.emplace_back(static_cast<std::size_t>(texture_bytes(texture.desc)));
    }
  }
}

void VolumeEncoders::set_presence(const BlockSet& set, std::size_t first, Texels presence) {
  if (set.presence == BlockSet::kNone) return;
  const TextureDesc& desc = encoders_[first].desc();
  std::vector<std::byte> blocks;
  for (std::uint32_t block = 0; block < block_count(desc); ++block) {
    any_row(desc, block, [&](std::size_t from, std::size_t bytes) {
      const auto row = presence.subspan(from, bytes);
      blocks.insert(blocks.end(), row.begin(), row.end());
      return false;
    });
  }
  for (std::size_t i = 1; i < set.textures.size(); ++i) {
    if (encoders_[first + i].desc().presence == Presence::all) continue;
    tools::check(encoders_[first + i].set_presence(blocks), file_);
  }
}

std::vector<Packet> VolumeEncoders::encode(std::span<const Texels> textures) {
  std::vector<Packet> packets;
  std::size_t first = 0;
  for (const BlockSet& set : sets_) {
    std::vector<std::uint32_t> changed;
    const auto find_changed = [&](std::size_t from, std::size_t end) {
      changed.clear();
      for (std::uint32_t block = 0; block < block_count(encoders_[from].desc()); ++block) {
        for (std::size_t id = from; id < end; ++id) {
          if (!differs(encoders_[id].desc(), textures[id], before_[id], block)) continue;
          changed.push_back(block);
          break;
        }
      }
    };
    const std::size_t end = first + set.textures.size();
    set_presence(set, first, textures[first]);
    if (set.together) find_changed(first, end);
    for (std::size_t id = first; id < end; ++id) {
      if (!set.together) find_changed(id, id + 1);
      packets.push_back(
          tools::take(encoders_[id].encode(ConstTextureView(textures[id]), changed), file_));
    }
    for (std::size_t id = first; id < end; ++id) {
      before_[id].assign(textures[id].begin(), textures[id].end());
    }
    first = end;
  }
  return packets;
}

}  // namespace gicodec::ddgi
