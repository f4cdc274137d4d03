#include "vector_container.h"

#include "dump/error.h"
#include "dump_folder.h"

#include <algorithm>

namespace gicodec::ddgi {
namespace {

constexpr const char* kName = kVectorsFile;

void require(Status status) { tools::check(status, kName); }

}  // namespace

VectorContainer::VectorContainer(const VectorTextures& textures, const VolumeShape& shape,
                                 const std::string& scene)
    : before_(textures) {
  ContainerDescription description;
  require(add_volume(description, "vectors", textures.volume));
  const auto position = [](Vec3 v) { return Position{v.x, v.y, v.z}; };
  description.volumes.front().geometry =
      VolumeGeometry{shape.grid, position(shape.origin), position(shape.spacing), {}};
  description.metadata.emplace_back(kSceneAttribute, scene);
  for (std::uint8_t id = 0; id < 2; ++id) {
    EncoderOptions options;
    options.backend = "zstd";
    options.gop = 0;  // keyframes would need blocks that did not change
    options.texture_id = id;
    encoders_.push_back(
        tools::take(Encoder::create(description.textures[id].desc, options), kName));
  }
  writer_ = tools::take(ContainerWriter::create(bytes_, description), kName);
  std::fill(before_.direction.begin(), before_.direction.end(), std::byte{});
  std::fill(before_.color.begin(), before_.color.end(), std::byte{});
}

void VectorContainer::add(std::uint64_t frame, const VectorTextures& textures) {
  const auto differs = [](const std::vector<std::byte>& a, const std::vector<std::byte>& b,
                          std::size_t block, std::size_t bytes) {
    const auto first = a.begin() + static_cast<std::ptrdiff_t>(block * bytes);
    return !std::equal(first, first + static_cast<std::ptrdiff_t>(bytes),
                       b.begin() + static_cast<std::ptrdiff_t>(block * bytes));
  };
  const std::size_t of_direction = block_bytes(encoders_[0].desc()),
                    of_color = block_bytes(encoders_[1].desc());
  std::vector<std::uint32_t> changed;
  for (std::uint32_t block = 0; block < block_count(encoders_[0].desc()); ++block) {
    if (differs(textures.direction, before_.direction, block, of_direction) ||
        differs(textures.color, before_.color, block, of_color))
      changed.push_back(block);
  }
  for (Encoder& encoder : encoders_) {
    const auto& texels = &encoder == encoders_.data() ? textures.direction : textures.color;
    const Packet packet = tools::take(encoder.encode(ConstTextureView(texels), changed), kName);
    require(writer_->add(frame, packet));
  }
  before_ = textures;
}

std::vector<std::byte> VectorContainer::finish() {
  require(writer_->finish());
  return std::move(bytes_.all);
}

}  // namespace gicodec::ddgi
