// Light of one volume as a client holds it: drawn with, and told what came.
#pragma once

#include "ddgi/client_light.h"

#include <gicodec/kind.h>
#include <gicodec/volume.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace gicodec::kinds {

/// A texture as a client holds it, in its own layout, tightly packed.
struct HeldTexture {
  std::string_view name;
  TextureDesc desc;
  std::span<const std::byte> texels;
  /// Per block whether anything was received for it; empty: all was.
  std::span<const std::uint8_t> received;
  std::string_view encoding = {};  ///< that its dumps tell of colour (kEncodingAttribute)

  [[nodiscard]] bool has(std::size_t block) const {
    return received.empty() || received[block] != 0;
  }
};

struct HeldVolume {
  const VolumeDesc& desc;
  const VolumeGeometry& geometry;
  std::span<const HeldTexture> textures;  ///< of all sets, in order
  const HeldVolume* finer = nullptr;      ///< another of its kind, where that reaches
};

/// Throws tools::Error of Exit::bad_input unless the textures are those of this description.
void check_held(const HeldVolume& volume, const VolumeDesc& expected);

class VolumeLight : public ddgi::ClientLight {
 public:
  /// Takes what is held after an update that shows the scene at `time`. The volume has the
  /// description that the light was made for; what is in it may be anything. Throws tools::Error
  /// of Exit::bad_input.
  virtual void update(const HeldVolume& volume, double time) = 0;
};

}  // namespace gicodec::kinds
