// Successive contents of a volume as packets, a chain for each texture.
#pragma once

#include <gicodec/encoder.h>
#include <gicodec/kind.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace gicodec::kinds {

/// Texels of one of a volume's textures, tightly packed.
using Texels = std::span<const std::byte>;

class VolumeEncoders {
 public:
  /// `file`: for messages. `first_texture`: the number of the volume's first texture. Throws
  /// tools::Error.
  VolumeEncoders(const VolumeDesc& volume, const std::string& backend, std::string file,
                 std::uint8_t first_texture = 0);

  /// Packets of what changed, of all textures in order. What changed of a group that travels
  /// together travels in all of it. Throws tools::Error.
  [[nodiscard]] std::vector<Packet> encode(std::span<const Texels> textures);

 private:
  /// Says which records of the blocks exist, where the first of a group's textures tells.
  void set_presence(const TextureGroup& group, std::size_t first, Texels presence);

  std::string file_;
  std::vector<TextureGroup> sets_;
  std::vector<Encoder> encoders_;
  std::vector<std::vector<std::byte>> before_;
};

}  // namespace gicodec::kinds
