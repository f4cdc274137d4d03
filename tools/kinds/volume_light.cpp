#include "volume_light.h"

#include "dump/error.h"

namespace gicodec::kinds {

void check_held(const HeldVolume& volume, const VolumeDesc& expected) {
  std::size_t place = 0;
  bool same = volume.desc.kind == expected.kind;
  for (const TextureGroup& group : expected.groups) {
    for (const NamedTexture& texture : group.textures) {
      const TextureDesc& desc = texture.desc;
      same = same && place < volume.textures.size();
      if (!same) break;
      const HeldTexture& held = volume.textures[place++];
      same = held.desc.layout == desc.layout && held.texels.size() == texture_bytes(desc) &&
             (held.received.empty() || held.received.size() == block_count(desc));
    }
  }
  if (!same || place != volume.textures.size())
    tools::fail(tools::Exit::bad_input, "the volume's textures are not those that its kind has");
}

}  // namespace gicodec::kinds
