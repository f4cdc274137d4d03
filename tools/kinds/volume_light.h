// Light of one volume that a client holds: updated from its textures, used for drawing.
#pragma once

#include "ddgi/client_light.h"

#include <gicodec/kind.h>
#include <gicodec/volume.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace gicodec::kinds {

/// A texture that a client holds, in its own layout, tightly packed.
struct HeldTexture {
  std::string_view name;
  TextureDesc desc;
  std::span<const std::byte> texels;
  /// One byte per block, not 0 if it was received; empty: all blocks were.
  std::span<const std::uint8_t> received;
  std::string_view encoding = {};  ///< of colour, from its dumps (kEncodingAttribute)

  [[nodiscard]] bool has(std::size_t block) const {
    return received.empty() || received[block] != 0;
  }
};

/// All textures of a volume by their texels, and by what was received of each, or all of all;
/// refers to these.
[[nodiscard]] std::vector<HeldTexture> held_of(
    const VolumeDesc& volume, std::span<const std::vector<std::byte>> texels,
    std::span<const std::vector<std::uint8_t>> received = {});

struct HeldVolume {
  const VolumeDesc& desc;
  const VolumeGeometry& geometry;
  std::span<const HeldTexture> textures;  ///< of all groups, in order
  const HeldVolume* finer = nullptr;      ///< a finer volume of the same kind, preferred inside it
};

/// Throws tools::Error of Exit::bad_input unless the textures are those of this description.
void check_held(const HeldVolume& volume, const VolumeDesc& expected);

class VolumeLight : public ddgi::ClientLight {
 public:
  /// Takes the volume after an update that shows the scene at `time`. It has the description that
  /// the light was made for; its contents may be anything. Throws tools::Error of Exit::bad_input.
  virtual void update(const HeldVolume& volume, double time) = 0;
};

}  // namespace gicodec::kinds
