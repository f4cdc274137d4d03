#include "region_encoder.h"

#include "dump/block_place.h"

#include <gicodec/delivery.h>

#include <algorithm>
#include <utility>

namespace gicodec::tools {

RegionEncoder::RegionEncoder(const TextureDesc& desc, const Grid& region,
                             const std::function<Encoder(const TextureDesc&)>& make)
    : desc_(desc), region_(region) {
  if (region == Grid{}) {
    regions_.push_back({make(desc), {}, false});
  } else {
    const std::uint32_t regions = regions_of(desc, region).regions();
    for (std::uint32_t i = 0; i < regions; ++i) {
      const TextureDesc part = region_texture(desc, region, i);
      regions_.push_back({make(part),
                          std::vector<std::byte>(static_cast<std::size_t>(texture_bytes(part))),
                          false});
    }
  }
  packets_.resize(regions_.size());
}

Status RegionEncoder::set_active(std::span<const std::uint8_t> active) {
  if (region_ == Grid{}) return regions_[0].encoder.set_active(active);
  const RegionGrid cut = regions_of(desc_, region_);
  Status status = Status::ok;
  for (std::uint32_t i = 0; i < regions_.size() && status == Status::ok; ++i) {
    std::vector<std::uint8_t> own;
    for (const std::uint32_t block : cut.blocks_of(i)) own.push_back(active[block]);
    status = regions_[i].encoder.set_active(own);
  }
  return status;
}

bool RegionEncoder::take(std::uint32_t region, std::span<const std::byte> texels) {
  const TextureDesc& part = regions_[region].encoder.desc();
  const Extent size = extent(desc_), part_size = extent(part);
  std::vector<std::byte>& old = regions_[region].texels;
  std::vector<std::byte> taken(old.size());
  std::uint32_t number = 0;
  for (const std::uint32_t block : regions_of(desc_, region_).blocks_of(region)) {
    copy_block(block_place(desc_, size, block), texels, block_place(part, part_size, number++),
               taken);
  }
  const bool changed = taken != old;
  old = std::move(taken);
  return changed;
}

Status RegionEncoder::encode(std::span<const std::byte> texels) {
  count_ = 0;
  const bool cut = region_ != Grid{};
  for (std::uint32_t i = 0; i < regions_.size(); ++i) {
    Region& region = regions_[i];
    const bool changed = !cut || take(i, texels);
    // The first one has a packet in every frame, so that the container has every frame.
    if (!changed && i != 0 && region.begun) continue;
    const std::span<const std::byte> own = cut ? std::span<const std::byte>(region.texels) : texels;
    RegionPacket& packet = packets_[count_];
    packet.region = cut ? i : StreamId::kWholeVolume;
    const Status status =
        region.encoder.encode_to(ConstTextureView(own), Selection::changed(), packet.bytes);
    if (status != Status::ok) return status;
    region.begun = true;
    ++count_;
  }
  return Status::ok;
}

}  // namespace gicodec::tools
