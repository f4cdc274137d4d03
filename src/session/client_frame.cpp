// Frames of a client: how blocks get from one to the other.
#include "session/client_frame.h"

#include "base/guard.h"
#include "texture/view.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace gicodec {

void copy_block(const TextureDesc& from_desc, std::span<const std::byte> from,
                std::uint32_t from_block, const TextureDesc& to_desc, std::span<std::byte> to,
                std::uint32_t to_block) noexcept {
  // Both are tightly packed and as large as their descriptions say.
  const auto source = *check_view(from_desc, ConstTextureView(from));
  const auto target = *check_view(to_desc, TextureView{to});
  const std::size_t record = to_desc.record.bytes, band = 2U * to_desc.guard_band;
  const BlockShape inside = block_inside(to_desc, to_block);
  const std::byte* const first = source.at(block_origin(from_desc, from_block), record);
  std::byte* const place = target.at(block_origin(to_desc, to_block), record);
  for (std::size_t z = 0; z < inside.z; ++z) {
    for (std::size_t y = 0; y < inside.y + band; ++y) {
      std::memcpy(place + z * target.slice_pitch + y * target.row_pitch,
                  first + z * source.slice_pitch + y * source.row_pitch,
                  (inside.x + band) * record);
    }
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
      for (std::uint32_t block = 0; block < source.changed.size(); ++block) {
        if (source.changed[block] <= to.serial) continue;
        copy_block(source.desc, source.texels, block, target.desc, target.texels, block);
      }
      std::copy(source.changed.begin(), source.changed.end(), target.changed.begin());
    }
  }
  to.serial = from.serial;
  to.update = from.update;
  to.time = from.time;
  return Status::ok;
}

}  // namespace gicodec
