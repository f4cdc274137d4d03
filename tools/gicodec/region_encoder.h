// Encodes a texture whole, or each of its regions by itself.
#pragma once

#include <gicodec/encoder.h>
#include <gicodec/volume.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace gicodec::tools {

class RegionEncoder {
 public:
  /// `region`: blocks along each axis; zeros: the texture is not cut. `make` gives the encoder of a
  /// texture.
  RegionEncoder(const TextureDesc& desc, const Grid& region,
                const std::function<Encoder(const TextureDesc&)>& make);

  /// As Encoder::set_active().
  Status set_active(std::span<const std::uint8_t> active);
  /// Encodes what changed; the packets are then in packets().
  Status encode(std::span<const std::byte> texels);

  struct RegionPacket {
    std::uint32_t region = 0;  ///< as ContainerWriter::add() takes it
    Packet bytes;
  };
  /// Those of the last texels: of regions that changed, and of the first one.
  [[nodiscard]] std::span<const RegionPacket> packets() const noexcept {
    return std::span(packets_).first(count_);
  }

 private:
  struct Region {
    Encoder encoder;
    std::vector<std::byte> texels;  ///< the last ones; of a texture that is not cut none
    bool begun = false;
  };
  /// Copies a region out of the texture; true if it changed.
  bool take(std::uint32_t region, std::span<const std::byte> texels);

  TextureDesc desc_;
  Grid region_;
  std::vector<Region> regions_;
  std::vector<RegionPacket> packets_;  ///< the first `count_`; the others are spare
  std::size_t count_ = 0;
};

}  // namespace gicodec::tools
