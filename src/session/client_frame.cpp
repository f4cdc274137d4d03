// Frames of a client: how blocks get from one to the other.
#include "session/client_frame.h"

#include "base/guard.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace gicodec {

void copy_block(const TextureDesc& from_desc, std::span<const std::byte> from,
                std::uint32_t from_probe, const TextureDesc& to_desc, std::span<std::byte> to,
                std::uint32_t to_probe) noexcept {
  const std::size_t texel = texel_bytes(to_desc);
  const std::size_t row = block_side(to_desc) * texel;
  const auto offset = [&](const TextureDesc& desc, std::uint32_t probe, std::uint32_t y) {
    const Extent size = extent(desc);
    const BlockOrigin origin = block_origin(desc, probe);
    const std::size_t line = std::size_t{origin.slice} * size.height + origin.y + y;
    return (line * size.width + origin.x) * texel;
  };
  for (std::uint32_t y = 0; y < block_side(to_desc); ++y) {
    std::memcpy(to.data() + offset(to_desc, to_probe, y),
                from.data() + offset(from_desc, from_probe, y), row);
  }
}

Status copy_changes(const ClientFrame& from, ClientFrame& to) {
  if (from.began != to.began || from.volumes.size() != to.volumes.size()) {
    return guarded([&]() -> Status {
      ClientFrame copy = from;
      to = std::move(copy);
      return Status::ok;
    });
  }
  for (std::size_t v = 0; v < from.volumes.size(); ++v) {
    to.volumes[v].geometry = from.volumes[v].geometry;
    for (std::size_t t = 0; t < from.volumes[v].textures.size(); ++t) {
      const ClientTexture& source = from.volumes[v].textures[t];
      ClientTexture& target = to.volumes[v].textures[t];
      for (std::uint32_t probe = 0; probe < source.changed.size(); ++probe) {
        if (source.changed[probe] <= to.serial) continue;
        copy_block(source.desc, source.texels, probe, target.desc, target.texels, probe);
      }
      std::ranges::copy(source.changed, target.changed.begin());
    }
  }
  to.serial = from.serial;
  to.update = from.update;
  to.time = from.time;
  return Status::ok;
}

}  // namespace gicodec
