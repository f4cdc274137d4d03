#include "volume_container.h"

#include "dump/error.h"
#include "dump_folder.h"

namespace gicodec::ddgi {

VolumeContainer::VolumeContainer(const VolumeDesc& volume, const std::string& name,
                                 const VolumeShape& shape, const std::string& scene,
                                 std::string file, std::span<const tools::StoredTexture> dumps)
    : file_(std::move(file)), encoders_(volume, "zstd", file_) {
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
  writer_ = tools::take(ContainerWriter::create(bytes_, description), file_);
}

void VolumeContainer::add(std::uint64_t frame, std::span<const Texels> textures) {
  for (const Packet& packet : encoders_.encode(textures)) {
    tools::check(writer_->add(frame, packet), file_);
  }
}

std::vector<std::byte> VolumeContainer::finish() {
  tools::check(writer_->finish(), file_);
  return std::move(bytes_.all);
}

}  // namespace gicodec::ddgi
