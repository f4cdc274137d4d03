#include "volume_container.h"

#include "dump/error.h"
#include "dump_folder.h"

#include <algorithm>
#include <cstring>

namespace gicodec::ddgi {
namespace {

/// Whether a block differs between two contents of a texture, tightly packed.
bool differs(const TextureDesc& desc, Texels a, Texels b, std::uint32_t block) {
  const BlockOrigin at = block_origin(desc, block);
  const BlockShape inside = block_inside(desc, block);
  const Extent size = extent(desc);
  const bool array = desc.layout.tiling == Tiling::blocks;
  const std::uint64_t slice = at.slice + (array ? size.slices / block_count(desc) * at.block : 0);
  const std::size_t band = std::size_t{2} * desc.guard_band;
  const std::size_t row = (band + inside.x) * desc.record.bytes;
  for (std::size_t z = 0; z < inside.z; ++z) {
    for (std::size_t y = 0; y < inside.y + band; ++y) {
      const std::size_t from =
          (((slice + z) * size.height + at.y + y) * size.width + at.x) * desc.record.bytes;
      if (std::memcmp(&a[from], &b[from], row) != 0) return true;
    }
  }
  return false;
}

}  // namespace

VolumeContainer::VolumeContainer(const VolumeDesc& volume, const std::string& name,
                                 const VolumeShape& shape, const std::string& scene,
                                 std::string file, std::span<const tools::StoredTexture> dumps)
    : file_(std::move(file)), volume_(volume) {
  ContainerDescription description;
  tools::check(add_volume(description, name, volume), file_);
  const auto position = [](Vec3 v) { return Position{v.x, v.y, v.z}; };
  if (volume.sets.front().textures.front().desc.grid == shape.grid) {
    description.volumes.front().geometry =
        VolumeGeometry{shape.grid, position(shape.origin), position(shape.spacing), {}};
  }
  description.metadata.emplace_back(kSceneAttribute, scene);
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < dumps.size(); ++i) {
    Metadata& metadata = description.textures[i].metadata;
    metadata = to_entry(dumps[i]).metadata;
    for (const auto& [key, value] : metadata) bytes += key.size() + value.size() + 8;
  }
  if (bytes + 1024 > DecodeLimits{}.max_description_bytes) {
    tools::fail(tools::Exit::usage,
                "{}: the times of all frames take {} bytes, more than a container's description "
                "holds; --frames asks for fewer, --files exr makes files of them",
                file_, bytes);
  }
  for (const TextureEntry& texture : description.textures) {
    EncoderOptions options;
    options.backend = "zstd";
    options.gop = 0;  // keyframes would need blocks that did not change
    options.texture_id = static_cast<std::uint8_t>(encoders_.size());
    encoders_.push_back(tools::take(Encoder::create(texture.desc, options), file_));
    before_.emplace_back(static_cast<std::size_t>(texture_bytes(texture.desc)));
  }
  writer_ = tools::take(ContainerWriter::create(bytes_, description), file_);
}

void VolumeContainer::add(std::uint64_t frame, std::span<const Texels> textures) {
  std::size_t first = 0;
  for (const BlockSet& set : volume_.sets) {
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
    if (set.together) find_changed(first, end);
    for (std::size_t id = first; id < end; ++id) {
      if (!set.together) find_changed(id, id + 1);
      const Packet packet =
          tools::take(encoders_[id].encode(ConstTextureView(textures[id]), changed), file_);
      tools::check(writer_->add(frame, packet), file_);
      before_[id].assign(textures[id].begin(), textures[id].end());
    }
    first = end;
  }
}

std::vector<std::byte> VolumeContainer::finish() {
  tools::check(writer_->finish(), file_);
  return std::move(bytes_.all);
}

}  // namespace gicodec::ddgi
