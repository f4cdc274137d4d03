#include "volume_light.h"

#include "dump/error.h"

namespace gicodec::kinds {

std::vector<HeldTexture> held_of(const VolumeDesc& volume,
                                 std::span<const std::vector<std::byte>> texels,
                                 std::span<const std::vector<std::uint8_t>> received) {
  std::vector<HeldTexture> held;
  for (const NamedTexture* texture : textures_of(volume)) {
    const std::size_t i = held.size();
    held.push_back({texture->name, texture->desc, texels[i], {}});
    if (!received.empty()) held.back().received = received[i];
  }
  return held;
}

void check_held(const HeldVolume& volume, const VolumeDesc& expected) {
  const auto textures = textures_of(expected);
  bool same = volume.desc.kind == expected.kind && volume.textures.size() == textures.size();
  for (std::size_t i = 0; same && i < textures.size(); ++i) {
    const TextureDesc& desc = textures[i]->desc;
    const HeldTexture& held = volume.textures[i];
    same = held.desc.layout == desc.layout && held.texels.size() == texture_bytes(desc) &&
           (held.received.empty() || held.received.size() == block_count(desc));
  }
  if (!same)
    tools::fail(tools::Exit::bad_input, "the volume's textures are not those that its kind has");
}

}  // namespace gicodec::kinds
