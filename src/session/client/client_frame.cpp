// Frames of a client: lookup, changed blocks, copies.
#include "session/client/client_frame.h"

#include <algorithm>
#include <utility>
#include "base/guard.h"
#include "texture/copy_block.h"

namespace gicodec {

template <typename List>
static auto find_in(List& volumes, std::uint16_t id) noexcept -> decltype(volumes.data()) {
  const auto less = [](const ClientVolume& volume, std::uint16_t of) { return volume.id < of; };
  const auto it = std::lower_bound(volumes.begin(), volumes.end(), id, less);
  return it == volumes.end() || it->id != id ? nullptr : &*it;
}

ClientVolume* find_volume(std::vector<ClientVolume>& volumes, std::uint16_t id) noexcept {
  return find_in(volumes, id);
}

const ClientVolume* ClientFrame::find(std::uint16_t id) const noexcept {
  return find_in(volumes, id);
}

Status ClientTexture::changed_blocks(std::uint64_t after_serial,
                                     std::vector<std::uint32_t>& out) const {
  return guarded([&]() -> Status {
    out.clear();
    for (std::uint32_t block = 0; block < changed.size(); ++block) {
      if (changed[block] > after_serial) out.push_back(block);
    }
    return Status::ok;
  });
}

namespace {

bool same_volume(const ClientVolume& a, const ClientVolume& b) noexcept {
  return a.instance == b.instance;
}

/// Gives `to` the volumes of `from`: keeps those that it has, copies the others.
void follow_volumes(const ClientFrame& from, ClientFrame& to) {
  std::vector<ClientVolume> volumes;
  volumes.reserve(from.volumes.size());
  std::vector<std::pair<std::size_t, ClientVolume*>> kept;
  for (const ClientVolume& volume : from.volumes) {
    ClientVolume* const held = find_volume(to.volumes, volume.id);
    if (held != nullptr && same_volume(*held, volume)) {
      kept.emplace_back(volumes.size(), held);
      volumes.emplace_back();
    } else {
      volumes.push_back(volume);
    }
  }
  // From here on nothing can fail.
  for (const auto& [place, held] : kept) volumes[place] = std::move(*held);
  to.volumes = std::move(volumes);
}

}  // namespace

Status copy_changes(const ClientFrame& from, ClientFrame& to) {
  if (from.began != to.began) {
    return guarded([&]() -> Status {
      ClientFrame copy = from;
      to = std::move(copy);
      return Status::ok;
    });
  }
  if (!std::equal(from.volumes.begin(), from.volumes.end(), to.volumes.begin(), to.volumes.end(),
                  same_volume)) {
    const Status followed = guarded([&]() -> Status {
      follow_volumes(from, to);
      return Status::ok;
    });
    if (followed != Status::ok) return followed;
  }
  for (std::size_t v = 0; v < from.volumes.size(); ++v) {
    to.volumes[v].geometry = from.volumes[v].geometry;
    for (std::size_t t = 0; t < from.volumes[v].textures.size(); ++t) {
      const ClientTexture& source = from.volumes[v].textures[t];
      ClientTexture& target = to.volumes[v].textures[t];
      const auto texels = check_view(source.desc, source.view());
      const auto place = check_view(target.desc, TextureView{target.texels});
      // Frames may have no texels.
      for (std::uint32_t block = 0; texels && place && block < source.changed.size(); ++block) {
        if (source.changed[block] <= to.serial) continue;
        copy_block(source.desc, *texels, block, target.desc, *place, block);
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
