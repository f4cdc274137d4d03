// Volumes for tests of servers and clients.
#pragma once

#include <gicodec/kind.h>
#include <gicodec/probes.h>

#include <initializer_list>
#include <vector>

namespace gicodec::test {

/// Probes with these textures, which make a volume.
inline VolumeDesc probes_of(std::initializer_list<NamedTexture> textures) {
  return *probe_volume(std::vector<NamedTexture>(textures));
}

}  // namespace gicodec::test
