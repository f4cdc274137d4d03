// Successive contents of a volume as packets, a chain for each texture.
#pragma once

#include <gicodec/encoder.h>
#include <gicodec/kind.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace gicodec::ddgi {

/// Texels of one of a volume's textures, tightly packed.
using Texels = std::span<const std::byte>;

class VolumeEncoders {
 public:
  /// `file`: for messages. `first_texture`: the number of the volume's first texture. `quantisers`:
  /// by texture, of HEVC that codes it instead, negative for none; or none at all. Throws
  /// tools::Error.
  VolumeEncoders(const VolumeDesc& volume, const std::string& backend, std::string file,
                 std::uint8_t first_texture = 0, std::span<const int> quantisers = {});

  /// Packets of what changed, of all textures in order. What changed of a set that travels together
  /// travels in all of it. Throws tools::Error.
  [[nodiscard]] std::vector<Packet> encode(std::span<const Texels> textures);

 private:
  /// Says which records of the blocks exist, where the first of a set's textures tells.
  void set_presence(const BlockSet& set, std::size_t first, Texels presence);

  std::string file_;
  std::vector<BlockSet> sets_;
  std::vector<Encoder> encoders_;
  std::vector<std::vector<std::byte>> before_;
};

}  // namespace gicodec::ddgi
