#include <gicodec/volume.h>

#include "base/guard.h"
#include "stream/player_state.h"
#include "texture/copy_block.h"

#include <algorithm>
#include <memory>

namespace gicodec {

std::span<const std::uint32_t> ContainerPlayer::changed(std::uint8_t texture) const noexcept {
  return texture < state_->changed.size() ? std::span<const std::uint32_t>(state_->changed[texture])
                                          : std::span<const std::uint32_t>();
}

Status ContainerPlayer::State::read_part(PartId id, TextureView view,
                                         const std::vector<std::uint32_t>* blocks) const {
  const auto [texture, number] = id;
  const auto found = parts.find(id);
  if (found != parts.end() && number == 0) {
    return blocks == nullptr ? found->second.read(view) : found->second.read(view, *blocks);
  }
  const TextureDesc desc = desc_of(texture);
  const auto target = check_view(desc, view);
  if (!target) return target.status();
  const RegionGrid cut = regions(texture);
  const TextureDesc part_desc =
      number == 0 ? desc
                  : region_texture(entries()[texture].desc, region_size(texture), number - 1);
  const auto for_each = [&](const auto& write) {
    const std::size_t all = blocks == nullptr ? block_count(part_desc) : blocks->size();
    for (std::size_t i = 0; i < all; ++i) {
      const std::uint32_t own = blocks == nullptr ? static_cast<std::uint32_t>(i) : (*blocks)[i];
      write(own, id.second == 0 ? own : cut.block_of(id.second - 1, own));
    }
  };
  if (found == parts.end()) {
    for_each([&](std::uint32_t, std::uint32_t block) { clear_block(desc, *target, block); });
    return Status::ok;
  }
  // Not initialised, so that untouched pages cost nothing.
  const auto bytes = static_cast<std::size_t>(texture_bytes(part_desc));
  const std::unique_ptr<std::byte[]> room(new std::byte[bytes]);
  const std::span texels(room.get(), bytes);
  const Decoder& decoder = found->second;
  const Status status = blocks == nullptr ? decoder.read(TextureView{texels})
                                          : decoder.read(TextureView{texels}, *blocks);
  if (status != Status::ok) return status;
  const auto from = check_view(part_desc, ConstTextureView(texels));
  if (!from) return from.status();
  for_each([&](std::uint32_t own, std::uint32_t block) {
    copy_block(part_desc, *from, own, desc, *target, block);
  });
  return Status::ok;
}

Status ContainerPlayer::read(std::uint8_t texture, TextureView view) const {
  const State& s = *state_;
  if (!s.is_played(texture)) return Status::unknown_texture;
  return guarded([&]() -> Status {
    if (s.region_size(texture) == Grid{}) return s.read_part({texture, 0}, view, nullptr);
    const std::uint32_t regions = s.regions(texture).regions();
    Status status = Status::ok;
    for (std::uint32_t region = 1; status == Status::ok && region <= regions; ++region) {
      status = s.read_part({texture, region}, view, nullptr);
    }
    return status;
  });
}

Status ContainerPlayer::read_changed(std::uint8_t texture, TextureView view) const {
  const State& s = *state_;
  if (!s.is_played(texture)) return Status::unknown_texture;
  if (s.all_changed) return read(texture, view);
  return guarded([&]() -> Status {
    const std::vector<std::uint32_t>& blocks = s.changed[texture];
    if (s.region_size(texture) == Grid{}) return s.read_part({texture, 0}, view, &blocks);
    if (const auto target = check_view(s.desc_of(texture), view); !target) return target.status();
    const RegionGrid cut = s.regions(texture);
    std::vector<std::pair<std::uint32_t, std::uint32_t>>
        by_region;  // region, and the block's number in it
    by_region.reserve(blocks.size());
    for (const std::uint32_t block : blocks) {
      by_region.emplace_back(cut.region_of(block), cut.number_of(block));
    }
    std::sort(by_region.begin(), by_region.end());
    std::vector<std::uint32_t> own;
    for (std::size_t i = 0; i < by_region.size();) {
      const std::uint32_t region = by_region[i].first;
      for (own.clear(); i < by_region.size() && by_region[i].first == region; ++i) {
        own.push_back(by_region[i].second);
      }
      const Status status = s.read_part({texture, region + 1}, view, &own);
      if (status != Status::ok) return status;
    }
    return Status::ok;
  });
}

}  // namespace gicodec
